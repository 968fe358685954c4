//! The columns of sphere tables: what a number of a row means, and the type of the numbers.

use std::fmt;

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Value, json};

use crate::names::named_enum;

use super::value_types::{InvalidValue, NonEmptyString, ParseValue, SpannedValue, ValueType};
use crate::names::did_you_mean;

/// The meaning of a number in a row of a sphere table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// Centre, x.
    X,
    /// Centre, y.
    Y,
    /// Centre, z.
    Z,
    /// Radius.
    Radius,
    /// Linear albedo, red.
    Red,
    /// Linear albedo, green.
    Green,
    /// Linear albedo, blue.
    Blue,
    /// Emitted radiance of all three channels, in W/(sr m^2).
    Emission,
    /// Emitted radiance, red, in W/(sr m^2).
    EmissionRed,
    /// Emitted radiance, green, in W/(sr m^2).
    EmissionGreen,
    /// Emitted radiance, blue, in W/(sr m^2).
    EmissionBlue,
}

named_enum! {
    Column {
        X = "x",
        Y = "y",
        Z = "z",
        Radius = "radius",
        Red = "r",
        Green = "g",
        Blue = "b",
        Emission = "emission",
        EmissionRed = "emission_r",
        EmissionGreen = "emission_g",
        EmissionBlue = "emission_b",
    }
}

/// The type of the numbers of a column, little-endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberType {
    /// 32-bit floats.
    F32,
    /// 64-bit floats.
    F64,
}

named_enum! { NumberType { F32 = "f32", F64 = "f64" } }

/// A column of a table file, as in `x`, `x:f64` or, for a column that is not read, `_`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileColumn {
    /// The meaning; `None` if the column is not read.
    pub column: Option<Column>,
    /// The type; `None` is the type in the header of a NumPy file, and otherwise
    /// [`NumberType::F32`].
    pub number: Option<NumberType>,
}

/// The name of a column that is not read.
const SKIPPED: &str = "_";

/// Words for columns and types in other programs, each with the one here.
const ALIASES: [(&str, &str); 15] = [
    ("red", "r"),
    ("green", "g"),
    ("blue", "b"),
    ("emission_red", "emission_r"),
    ("emission_green", "emission_g"),
    ("emission_blue", "emission_b"),
    ("f4", "f32"),
    ("<f4", "f32"),
    ("float", "f32"),
    ("float32", "f32"),
    ("single", "f32"),
    ("f8", "f64"),
    ("<f8", "f64"),
    ("float64", "f64"),
    ("double", "f64"),
];

impl Column {
    /// The four numbers that every table has.
    pub(super) const SPHERE: [Self; 4] = [Self::X, Self::Y, Self::Z, Self::Radius];
    /// The colour channels.
    pub(super) const COLOR: [Self; 3] = [Self::Red, Self::Green, Self::Blue];
    /// The channels of the emission.
    pub(super) const EMISSION: [Self; 3] =
        [Self::EmissionRed, Self::EmissionGreen, Self::EmissionBlue];

    /// Returns true if the column is a colour channel.
    pub fn is_color(self) -> bool {
        Self::COLOR.contains(&self)
    }

    /// Returns true if the column is emission: of one channel, or of all.
    pub fn is_emission(self) -> bool {
        self == Self::Emission || Self::EMISSION.contains(&self)
    }
}

impl NumberType {
    /// Bytes of a number.
    pub fn bytes(self) -> usize {
        match self {
            Self::F32 => size_of::<f32>(),
            Self::F64 => size_of::<f64>(),
        }
    }
}

/// A column without a type of its own.
impl From<Column> for FileColumn {
    fn from(column: Column) -> Self {
        Self { column: Some(column), number: None }
    }
}

impl fmt::Display for FileColumn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.column.map_or(SKIPPED, Column::name))?;
        self.number.map_or(Ok(()), |number| write!(f, ":{}", number.name()))
    }
}

impl FileColumn {
    /// Parses a column as a scene file writes it. The error is a suggestion.
    fn parse(text: &str) -> Result<Self, Option<String>> {
        let (name, number) = match text.split_once(':') {
            Some((name, number)) => (name, Some(number)),
            None => (text, None),
        };
        Self::named(name, number).ok_or_else(|| suggestion(name, number))
    }

