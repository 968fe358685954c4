//! Where light is collected, and the picture that comes of it.

mod picture;

pub use picture::Picture;
