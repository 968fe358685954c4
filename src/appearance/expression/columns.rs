//! The columns that an expression may name.

/// Columns by name.
pub trait ColumnSource {
    /// All names, for messages.
    fn names(&self) -> Vec<&str>;

    /// The column with this name.
    fn column(&self, name: &str) -> Option<ColumnValues<'_>>;
}

/// Writes the numbers of the rows from the first argument on, as many as the slice takes.
pub type FillRows<'a> = Box<dyn Fn(usize, &mut [f64]) + Sync + 'a>;

/// The values of a column.
pub enum ColumnValues<'a> {
    /// Numbers.
    Numbers(FillRows<'a>),
    /// Texts: each row has the index of a word.
    Texts {
        /// The words.
        words: Vec<&'a str>,
        /// Index of the word in a row.
        codes: &'a [u32],
    },
}
