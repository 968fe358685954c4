//! What a format says about its lines.

use super::batch::Batch;
use super::fields::FieldUse;
use super::marks::{MarkedRow, Separator};

/// Parses one line after the other.
pub(in crate::particles) trait LineParser: Sync {
    /// Appends the rows of a line. The error says what was expected, and what was found.
    ///
    /// # Errors
    /// If the line is wrong.
    fn parse(&self, line: &[u8], to: &mut Batch) -> Result<(), String>;

    /// What separates the values that [`Self::parse_quickly`] needs to be marked; `None` if it does
    /// nothing.
    fn separator(&self) -> Option<Separator> {
        None
    }

    /// The values of a row, if rows may be parsed many at once where these are all of it.
    fn values(&self) -> Option<&[FieldUse]> {
        None
    }

    /// Appends a row if all of its values are common ones and all is right; returns where its line
    /// ends in the text, its end included. Otherwise columns may have one value more, and
    /// [`Self::parse`] decides.
    fn parse_quickly(&self, _row: MarkedRow<'_>, _to: &mut Batch) -> Option<usize> {
        None
    }
}
