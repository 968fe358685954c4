//! Expressions over the columns of particles, such as `type == 2 && z < 10`.
//!
//! A text becomes tokens, a tree, and, for certain columns, a program that is evaluated in chunks.
//! Every part keeps its span in the text, so that an error can point at it.
//!
//! | binds loosest to tightest | |
//! |---|---|
//! | `\|\|`, `&&` | conditions |
//! | `==` `!=` `<` `<=` `>` `>=` | numbers; `==` and `!=` also texts, as in `element == "O"` |
//! | `+` `-`, then `*` `/` `%` | numbers; `%` has the sign of the divisor |
//! | `!`, `-` in front | |
//! | `^` | a power, from the right |
//!
//! `min` and `max` take any number of arguments; `abs`, `sqrt`, `exp`, `log`, `log10`, `sin`, `cos`
//! and `floor` take one. A column whose name is no word stands in backquotes.

mod bind;
mod columns;
mod failure;
mod parse;
mod program;
mod token;
mod tree;

pub use bind::Expression;
pub use columns::{ColumnSource, ColumnValues, FillRows};
pub use failure::ExpressionError;
