//! Reads lines of text in parallel.

mod batch;
mod fields;
mod input;
mod number;
mod rows;
mod words;

pub(super) use batch::{Batch, Kind, Values};
pub(super) use fields::{Field, FieldUse, Fields, SpacedRows};
pub(super) use input::Input;
pub(super) use number::{float, float_with_comma, integer, is_missing, short_float, tokens};
pub(super) use rows::{LineParser, Section, read_rows, skip_section};
pub(super) use words::Words;
