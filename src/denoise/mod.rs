//! Removes noise from finished pictures with Intel Open Image Denoise, which is loaded at run time
//! if it is installed.
//!
//! A denoised picture is biased: its values are guesses of a neural network, and nothing says how
//! far they are off. So it is made of a picture, and never goes back: not into the film, error
//! estimates, checkpoints or merged renders.

mod denoised_picture;
mod find;
#[allow(unsafe_code, reason = "the functions of a C library that is loaded at run time")]
mod oidn;
mod picture;

pub use denoised_picture::{DenoisedPicture, denoised_alone};
pub use picture::{DENOISED, Denoiser};
