#![no_main]

photosphere_fuzz::fuzz_text!("table_rows");
