//! Reads lines of text in parallel.

mod batch;
mod decimal;
mod fields;
mod input;
mod number;
mod row_values;
mod rows;
mod spaced_rows;
mod words;

pub(super) use batch::{Batch, Kind};
pub(super) use decimal::short_float;
pub(super) use fields::{Field, FieldUse, Fields};
pub(super) use input::Input;
pub(super) use number::{float, float_with_comma, integer, is_missing, tokens};
pub(super) use row_values::RowValues;
pub(super) use rows::{LineParser, Section, read_rows, skip_section};
pub(super) use spaced_rows::{SpacedRows, push_quickly};
pub(super) use words::Words;
