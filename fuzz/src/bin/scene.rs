#![no_main]

photosphere_fuzz::fuzz_text!("scene");
