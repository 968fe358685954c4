#![no_main]

photosphere_fuzz::fuzz_text!("checkpoint_shaped");
