//! Value types of keys: one small type for each kind of value, with its limits.
//!
//! A value type parses a value from a scene file, checks a value from a program, and describes
//! itself to editors. It states what it expects, so that one sentence serves for every error:
//! "`key` must be *what is expected*, not *what was found*".

use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;
use std::ops::RangeInclusive;

use serde_json::{Value, json};
use toml::Spanned;
use toml::de::{DeInteger, DeValue};

use crate::appearance::named_color;
use crate::color::Rgb;
use crate::math::{DVec3, MAX_COORDINATE};
use crate::names::Named;

use crate::names::did_you_mean;

use super::synonyms;

/// Byte range of a value.
pub(super) type Span = std::ops::Range<usize>;

/// A TOML value with its position.
pub(super) type SpannedValue<'d> = Spanned<DeValue<'d>>;

/// Maximum length of a name or path.
const MAX_TEXT_BYTES: usize = 4096;

/// Parses a value.
pub(super) trait ParseValue {
    type Output;

    /// Completes "must be ...".
    fn expects(&self) -> String;

    /// Parses the value. The error describes what was found instead.
    fn parse(&self, node: &SpannedValue<'_>) -> Result<Self::Output, InvalidValue>;
}

/// A value type that needs no context to parse or check a value.
pub(super) trait ValueType: ParseValue {
    /// Checks a value. The error is worded like [`InvalidValue::found`].
    fn check(&self, value: &Self::Output) -> Result<(), String>;

    /// JSON schema of the value.
    fn schema(&self) -> Value;
}

/// A value that does not match what was expected.
pub(super) struct InvalidValue {
    pub(super) span: Span,
    /// Completes "not ...".
    pub(super) found: String,
    pub(super) help: Option<String>,
    /// True if the value refers to a name that is not in the scene.
    pub(super) is_unknown_name: bool,
}

impl InvalidValue {
    pub(super) fn new(node: &SpannedValue<'_>, found: impl Into<String>) -> Self {
        Self { span: node.span(), found: found.into(), help: None, is_unknown_name: false }
    }

