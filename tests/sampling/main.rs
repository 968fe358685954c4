//! Random numbers and what is drawn with them, against their densities.

mod chi2;
mod correlated;
mod disk;
mod families;
mod samplers;
