#![no_main]

photosphere_fuzz::fuzz!("table_npy");
