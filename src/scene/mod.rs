//! From a scene file to an immutable [`Scene`].

pub mod description;
