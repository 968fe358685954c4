//! An expression as a tree.

use std::ops::Range;

/// A part of an expression, with its bytes in the text.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub(super) kind: NodeKind,
    pub(super) span: Range<usize>,
}

/// What a part of an expression is.
#[derive(Clone, Debug)]
pub(super) enum NodeKind {
    Number(f64),
    Text(String),
    Column(String),
    Unary(Unary, Box<Node>),
    Binary(Binary, Box<Node>, Box<Node>),
}

/// An operation on one value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unary {
    Negate,
    Not,
    Abs,
    Sqrt,
    Exp,
    Log,
    Log10,
    Sin,
    Cos,
    Floor,
}

/// An operation on two values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Binary {
    Or,
    And,
    Equal,
    Differs,
    Less,
    AtMost,
    Greater,
    AtLeast,
    Add,
    Subtract,
    Multiply,
    Divide,
    Remainder,
    Power,
    Min,
    Max,
}

/// The functions of one argument.
pub(super) const FUNCTIONS: [(&str, Unary); 8] = [
    ("abs", Unary::Abs),
    ("sqrt", Unary::Sqrt),
    ("exp", Unary::Exp),
    ("log", Unary::Log),
    ("log10", Unary::Log10),
    ("sin", Unary::Sin),
    ("cos", Unary::Cos),
    ("floor", Unary::Floor),
];

/// The functions of several arguments.
pub(super) const FOLDS: [(&str, Binary); 2] = [("min", Binary::Min), ("max", Binary::Max)];

impl Binary {
    /// Returns true if the operation compares two values.
    pub(super) fn is_comparison(self) -> bool {
        use Binary::{AtLeast, AtMost, Differs, Equal, Greater, Less};
        matches!(self, Equal | Differs | Less | AtMost | Greater | AtLeast)
    }
}