    pub(super) fn wrong_type(node: &SpannedValue<'_>) -> Self {
        Self::new(node, type_name(node))
    }
}

/// The type of a value, with its article.
pub(super) fn type_name(node: &SpannedValue<'_>) -> &'static str {
    match node.get_ref() {
        DeValue::String(_) => "a string",
        DeValue::Integer(_) => "an integer",
        DeValue::Float(_) => "a float",
        DeValue::Boolean(_) => "a boolean",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "an array",
        DeValue::Table(_) => "a table",
    }
}

/// A range of allowed numbers, always excluding infinity and NaN.
#[derive(Clone, Copy)]
pub(super) enum NumberRange {
    /// Both ends are included.
    Closed(f64, f64),
    /// The upper end is included.
    LeftOpen(f64, f64),
    /// Neither end is included.
    Open(f64, f64),
}

/// A number within a range.
pub(super) struct Number(pub(super) NumberRange);

/// Three numbers, each within a range.
pub(super) struct Vector(pub(super) NumberRange);

/// Three linear colour channels, each within a range; or an sRGB colour as `#33aa33` or by name.
pub(super) struct Color(pub(super) NumberRange);

/// An integer within a range.
pub(super) struct Integer<T>(pub(super) RangeInclusive<T>);

/// `true` or `false`.
pub(super) struct Boolean;

/// A non-empty string.
pub(super) struct NonEmptyString;

/// A non-empty string, or a number that stands for its text.
pub(super) struct TextOrNumber;

/// One of a few words.
pub(super) struct EnumValue<T>(PhantomData<T>);

/// A word for a predefined value, such as a metal.
pub(super) struct NamedValue<T: 'static>(pub(super) &'static [(&'static str, T)]);

/// A non-empty list of entries of one type.
pub(super) struct ListOf<E>(pub(super) E);

/// The name of a material; parsed to its index.
pub(super) struct MaterialName<'n>(pub(super) &'n BTreeMap<&'n str, usize>);

/// A point or direction: three coordinates within the scene limits.
pub(super) const COORDINATES: Vector = Vector(NumberRange::Closed(-MAX_COORDINATE, MAX_COORDINATE));

impl NumberRange {
    fn contains(self, x: f64) -> bool {
        match self {
            Self::Closed(low, high) => low <= x && x <= high,
            Self::LeftOpen(low, high) => low < x && x <= high,
            Self::Open(low, high) => low < x && x < high,
        }
    }

    fn schema(self) -> Value {
        let (low, high) = match self {
            Self::Closed(low, high) => return json!({ "minimum": low, "maximum": high }),
            Self::LeftOpen(low, high) => (low, json!({ "maximum": high })),
            Self::Open(low, high) => (low, json!({ "exclusiveMaximum": high })),
        };
        let mut schema = high;
        schema["exclusiveMinimum"] = json!(low);
        schema
    }

    fn describe(self) -> String {
        match self {
            Self::Closed(low, high) => {
                format!("from {} to {}", format_number(low), format_number(high))
            }
            Self::LeftOpen(low, high) => {
                format!("above {} and at most {}", format_number(low), format_number(high))
            }
            Self::Open(low, high) => {
                format!("above {} and below {}", format_number(low), format_number(high))
            }
        }
    }
}

impl ParseValue for Number {
    type Output = f64;

    fn expects(&self) -> String {
        format!("a number {}", self.0.describe())
    }

    fn parse(&self, node: &SpannedValue<'_>) -> Result<f64, InvalidValue> {
        let (value, shown) = match node.get_ref() {
            DeValue::Float(float) => (float.as_str().parse().ok(), float.as_str()),
            DeValue::Integer(integer) => {
                (parse_integer(integer).map(|i| i as f64), integer.as_str())
            }
            _ => return Err(InvalidValue::wrong_type(node)),
        };
        match value {
            Some(value) if self.0.contains(value) => Ok(value),
            _ => Err(InvalidValue::new(node, shown)),
        }
    }
}

impl ValueType for Number {
    fn check(&self, value: &f64) -> Result<(), String> {
        if self.0.contains(*value) { Ok(()) } else { Err(format_number(*value)) }
    }

    fn schema(&self) -> Value {
        let mut schema = self.0.schema();
        schema["type"] = json!("number");
        schema
    }
}

impl ParseValue for Vector {
    type Output = DVec3;

    fn expects(&self) -> String {
        format!("three numbers {}", self.0.describe())
    }

    fn parse(&self, node: &SpannedValue<'_>) -> Result<DVec3, InvalidValue> {
        let DeValue::Array(entries) = node.get_ref() else {
            let text = node.get_ref().as_str();
            let numbers =
                text.filter(|text| text.split(',').all(|x| x.trim().parse::<f64>().is_ok()));
            let help = numbers.map(|numbers| format!("write [{numbers}]"));
            return Err(InvalidValue { help, ..InvalidValue::wrong_type(node) });
        };
        let [x, y, z] = &entries[..] else {
            let plural = if entries.len() == 1 { "entry" } else { "entries" };
            return Err(InvalidValue::new(node, format!("{} {plural}", entries.len())));
        };
        let number = Number(self.0);
        Ok(DVec3::new(number.parse(x)?, number.parse(y)?, number.parse(z)?))
    }
}

impl ValueType for Vector {
    fn check(&self, value: &DVec3) -> Result<(), String> {
        value.to_array().iter().try_for_each(|number| Number(self.0).check(number))
    }

    fn schema(&self) -> Value {
        let number = Number(self.0).schema();
        json!({ "type": "array", "items": number, "minItems": 3, "maxItems": 3 })
    }
}

impl ParseValue for Color {
    type Output = Rgb;

    fn expects(&self) -> String {
        Vector(self.0).expects()
    }

    fn parse(&self, node: &SpannedValue<'_>) -> Result<Rgb, InvalidValue> {
        match node.get_ref().as_str() {
            Some(text) => named_color(text).ok_or_else(|| InvalidValue {
                help: Some("a colour may also be \"#33aa33\" or a name such as \"tomato\"".into()),
                ..InvalidValue::new(node, format!("{text:?}"))
            }),
            None => Vector(self.0).parse(node).map(|color| color.as_vec3()),
        }
    }
}

impl ValueType for Color {
    fn check(&self, value: &Rgb) -> Result<(), String> {
        Vector(self.0).check(&value.as_dvec3())
    }

    fn schema(&self) -> Value {
        let text = json!({ "type": "string", "minLength": 1 });
        json!({ "anyOf": [Vector(self.0).schema(), text] })
    }
}

impl<T: Copy + Into<i64> + TryFrom<i64> + PartialOrd> ParseValue for Integer<T> {
    type Output = T;

    fn expects(&self) -> String {
        let (least, most): (i64, i64) = ((*self.0.start()).into(), (*self.0.end()).into());
        if most == i64::MAX {
            format!("a whole number from {least} to 2^63 - 1")
        } else {
            format!("a whole number from {least} to {most}")
        }
    }

    fn parse(&self, node: &SpannedValue<'_>) -> Result<T, InvalidValue> {
        let shown = match node.get_ref() {
            DeValue::Integer(integer) => integer.to_string(),
            DeValue::Float(float) => float.to_string(),
            _ => return Err(InvalidValue::wrong_type(node)),
        };
        let value =
            node.get_ref().as_integer().and_then(parse_integer).and_then(|i| T::try_from(i).ok());
        value.filter(|value| self.0.contains(value)).ok_or_else(|| InvalidValue::new(node, shown))
    }
}

impl<T> ValueType for Integer<T>
where
    T: Copy + Into<i64> + TryFrom<i64> + PartialOrd + fmt::Display,
{
    fn check(&self, value: &T) -> Result<(), String> {
        if self.0.contains(value) { Ok(()) } else { Err(value.to_string()) }
    }

    fn schema(&self) -> Value {
        let (low, high): (i64, i64) = ((*self.0.start()).into(), (*self.0.end()).into());
        json!({ "type": "integer", "minimum": low, "maximum": high })
    }
}

impl ParseValue for Boolean {
    type Output = bool;

    fn expects(&self) -> String {
        "true or false".into()
    }

    fn parse(&self, node: &SpannedValue<'_>) -> Result<bool, InvalidValue> {
        node.get_ref().as_bool().ok_or_else(|| InvalidValue::wrong_type(node))
    }
}

impl ValueType for Boolean {
    fn check(&self, _: &bool) -> Result<(), String> {
        Ok(())
    }

    fn schema(&self) -> Value {
        json!({ "type": "boolean" })
    }
}

impl ParseValue for NonEmptyString {
    type Output = String;

    fn expects(&self) -> String {
        "a string".into()
    }

    fn parse(&self, node: &SpannedValue<'_>) -> Result<String, InvalidValue> {
        match node.get_ref().as_str() {
            None => Err(InvalidValue::wrong_type(node)),
            Some("") => Err(InvalidValue::new(node, "an empty one")),
            Some(text) if text.len() > MAX_TEXT_BYTES => {
                Err(InvalidValue::new(node, format!("one of {} bytes", text.len())))
            }
            Some(text) => Ok(text.to_owned()),
        }
    }
}

impl ValueType for NonEmptyString {
    fn check(&self, value: &String) -> Result<(), String> {
        match value.len() {
            0 => Err("an empty one".to_owned()),
            length if length > MAX_TEXT_BYTES => Err(format!("one of {length} bytes")),
            _ => Ok(()),
        }
    }

    fn schema(&self) -> Value {
        json!({ "type": "string", "minLength": 1, "maxLength": MAX_TEXT_BYTES })
    }
}

impl ParseValue for TextOrNumber {
    type Output = String;

    fn expects(&self) -> String {
        "a string or a number".into()
    }

    fn parse(&self, node: &SpannedValue<'_>) -> Result<String, InvalidValue> {
        match node.get_ref() {
            DeValue::Integer(integer) => Ok(integer.to_string()),
            DeValue::Float(float) => Ok(float.to_string()),
            _ => NonEmptyString.parse(node),
        }
    }
}

impl ValueType for TextOrNumber {
    fn check(&self, value: &String) -> Result<(), String> {
        NonEmptyString.check(value)
    }

    fn schema(&self) -> Value {
        let mut schema = NonEmptyString.schema();
        schema["type"] = json!(["string", "number"]);
        schema
    }
}

impl<T: Named> EnumValue<T> {
    pub(super) const NEW: Self = Self(PhantomData);
}

impl<T: Named> ParseValue for EnumValue<T> {
    type Output = T;

    fn expects(&self) -> String {
        NamedValue(T::NAMES).expects()
    }

    fn parse(&self, node: &SpannedValue<'_>) -> Result<T, InvalidValue> {
        NamedValue(T::NAMES).parse(node)
    }
}

impl<T: Named> ValueType for EnumValue<T> {
    fn check(&self, _: &T) -> Result<(), String> {
        Ok(())
    }

    fn schema(&self) -> Value {
        NamedValue(T::NAMES).schema()
    }
}

impl<T: Copy> ParseValue for NamedValue<T> {
    type Output = T;

    fn expects(&self) -> String {
        let words: Vec<_> = self.0.iter().map(|(word, _)| format!("\"{word}\"")).collect();
        words.join(" or ")
    }

    fn parse(&self, node: &SpannedValue<'_>) -> Result<T, InvalidValue> {
        let word = NonEmptyString.parse(node)?;
        let choice = self.0.iter().find(|(known, _)| *known == word);
        choice.map(|(_, value)| *value).ok_or_else(|| InvalidValue {
            help: synonyms::value(&word, self.0.iter().map(|(known, _)| *known))
                .or_else(|| did_you_mean(&word, self.0.iter().map(|(known, _)| *known))),
            ..InvalidValue::new(node, format!("{word:?}"))
        })
    }
}

impl<T: Copy> ValueType for NamedValue<T> {
    fn check(&self, _: &T) -> Result<(), String> {
        Ok(())
    }

    fn schema(&self) -> Value {
        json!({ "enum": self.0.iter().map(|(word, _)| *word).collect::<Vec<_>>() })
    }
}

impl<E: ParseValue> ParseValue for ListOf<E> {
    type Output = Vec<E::Output>;

    fn expects(&self) -> String {
        format!("a list, each entry {}", self.0.expects())
    }

    fn parse(&self, node: &SpannedValue<'_>) -> Result<Vec<E::Output>, InvalidValue> {
        match node.get_ref().as_array() {
            None => Err(InvalidValue::wrong_type(node)),
            Some(entries) if entries.is_empty() => Err(InvalidValue::new(node, "an empty one")),
            Some(entries) => entries.iter().map(|entry| self.0.parse(entry)).collect(),
        }
    }
}

impl<E: ValueType> ValueType for ListOf<E> {
    fn check(&self, value: &Vec<E::Output>) -> Result<(), String> {
        value.iter().try_for_each(|entry| self.0.check(entry))
    }

    fn schema(&self) -> Value {
        json!({ "type": "array", "items": self.0.schema(), "minItems": 1 })
    }
}

impl ParseValue for MaterialName<'_> {
    type Output = usize;

    fn expects(&self) -> String {
        "the name of a material".into()
    }

    fn parse(&self, node: &SpannedValue<'_>) -> Result<usize, InvalidValue> {
        let name = NonEmptyString.parse(node)?;
        self.0.get(&*name).copied().ok_or_else(|| {
            let add = || format!("add a table `[materials.{name}]`");
            InvalidValue {
                help: did_you_mean(&name, self.0.keys().copied()).or_else(|| Some(add())),
                is_unknown_name: true,
                ..InvalidValue::new(node, format!("{name:?}"))
            }
        })
    }
}

fn parse_integer(integer: &DeInteger<'_>) -> Option<i64> {
    i64::from_str_radix(integer.as_str(), integer.radix()).ok()
}

/// Formats a number in a readable form.
pub(super) fn format_number(x: f64) -> String {
    let is_handy = x == 0.0 || (1e-4..1e6).contains(&x.abs());
    if is_handy { x.to_string() } else { format!("{x:e}") }
}
