//! `photosphere bench`: rays per second of every intersector.

use crate::error::Result;

use super::args::BenchArgs;
use super::exit::Exit;

pub(super) fn run(_: &BenchArgs) -> Result<Exit> {
    Ok(Exit::Done)
}
