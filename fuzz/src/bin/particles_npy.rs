#![no_main]

photosphere_fuzz::fuzz!("particles_npy");
