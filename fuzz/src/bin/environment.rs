#![no_main]

photosphere_fuzz::fuzz!("environment");
