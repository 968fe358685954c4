#![no_main]

photosphere_fuzz::fuzz_text!("particles_ply");
