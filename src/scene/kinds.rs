//! What may stand behind a key: one small type for each kind of value, with its limits.
//!
//! A kind reads the value from a scene file, checks one that a program gives, and describes itself to
//! editors. It can say what it expects, so that one sentence serves for every mistake: "`key` must be
//! *what is expected*, not *what was found*".

use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;
use std::ops::RangeInclusive;

use serde_json::{Value, json};
use toml::Spanned;
use toml::de::{DeInteger, DeValue};

use crate::color::Rgb;
use crate::math::{DVec3, MAX_COORDINATE};
use crate::names::Named;

use super::suggest::did_you_mean;

/// Where a value stands.
pub(super) type Span = std::ops::Range<usize>;

/// A TOML value with its place.
pub(super) type Node<'d> = Spanned<DeValue<'d>>;

/// The longest name or path.
const LONGEST_TEXT: usize = 4096;

/// What reads a value.
pub(super) trait Read {
    type Output;

    /// Completes "must be ...".
    fn expects(&self) -> String;

    /// The value, or what is there instead.
    fn read(&self, node: &Node<'_>) -> Result<Self::Output, Unfit>;
}

/// A reader that needs to know nothing but the value.
pub(super) trait Kind: Read {
    /// What keeps a value from being allowed, as [`Unfit::found`].
    fn check(&self, value: &Self::Output) -> Result<(), String>;

    /// The value's JSON schema.
    fn schema(&self) -> Value;
}

/// What was found in place of what was expected.
pub(super) struct Unfit {
    pub(super) span: Span,
    /// Completes "not ...".
    pub(super) found: String,
    pub(super) help: Option<String>,
    /// Whether the value names something that does not stand in the scene.
    pub(super) names_nothing: bool,
}

impl Unfit {
    fn new(node: &Node<'_>, found: impl Into<String>) -> Self {
        Self { span: node.span(), found: found.into(), help: None, names_nothing: false }
    }

