//! The scene file and its tables as a user meets them: what is read, and how each mistake is told.

mod any_text;
mod backgrounds;
mod colors;
mod fitting;
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
mod sphere_tables;
mod table_files;
