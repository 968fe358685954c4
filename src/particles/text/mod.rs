//! Reads lines of text in parallel.

mod batch;
mod blocks;
mod decimal;
mod fields;
mod input;
mod joined;
mod lanes;
mod line_parser;
mod marks;
mod number;
mod piece;
mod row_lanes;
mod row_values;
mod rows;
mod spaced_rows;
mod values;
mod words;

pub(super) use batch::Batch;
pub(super) use decimal::short_float;
pub(super) use fields::{Field, FieldUse, Fields};
pub(super) use input::Input;
pub(super) use line_parser::LineParser;
pub(super) use marks::{MarkedRow, Separator};
pub(super) use number::{float, float_with_comma, integer, is_missing, tokens};
pub(super) use row_values::RowValues;
pub(super) use rows::{Section, read_rows, skip_section};
pub(super) use spaced_rows::{SpacedRows, push_quickly};
pub(super) use values::Kind;
pub(super) use words::Words;