    pub(super) fn kind(node: &Node<'_>) -> Self {
        Self::new(node, kind_of(node))
    }
}

/// The type of a value, with its article.
pub(super) fn kind_of(node: &Node<'_>) -> &'static str {
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

/// Which numbers are allowed; never an infinite one or NaN.
#[derive(Clone, Copy)]
pub(super) enum Limits {
    /// Both ends are allowed.
    FromTo(f64, f64),
    /// The upper end is allowed.
    AboveTo(f64, f64),
    /// Neither end is allowed.
    Between(f64, f64),
}

/// A number within limits.
pub(super) struct Number(pub(super) Limits);

/// Three numbers, each within the limits.
pub(super) struct Triple(pub(super) Limits);

/// Three channels, each within the limits.
pub(super) struct Color(pub(super) Limits);

/// A whole number within a range.
pub(super) struct Whole<T>(pub(super) RangeInclusive<T>);

/// `true` or `false`.
pub(super) struct Flag;

/// A string that is not empty.
pub(super) struct Text;

/// One of a few words.
pub(super) struct Choice<T>(PhantomData<T>);

/// A word that stands for a value which has no name of its own, such as a metal.
pub(super) struct Word<T: 'static>(pub(super) &'static [(&'static str, T)]);

/// A list of which each entry is read alike; not empty.
pub(super) struct Each<E>(pub(super) E);

/// The name of one of the materials; becomes its index.
pub(super) struct MaterialName<'n>(pub(super) &'n BTreeMap<&'n str, usize>);

/// A point or a direction: three coordinates as large as a scene may be.
pub(super) const COORDINATES: Triple = Triple(Limits::FromTo(-MAX_COORDINATE, MAX_COORDINATE));

impl Limits {
    fn allow(self, x: f64) -> bool {
        match self {
            Self::FromTo(low, high) => low <= x && x <= high,
            Self::AboveTo(low, high) => low < x && x <= high,
            Self::Between(low, high) => low < x && x < high,
        }
    }

    fn schema(self) -> Value {
        let (low, high) = match self {
            Self::FromTo(low, high) => return json!({ "minimum": low, "maximum": high }),
            Self::AboveTo(low, high) => (low, json!({ "maximum": high })),
            Self::Between(low, high) => (low, json!({ "exclusiveMaximum": high })),
        };
        let mut schema = high;
        schema["exclusiveMinimum"] = json!(low);
        schema
    }

    fn words(self) -> String {
        match self {
            Self::FromTo(low, high) => format!("from {} to {}", shown(low), shown(high)),
            Self::AboveTo(low, high) => format!("above {} and at most {}", shown(low), shown(high)),
            Self::Between(low, high) => format!("above {} and below {}", shown(low), shown(high)),
        }
    }
}

impl Read for Number {
    type Output = f64;

    fn expects(&self) -> String {
        format!("a number {}", self.0.words())
    }

    fn read(&self, node: &Node<'_>) -> Result<f64, Unfit> {
        let (value, shown) = match node.get_ref() {
            DeValue::Float(float) => (float.as_str().parse().ok(), float.as_str()),
            DeValue::Integer(integer) => (whole(integer).map(|i| i as f64), integer.as_str()),
            _ => return Err(Unfit::kind(node)),
        };
        match value {
            Some(value) if self.0.allow(value) => Ok(value),
            _ => Err(Unfit::new(node, shown)),
        }
    }
}

impl Kind for Number {
    fn check(&self, value: &f64) -> Result<(), String> {
        if self.0.allow(*value) { Ok(()) } else { Err(shown(*value)) }
    }

    fn schema(&self) -> Value {
        let mut schema = self.0.schema();
        schema["type"] = json!("number");
        schema
    }
}

impl Read for Triple {
    type Output = DVec3;

    fn expects(&self) -> String {
        format!("three numbers {}", self.0.words())
    }

    fn read(&self, node: &Node<'_>) -> Result<DVec3, Unfit> {
        let DeValue::Array(entries) = node.get_ref() else {
            return Err(Unfit::kind(node));
        };
        let [x, y, z] = &entries[..] else {
            let plural = if entries.len() == 1 { "entry" } else { "entries" };
            return Err(Unfit::new(node, format!("{} {plural}", entries.len())));
        };
        let number = Number(self.0);
        Ok(DVec3::new(number.read(x)?, number.read(y)?, number.read(z)?))
    }
}

impl Kind for Triple {
    fn check(&self, value: &DVec3) -> Result<(), String> {
        value.to_array().iter().try_for_each(|number| Number(self.0).check(number))
    }

    fn schema(&self) -> Value {
        let number = Number(self.0).schema();
        json!({ "type": "array", "items": number, "minItems": 3, "maxItems": 3 })
    }
}

impl Read for Color {
    type Output = Rgb;

    fn expects(&self) -> String {
        Triple(self.0).expects()
    }

    fn read(&self, node: &Node<'_>) -> Result<Rgb, Unfit> {
        Triple(self.0).read(node).map(|color| color.as_vec3())
    }
}

impl Kind for Color {
    fn check(&self, value: &Rgb) -> Result<(), String> {
        Triple(self.0).check(&value.as_dvec3())
    }

    fn schema(&self) -> Value {
        Triple(self.0).schema()
    }
}

impl<T: Copy + Into<i64> + TryFrom<i64> + PartialOrd> Read for Whole<T> {
    type Output = T;

    fn expects(&self) -> String {
        let (least, most): (i64, i64) = ((*self.0.start()).into(), (*self.0.end()).into());
        if most == i64::MAX {
            format!("a whole number from {least} to 2^63 - 1")
        } else {
            format!("a whole number from {least} to {most}")
        }
    }

    fn read(&self, node: &Node<'_>) -> Result<T, Unfit> {
        let shown = match node.get_ref() {
            DeValue::Integer(integer) => integer.to_string(),
            DeValue::Float(float) => float.to_string(),
            _ => return Err(Unfit::kind(node)),
        };
        let value = node.get_ref().as_integer().and_then(whole).and_then(|i| T::try_from(i).ok());
        value.filter(|value| self.0.contains(value)).ok_or_else(|| Unfit::new(node, shown))
    }
}

impl<T> Kind for Whole<T>
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

impl Read for Flag {
    type Output = bool;

    fn expects(&self) -> String {
        "true or false".into()
    }

    fn read(&self, node: &Node<'_>) -> Result<bool, Unfit> {
        node.get_ref().as_bool().ok_or_else(|| Unfit::kind(node))
    }
}

impl Kind for Flag {
    fn check(&self, _: &bool) -> Result<(), String> {
        Ok(())
    }

    fn schema(&self) -> Value {
        json!({ "type": "boolean" })
    }
}

impl Read for Text {
    type Output = String;

    fn expects(&self) -> String {
        "a string".into()
    }

    fn read(&self, node: &Node<'_>) -> Result<String, Unfit> {
        match node.get_ref().as_str() {
            None => Err(Unfit::kind(node)),
            Some("") => Err(Unfit::new(node, "an empty one")),
            Some(text) if text.len() > LONGEST_TEXT => {
                Err(Unfit::new(node, format!("one of {} bytes", text.len())))
            }
            Some(text) => Ok(text.to_owned()),
        }
    }
}

impl Kind for Text {
    fn check(&self, value: &String) -> Result<(), String> {
        match value.len() {
            0 => Err("an empty one".to_owned()),
            length if length > LONGEST_TEXT => Err(format!("one of {length} bytes")),
            _ => Ok(()),
        }
    }

    fn schema(&self) -> Value {
        json!({ "type": "string", "minLength": 1, "maxLength": LONGEST_TEXT })
    }
}

impl<T: Named> Choice<T> {
    pub(super) const NEW: Self = Self(PhantomData);
}

impl<T: Named> Read for Choice<T> {
    type Output = T;

    fn expects(&self) -> String {
        Word(T::NAMES).expects()
    }

    fn read(&self, node: &Node<'_>) -> Result<T, Unfit> {
        Word(T::NAMES).read(node)
    }
}

impl<T: Named> Kind for Choice<T> {
    fn check(&self, _: &T) -> Result<(), String> {
        Ok(())
    }

    fn schema(&self) -> Value {
        Word(T::NAMES).schema()
    }
}

impl<T: Copy> Read for Word<T> {
    type Output = T;

    fn expects(&self) -> String {
        let words: Vec<_> = self.0.iter().map(|(word, _)| format!("\"{word}\"")).collect();
        words.join(" or ")
    }

    fn read(&self, node: &Node<'_>) -> Result<T, Unfit> {
        let word = Text.read(node)?;
        let choice = self.0.iter().find(|(known, _)| *known == word);
        choice.map(|(_, value)| *value).ok_or_else(|| Unfit {
            help: did_you_mean(&word, self.0.iter().map(|(known, _)| *known)),
            ..Unfit::new(node, format!("{word:?}"))
        })
    }
}

impl<T: Copy> Kind for Word<T> {
    fn check(&self, _: &T) -> Result<(), String> {
        Ok(())
    }

    fn schema(&self) -> Value {
        json!({ "enum": self.0.iter().map(|(word, _)| *word).collect::<Vec<_>>() })
    }
}

impl<E: Read> Read for Each<E> {
    type Output = Vec<E::Output>;

    fn expects(&self) -> String {
        format!("a list, each entry {}", self.0.expects())
    }

    fn read(&self, node: &Node<'_>) -> Result<Vec<E::Output>, Unfit> {
        match node.get_ref().as_array() {
            None => Err(Unfit::kind(node)),
            Some(entries) if entries.is_empty() => Err(Unfit::new(node, "an empty one")),
            Some(entries) => entries.iter().map(|entry| self.0.read(entry)).collect(),
        }
    }
}

impl<E: Kind> Kind for Each<E> {
    fn check(&self, value: &Vec<E::Output>) -> Result<(), String> {
        value.iter().try_for_each(|entry| self.0.check(entry))
    }

    fn schema(&self) -> Value {
        json!({ "type": "array", "items": self.0.schema(), "minItems": 1 })
    }
}

impl Read for MaterialName<'_> {
    type Output = usize;

    fn expects(&self) -> String {
        "the name of a material".into()
    }

    fn read(&self, node: &Node<'_>) -> Result<usize, Unfit> {
        let name = Text.read(node)?;
        self.0.get(&*name).copied().ok_or_else(|| {
            let add = || format!("add a table `[materials.{name}]`");
            Unfit {
                help: did_you_mean(&name, self.0.keys().copied()).or_else(|| Some(add())),
                names_nothing: true,
                ..Unfit::new(node, format!("{name:?}"))
            }
        })
    }
}

fn whole(integer: &DeInteger<'_>) -> Option<i64> {
    i64::from_str_radix(integer.as_str(), integer.radix()).ok()
}

/// A number as a person would write it.
pub(super) fn shown(x: f64) -> String {
    let is_handy = x == 0.0 || (1e-4..1e6).contains(&x.abs());
    if is_handy { x.to_string() } else { format!("{x:e}") }
}
