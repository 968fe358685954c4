//! Reads numbers in binary files in parallel.

mod data;
mod number;
mod output;
mod rows;
mod slots;

pub(super) use data::{Data, DataReader};
pub(super) use number::{Number, NumberKind};
pub(super) use rows::read_plan;
pub(super) use slots::{Slot, Slots, named};
