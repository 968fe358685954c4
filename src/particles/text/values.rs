//! Columns that grow, and widen their type when a value needs it.

use crate::particles::column::ColumnData;
use crate::task::pages::try_reserve;

use super::number::{float, integer, is_missing};
use super::words::Words;

/// The type of the values of a column so far.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd)]
pub(in crate::particles) enum Kind {
    I32,
    I64,
    F64,
    Text,
}

/// The values of a column.
#[derive(Clone, Debug)]
pub(in crate::particles) enum Values {
    I32(Vec<i32>),
    I64(Vec<i64>),
    F64(Vec<f64>),
    Text(Words),
}

impl Values {
    /// An empty column.
    pub(in crate::particles) fn new(kind: Kind) -> Self {
        match kind {
            Kind::I32 => Self::I32(Vec::new()),
            Kind::I64 => Self::I64(Vec::new()),
            Kind::F64 => Self::F64(Vec::new()),
            Kind::Text => Self::Text(Words::default()),
        }
    }

    /// The type so far.
    pub(in crate::particles) fn kind(&self) -> Kind {
        match self {
            Self::I32(_) => Kind::I32,
            Self::I64(_) => Kind::I64,
            Self::F64(_) => Kind::F64,
            Self::Text(_) => Kind::Text,
        }
    }

    /// Appends the value of a token; false if it is not a number in a column of numbers.
    #[inline]
    pub(in crate::particles) fn push(&mut self, token: &[u8]) -> bool {
        match self {
            Self::F64(values) => match float(token) {
                Some(value) => values.push(value),
                None => return self.push_missing(token),
            },
            Self::Text(words) => words.push(token),
            Self::I32(_) | Self::I64(_) => match integer(token) {
                Some(value) => self.push_integer(value),
                None => match float(token) {
                    Some(value) => self.push_float(value),
                    None => return self.push_missing(token),
                },
            },
        }
        true
    }

    /// Appends NaN for a missing value; false if the token is something else.
    #[cold]
    fn push_missing(&mut self, token: &[u8]) -> bool {
        let is_missing = is_missing(token);
        if is_missing {
            self.push_float(f64::NAN);
        }
        is_missing
    }

    /// Returns true for words.
    pub(in crate::particles) fn is_text(&self) -> bool {
        matches!(self, Self::Text(_))
    }

    /// Appends an integer to a column of numbers.
    #[inline]
    pub(in crate::particles) fn push_integer(&mut self, value: i64) {
        match self {
            Self::I32(values) => match i32::try_from(value) {
                Ok(value) => values.push(value),
                Err(_) => {
                    self.widen(Kind::I64);
                    self.push_integer(value);
                }
            },
            Self::I64(values) => values.push(value),
            Self::F64(values) => values.push(value as f64),
            Self::Text(words) => words.push(value.to_string().as_bytes()),
        }
    }

    /// Appends a number to a column of numbers.
    #[inline]
    pub(in crate::particles) fn push_float(&mut self, value: f64) {
        self.widen(Kind::F64);
        match self {
            Self::F64(values) => values.push(value),
            Self::Text(words) => words.push(value.to_string().as_bytes()),
            Self::I32(_) | Self::I64(_) => {}
        }
    }

    /// Changes the type to one that holds more numbers.
    fn widen(&mut self, kind: Kind) {
        *self = match (&*self, kind) {
            (Self::I32(values), Kind::I64) => {
                Self::I64(values.iter().map(|&x| i64::from(x)).collect())
            }
            (Self::I32(values), Kind::F64) => {
                Self::F64(values.iter().map(|&x| f64::from(x)).collect())
            }
            (Self::I64(values), Kind::F64) => Self::F64(values.iter().map(|&x| x as f64).collect()),
            _ => return,
        };
    }

    /// Appends all values of a column of the same kind, or of another kind of numbers.
    pub(in crate::particles) fn append(&mut self, other: &mut Self) {
        self.widen(other.kind());
        other.widen(self.kind());
        match (self, other) {
            (Self::I32(values), Self::I32(more)) => values.extend_from_slice(more),
            (Self::I64(values), Self::I64(more)) => values.extend_from_slice(more),
            (Self::F64(values), Self::F64(more)) => values.extend_from_slice(more),
            (Self::Text(words), Self::Text(more)) => words.append(more),
            _ => debug_assert!(false, "kinds of numbers and of words do not mix"),
        }
    }