    /// The column with this name and type; `None` if one of them is unknown.
    fn named(name: &str, number: Option<&str>) -> Option<Self> {
        let column = Column::named(name);
        let number = match number {
            Some(number) => Some(NumberType::named(number)?),
            None => None,
        };
        (column.is_some() || name == SKIPPED).then_some(Self { column, number })
    }
}

/// The column that may be meant by an unknown name or type.
fn suggestion(name: &str, number: Option<&str>) -> Option<String> {
    let alias = |word: &str| {
        let known = ALIASES.iter().find(|(alias, _)| *alias == word);
        known.map_or_else(|| word.to_owned(), |(_, meant)| (*meant).to_owned())
    };
    let (name, number) = (alias(name), number.map(alias));
    let text = number.iter().fold(name.clone(), |name, number| format!("{name}:{number}"));
    if FileColumn::named(&name, number.as_deref()).is_some() {
        return Some(format!("did you mean `{text}`?"));
    }
    let names = Column::NAMES.iter().map(|(name, _)| *name).chain([SKIPPED]);
    let known: Vec<String> = match number {
        None => names.map(str::to_owned).collect(),
        Some(_) => names
            .flat_map(|name| NumberType::NAMES.iter().map(move |(n, _)| format!("{name}:{n}")))
            .collect(),
    };
    did_you_mean(&text, known.iter().map(String::as_str))
}

impl Serialize for FileColumn {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for FileColumn {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let text = String::deserialize(from)?;
        Self::parse(&text)
            .map_err(|_| serde::de::Error::custom(format_args!("`{text}` is not a column")))
    }
}

/// An entry of `columns` in a scene file.
pub(super) struct ColumnValue;

impl ParseValue for ColumnValue {
    type Output = FileColumn;

    fn expects(&self) -> String {
        let names = Column::NAMES.iter().map(|(name, _)| format!("\"{name}\" or "));
        format!(
            "{}\"{SKIPPED}\" for a number that is not read, with an optional type, \":f32\" or \
             \":f64\"",
            names.collect::<String>()
        )
    }

    fn parse(&self, node: &SpannedValue<'_>) -> Result<FileColumn, InvalidValue> {
        let text = NonEmptyString.parse(node)?;
        FileColumn::parse(&text)
            .map_err(|help| InvalidValue { help, ..InvalidValue::new(node, format!("{text:?}")) })
    }
}

impl ValueType for ColumnValue {
    fn check(&self, _: &FileColumn) -> Result<(), String> {
        Ok(())
    }

    fn schema(&self) -> Value {
        let names = Column::NAMES.iter().map(|(name, _)| *name).chain([SKIPPED]);
        let typed = |name: &str| {
            let types = NumberType::NAMES.iter().map(|(number, _)| format!(":{number}"));
            let endings = std::iter::once(String::new()).chain(types);
            endings.map(|ending| format!("{name}{ending}")).collect::<Vec<_>>()
        };
        json!({ "enum": names.flat_map(typed).collect::<Vec<_>>() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_read_back_as_they_are_written() {
        let names = Column::NAMES.iter().map(|(_, column)| Some(*column)).chain([None]);
        for column in names {
            for number in [None, Some(NumberType::F32), Some(NumberType::F64)] {
                let given = FileColumn { column, number };
                assert_eq!(FileColumn::parse(&given.to_string()), Ok(given));
            }
        }
        let x = FileColumn { column: Some(Column::X), number: Some(NumberType::F64) };
        assert_eq!(FileColumn::parse("x:f64"), Ok(x));
        assert_eq!(FileColumn::parse("_"), Ok(FileColumn { column: None, number: None }));
    }

    #[test]
    fn unknown_columns_have_suggestions() {
        for (text, meant) in [
            ("radios", "radius"),
            ("radios:f64", "radius:f64"),
            ("x:f46", "x:f64"),
            ("x:f8", "x:f64"),
            ("x:<f4", "x:f32"),
            ("_:double", "_:f64"),
            ("red", "r"),
            ("blue:f4", "b:f32"),
            ("emission_red", "emission_r"),
            ("emision", "emission"),
        ] {
            let suggested = format!("did you mean `{meant}`?");
            assert_eq!(FileColumn::parse(text), Err(Some(suggested)), "{text}");
        }
        for text in ["x:", "temperature", "x:i32x", "x:f64:f32"] {
            assert!(FileColumn::parse(text).is_err(), "{text}");
        }
    }
}
