//! Reads lines of text in parallel.

mod batch;
mod decimal;
mod fields;
mod input;
mod number;
mod rows;
mod spaced_rows;
mod words;

pub(super) use batch::{Batch, Kind, Values};
pub(super) use decimal::short_float;
pub(super) use fields::{Field, FieldUse, Fields};
pub(super) use input::Input;
pub(super) use number::{float, float_with_comma, integer, is_missing, tokens};
pub(super) use rows::{LineParser, Section, read_rows, skip_section};
pub(super) use spaced_rows::{SpacedRows, push_quickly};
pub(super) use words::Words;
