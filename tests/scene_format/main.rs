//! The scene file as a user meets it: what is read, and how each mistake is told.

mod any_text;
mod backgrounds;
mod identity;
mod key_values;
mod keys;
mod layers;
mod metals;
mod mistakes;
mod options;
mod paper;
mod reading;
mod scenes;
mod schema;
