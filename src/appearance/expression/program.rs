//! A bound expression as steps of a stack machine, evaluated in chunks of rows.

use super::columns::FillRows;
use super::tree::{Binary, Unary};

/// Rows that are evaluated together; their numbers stay in the processor's cache.
pub(super) const CHUNK: usize = 1024;

/// The steps of an expression. Conditions are 1 and 0.
#[derive(Default)]
pub(super) struct Program<'a> {
    pub(super) steps: Vec<Step<'a>>,
}

/// One step; operations take their values from the top of the stack.
pub(super) enum Step<'a> {
    Constant(f64),
    Column(FillRows<'a>),
    /// 1 where the word of a row is one of the matching ones.
    Words {
        codes: &'a [u32],
        matching: Vec<bool>,
    },
    Unary(Unary),
    Binary(Binary),
}

impl Program<'_> {
    /// Evaluates the rows from `first` on into `results`, of at most [`CHUNK`] rows.
    pub(super) fn run(&self, first: usize, results: &mut [f64]) {
        let rows = results.len();
        let mut stack: Vec<Vec<f64>> = Vec::new();
        let mut spare: Vec<Vec<f64>> = Vec::new();
        for step in &self.steps {
            match step {
                Step::Constant(number) => {
                    let mut top = spare.pop().unwrap_or_else(|| vec![0.0; rows]);
                    top.fill(*number);
                    stack.push(top);
                }
                Step::Column(fill) => {
                    let mut top = spare.pop().unwrap_or_else(|| vec![0.0; rows]);
                    fill(first, &mut top);
                    stack.push(top);
                }
                Step::Words { codes, matching } => {
                    let mut top = spare.pop().unwrap_or_else(|| vec![0.0; rows]);
                    for (value, code) in top.iter_mut().zip(&codes[first..]) {
                        *value = truth(matching.get(*code as usize).copied().unwrap_or(false));
                    }
                    stack.push(top);
                }
                Step::Unary(op) => {
                    let top = stack.last_mut().expect("a sign stands before a value");
                    top.iter_mut().for_each(|value| *value = unary(*op, *value));
                }
                Step::Binary(op) => {
                    let right = stack.pop().expect("an operator has two sides");
                    let left = stack.last_mut().expect("an operator has two sides");
                    for (left, right) in left.iter_mut().zip(&right) {
                        *left = binary(*op, *left, *right);
                    }
                    spare.push(right);
                }
            }
        }
        results.copy_from_slice(&stack.pop().expect("an expression has a value"));
    }
}

fn truth(condition: bool) -> f64 {
    f64::from(u8::from(condition))
}

fn unary(op: Unary, x: f64) -> f64 {
    match op {
        Unary::Negate => -x,
        Unary::Not => 1.0 - x,
        Unary::Abs => x.abs(),
        Unary::Sqrt => x.sqrt(),
        Unary::Exp => libm::exp(x),
        Unary::Log => libm::log(x),
        Unary::Log10 => libm::log10(x),
        Unary::Sin => libm::sin(x),
        Unary::Cos => libm::cos(x),
        Unary::Floor => x.floor(),
    }
}

fn binary(op: Binary, x: f64, y: f64) -> f64 {
    match op {
        Binary::Or => x.max(y),
        Binary::And => x.min(y),
        Binary::Equal => truth(x == y),
        Binary::Differs => truth(x != y),
        Binary::Less => truth(x < y),
        Binary::AtMost => truth(x <= y),
        Binary::Greater => truth(x > y),
        Binary::AtLeast => truth(x >= y),
        Binary::Add => x + y,
        Binary::Subtract => x - y,
        Binary::Multiply => x * y,
        Binary::Divide => x / y,
        Binary::Remainder => x - y * (x / y).floor(),
        Binary::Power => libm::pow(x, y),
        Binary::Min => x.min(y),
        Binary::Max => x.max(y),
    }
}
