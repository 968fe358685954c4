//! The rules of the house: which room may use which, and what each dependency is for.

mod dependencies;
mod layers;
mod packaging;
mod words;