    /// Forgets all values, and keeps the memory for as many.
    pub(super) fn clear(&mut self) {
        match self {
            Self::Text(words) => words.clear(),
            _ => self.truncate(0),
        }
    }

    /// Takes memory for more values, if there is as much.
    pub(super) fn reserve(&mut self, count: usize) {
        let _ = match self {
            Self::I32(values) => try_reserve(values, count),
            Self::I64(values) => try_reserve(values, count),
            Self::F64(values) => try_reserve(values, count),
            Self::Text(words) => {
                words.reserve(count);
                Ok(())
            }
        };
    }

    /// Keeps the first values.
    pub(super) fn truncate(&mut self, count: usize) {
        match self {
            Self::I32(values) => values.truncate(count),
            Self::I64(values) => values.truncate(count),
            Self::F64(values) => values.truncate(count),
            Self::Text(words) => words.truncate(count),
        }
    }

    /// Bytes of memory, about.
    pub(in crate::particles) fn bytes(&self) -> u64 {
        match self {
            Self::I32(values) => 4 * values.len() as u64,
            Self::I64(values) => 8 * values.len() as u64,
            Self::F64(values) => 8 * values.len() as u64,
            Self::Text(words) => words.bytes(),
        }
    }

    /// The column.
    pub(in crate::particles) fn finish(self) -> ColumnData {
        fn shrunk<T>(mut values: Vec<T>) -> Vec<T> {
            values.shrink_to_fit();
            values
        }
        match self {
            Self::I32(values) => ColumnData::I32(shrunk(values)),
            Self::I64(values) => ColumnData::I64(shrunk(values)),
            Self::F64(values) => ColumnData::F64(shrunk(values)),
            Self::Text(words) => ColumnData::Text(words.finish()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(tokens: &[&str]) -> ColumnData {
        let mut values = Values::new(Kind::I32);
        assert!(tokens.iter().all(|token| values.push(token.as_bytes())));
        values.finish()
    }

    #[test]
    fn types_widen_as_values_need() {
        assert_eq!(column(&["1", "-2"]), ColumnData::I32(vec![1, -2]));
        let wide = [1, 3_000_000_000];
        assert_eq!(column(&["1", "3000000000"]), ColumnData::I64(wide.to_vec()));
        assert_eq!(column(&["1", "2.5", "3"]), ColumnData::F64(vec![1.0, 2.5, 3.0]));
        assert_eq!(column(&["3000000000", "1e3"]), ColumnData::F64(vec![3e9, 1e3]));
        assert!(!Values::new(Kind::I32).push(b"abc"));
        assert!(!Values::new(Kind::F64).push(b"1.2.3"));
        assert!(Values::new(Kind::I32).push(b"NA"));
    }

    #[test]
    fn parts_of_different_types_are_joined() {
        let part = |tokens: &[&str]| {
            let mut values = Values::new(Kind::I32);
            assert!(tokens.iter().all(|token| values.push(token.as_bytes())));
            values
        };
        for order in [[0, 1, 2], [1, 0, 2], [2, 1, 0]] {
            let parts = [part(&["1"]), part(&["5000000000"]), part(&["0.5"])];
            let mut all = Values::new(Kind::I32);
            for &at in &order {
                all.append(&mut parts[at].clone());
            }
            let values = [1.0, 5e9, 0.5];
            assert_eq!(all.finish(), ColumnData::F64(order.map(|at| values[at]).to_vec()));
        }
        let mut words = Values::new(Kind::Text);
        let mut more = Values::new(Kind::Text);
        for word in ["O", "H", "H"] {
            assert!(words.push(word.as_bytes()) && more.push(word.as_bytes()));
        }
        assert!(more.push(b"C"));
        words.append(&mut more);
        let ColumnData::Text(words) = words.finish() else { panic!("words") };
        let all: Vec<&str> = (0..words.codes.len()).map(|row| words.word(row)).collect();
        assert_eq!(all, ["O", "H", "H", "O", "H", "H", "C"]);
        assert_eq!(words.names.len(), 3);
    }
}
