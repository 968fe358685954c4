//! Binds an expression to columns: checks the names and types, and makes a program.

use rayon::prelude::*;

use crate::names::did_you_mean;

use super::columns::{ColumnSource, ColumnValues};
use super::failure::ExpressionError;
use super::parse::parse;
use super::program::{CHUNK, Program, Step};
use super::tree::{Binary, Node, NodeKind, Unary};

/// Most columns that a message lists.
const MAX_LISTED: usize = 24;

/// A parsed expression.
#[derive(Clone, Debug)]
pub struct Expression {
    root: Node,
}

/// What a part of an expression yields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Number,
    Condition,
    Text,
}

impl Expression {
    /// Parses an expression.
    ///
    /// # Errors
    /// Points at the first mistake.
    pub fn parse(text: &str) -> Result<Self, ExpressionError> {
        parse(text).map(|root| Self { root })
    }

    /// The names of all columns that the expression uses, in the order of the text.
    pub fn columns(&self) -> Vec<&str> {
        let mut names = Vec::new();
        collect(&self.root, &mut names);
        names
    }

    /// Evaluates a condition for each of the first `rows` rows.
    ///
    /// # Errors
    /// If a column is missing, or the expression is no condition.
    pub fn select(
        &self,
        columns: &dyn ColumnSource,
        rows: usize,
    ) -> Result<Vec<bool>, ExpressionError> {
        let values = self.evaluate(columns, rows, Kind::Condition)?;
        Ok(values.into_par_iter().map(|truth| truth != 0.0).collect())
    }

    /// Evaluates a number for each of the first `rows` rows.
    ///
    /// # Errors
    /// If a column is missing, or the expression is no number.
    pub fn values(
        &self,
        columns: &dyn ColumnSource,
        rows: usize,
    ) -> Result<Vec<f64>, ExpressionError> {
        self.evaluate(columns, rows, Kind::Number)
    }

    fn evaluate(
        &self,
        columns: &dyn ColumnSource,
        rows: usize,
        wanted: Kind,
    ) -> Result<Vec<f64>, ExpressionError> {
        let mut binder = Binder { columns, program: Program::default() };
        let found = binder.push(&self.root)?;
        if found != wanted {
            return Err(mismatch(&self.root, wanted, found));
        }
        let program = binder.program;
        let mut values = vec![0.0; rows];
        let chunks = values.par_chunks_mut(CHUNK).enumerate();
        chunks.for_each(|(index, chunk)| program.run(index * CHUNK, chunk));
        Ok(values)
    }
}

fn collect<'n>(node: &'n Node, names: &mut Vec<&'n str>) {
    match &node.kind {
        NodeKind::Column(name) if !names.contains(&&**name) => names.push(name),
        NodeKind::Column(_) | NodeKind::Number(_) | NodeKind::Text(_) => {}
        NodeKind::Unary(_, inner) => collect(inner, names),
        NodeKind::Binary(_, left, right) => {
            collect(left, names);
            collect(right, names);
        }
    }
}

struct Binder<'a> {
    columns: &'a dyn ColumnSource,
    program: Program<'a>,
}

impl<'a> Binder<'a> {
    /// Appends the steps that leave the value of a node on the stack.
    fn push(&mut self, node: &Node) -> Result<Kind, ExpressionError> {
        match &node.kind {
            NodeKind::Number(number) => {
                self.program.steps.push(Step::Constant(*number));
                Ok(Kind::Number)
            }
            NodeKind::Text(_) => Ok(Kind::Text),
            NodeKind::Column(name) => match self.find(name, node)? {
                ColumnValues::Numbers(fill) => {
                    self.program.steps.push(Step::Column(fill));
                    Ok(Kind::Number)
                }
                ColumnValues::Texts { .. } => Ok(Kind::Text),
            },
            NodeKind::Unary(op, inner) => {
                let takes = if *op == Unary::Not { Kind::Condition } else { Kind::Number };
                self.demand(inner, takes)?;
                self.program.steps.push(Step::Unary(*op));
                Ok(takes)
            }
            NodeKind::Binary(op, left, right) => self.push_binary(*op, left, right),
        }
    }

    fn push_binary(
        &mut self,
        op: Binary,
        left: &Node,
        right: &Node,
    ) -> Result<Kind, ExpressionError> {
        let is_equality = matches!(op, Binary::Equal | Binary::Differs);
        if is_equality && (self.is_text(left)? || self.is_text(right)?) {
            return self.push_texts(op, left, right);
        }
        let takes = match op {
            Binary::Or | Binary::And => Kind::Condition,
            _ => Kind::Number,
        };
        self.demand(left, takes)?;
        self.demand(right, takes)?;
        self.program.steps.push(Step::Binary(op));
        let is_condition = takes == Kind::Condition || op.is_comparison();
        Ok(if is_condition { Kind::Condition } else { Kind::Number })
    }

    fn demand(&mut self, node: &Node, wanted: Kind) -> Result<(), ExpressionError> {
        let found = self.push(node)?;
        if found == wanted { Ok(()) } else { Err(mismatch(node, wanted, found)) }
    }

    fn is_text(&self, node: &Node) -> Result<bool, ExpressionError> {
        Ok(match &node.kind {
            NodeKind::Text(_) => true,
            NodeKind::Column(name) => {
                matches!(self.find(name, node)?, ColumnValues::Texts { .. })
            }
            _ => false,
        })
    }

    /// Compares a column of texts with a text.
    fn push_texts(
        &mut self,
        op: Binary,
        left: &Node,
        right: &Node,
    ) -> Result<Kind, ExpressionError> {
        let (column, name, text) = match (&left.kind, &right.kind) {
            (NodeKind::Column(name), NodeKind::Text(text)) => (left, name, text),
            (NodeKind::Text(text), NodeKind::Column(name)) => (right, name, text),
            _ => {
                let span = left.span.start..right.span.end;
                let help = "such as `element == \"O\"`".to_owned();
                let message = "a text can be compared with a column of texts only";
                return Err(ExpressionError::new(span, message).with_help(help));
            }
        };
        let ColumnValues::Texts { words, codes } = self.find(name, column)? else {
            return Err(mismatch(column, Kind::Text, Kind::Number));
        };
        let matching = words.iter().map(|word| (*word == text) == (op == Binary::Equal)).collect();
        self.program.steps.push(Step::Words { codes, matching });
        Ok(Kind::Condition)
    }

    fn find(&self, name: &str, node: &Node) -> Result<ColumnValues<'a>, ExpressionError> {
        self.columns.column(name).ok_or_else(|| {
            let names = self.columns.names();
            let help = did_you_mean(name, names.iter().copied())
                .unwrap_or_else(|| format!("columns: {}", listed(&names)));
            let error = ExpressionError::new(node.span.clone(), format!("no column `{name}`"));
            error.with_help(help)
        })
    }
}

/// The first few names.
fn listed(names: &[&str]) -> String {
    let more = if names.len() > MAX_LISTED { ", ..." } else { "" };
    names[..names.len().min(MAX_LISTED)].join(", ") + more
}

fn mismatch(node: &Node, wanted: Kind, found: Kind) -> ExpressionError {
    let (wanted_words, found_words) = (in_words(wanted), in_words(found));
    let message = format!("expected {wanted_words}, but this is {found_words}");
    let help = match (wanted, found) {
        (Kind::Condition, _) => Some("compare it, as in `z < 10`".to_owned()),
        (_, Kind::Text) => Some("compare texts with `==` or `!=`".to_owned()),
        _ => None,
    };
    ExpressionError::new(node.span.clone(), message).with_help(help)
}

fn in_words(kind: Kind) -> &'static str {
    match kind {
        Kind::Number => "a number",
        Kind::Condition => "a condition",
        Kind::Text => "a text",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    struct Table {
        words: Vec<String>,
        codes: Vec<u32>,
    }

    const NAMES: [&str; 5] = ["type", "z", "f_a[2]", "my column", "element"];

    impl ColumnSource for Table {
        fn names(&self) -> Vec<&str> {
            NAMES.to_vec()
        }

        fn column(&self, name: &str) -> Option<ColumnValues<'_>> {
            let factor = match name {
                "type" => 1.0,
                "z" => 0.5,
                "f_a[2]" => -1.0,
                "my column" => 2.0,
                "element" => {
                    let words = self.words.iter().map(String::as_str).collect();
                    return Some(ColumnValues::Texts { words, codes: &self.codes });
                }
                _ => return None,
            };
            let fill = move |first: usize, to: &mut [f64]| {
                for (row, value) in to.iter_mut().enumerate() {
                    *value = factor * (first + row) as f64;
                }
            };
            Some(ColumnValues::Numbers(Box::new(fill)))
        }
    }

    /// Rows with the elements H, O, H, O ...
    fn table(rows: usize) -> Table {
        let words = ["H", "O"].map(str::to_owned).to_vec();
        Table { words, codes: (0..rows as u32).map(|row| row % 2).collect() }
    }

    fn value(text: &str, row: usize) -> f64 {
        let expression = Expression::parse(text).unwrap_or_else(|e| panic!("{text}: {e:?}"));
        let values = expression.values(&table(row + 1), row + 1);
        values.unwrap_or_else(|e| panic!("{text}: {e:?}"))[row]
    }

    fn selected(text: &str, rows: usize) -> Vec<usize> {
        let expression = Expression::parse(text).unwrap_or_else(|e| panic!("{text}: {e:?}"));
        let chosen = expression.select(&table(rows), rows);
        let chosen = chosen.unwrap_or_else(|e| panic!("{text}: {e:?}"));
        (0..rows).filter(|row| chosen[*row]).collect()
    }

    fn failure(text: &str) -> ExpressionError {
        match Expression::parse(text) {
            Err(error) => error,
            Ok(expression) => match expression.select(&table(3), 3) {
                Err(error) => error,
                Ok(_) => panic!("{text} is accepted"),
            },
        }
    }

    #[test]
    fn operators_bind_as_in_mathematics() {
        for (text, expected) in [
            ("1 + 2 * 3", 7.0),
            ("(1 + 2) * 3", 9.0),
            ("10 - 4 - 3", 3.0),
            ("2 ^ 3 ^ 2", 512.0),
            ("-2 ^ 2", -4.0),
            ("2 ^ -1", 0.5),
            ("7 % 4", 3.0),
            ("-1 % 4", 3.0),
            ("12 / 4 / 3", 1.0),
            ("1.5e1 + .5", 15.5),
            ("min(3, 1, 2) + max(4, 5)", 6.0),
            ("sqrt(abs(-16)) + floor(2.9)", 6.0),
            ("exp(0) + log(1) + log10(100) + sin(0) + cos(0)", 4.0),
            ("--3", 3.0),
        ] {
            assert_eq!(value(text, 0), expected, "{text}");
        }
        assert_eq!(value("type + z + f_a[2] * 0.5 + `my column`", 4), 12.0 - 2.0 + 2.0 - 0.0);
    }

    #[test]
    fn conditions_select_rows() {
        assert_eq!(selected("type >= 2 && z < 2", 6), [2, 3]);
        assert_eq!(selected("type < 1 || type > 4", 6), [0, 5]);
        assert_eq!(selected("!(type == 1) && type != 3 && type <= 4", 6), [0, 2, 4]);
        assert_eq!(selected("element == 'O' && type < 4", 6), [1, 3]);
        assert_eq!(selected("\"H\" != element", 4), [1, 3]);
        assert_eq!(selected("element == \"Xe\"", 4), [0; 0]);
        assert_eq!(selected("0 / type == 0", 3), [1, 2], "not a number equals nothing");
        // Beyond one chunk.
        let rows = 3 * CHUNK + 5;
        assert_eq!(selected("type % 1000 == 0", rows).len(), rows.div_ceil(1000));
    }

    #[test]
    fn columns_are_listed_once() {
        let expression = Expression::parse("z < type && z > min(f_a[2], `my column`)").unwrap();
        assert_eq!(expression.columns(), ["z", "type", "f_a[2]", "my column"]);
    }

    #[test]
    fn errors_point_at_the_mistake() {
        for (text, span, message, help) in [
            ("tpye == 2", 0..4, "no column `tpye`", "did you mean `type`?"),
            ("vel == 2", 0..3, "no column `vel`", "columns: type, z, f_a[2], my column, element"),
            ("type = 2", 5..6, "`=` is no operator", "write `==` to compare"),
            ("z > 1 & z < 2", 6..7, "`&` is no operator", "write `&&` for \"and\""),
            ("z", 0..1, "expected a condition, but this is a number", "compare it, as in `z < 10`"),
            (
                "0 < z < 1",
                6..7,
                "a comparison has two sides",
                "join two comparisons: `0 < z && z < 10`",
            ),
            ("(z < 1", 6..6, "expected `)`, found the end", ""),
            ("z < 1)", 5..6, "expected an operator, found `)`", ""),
            ("z < ", 4..4, "expected a column, a number or a bracket, found the end", ""),
            ("sqr(z) < 1", 0..3, "there is no function `sqr`", "did you mean `sqrt`?"),
            (
                "Diameter (mm) / 2",
                0..8,
                "there is no function `Diameter`",
                "functions: min, max, abs, sqrt, exp, log, log10, sin, cos, floor; the name of a \
                 column with spaces or brackets stands in backticks: `d (mm)` / 2",
            ),
            (
                "Bead ID < 2",
                5..7,
                "expected an operator, found `ID`",
                "the name of a column with spaces or brackets stands in backticks: `d (mm)` / 2",
            ),
            (
                "element < 2",
                0..7,
                "expected a number, but this is a text",
                "compare texts with `==` or `!=`",
            ),
            ("z == 'a'", 0..1, "expected a text, but this is a number", ""),
            (
                "'a' == 'b'",
                0..10,
                "a text can be compared with a column of texts only",
                "such as `element == \"O\"`",
            ),
            ("z < 'a", 4..5, "there is no second ' to this one", ""),
            ("", 0..0, "the expression is empty", "such as `type == 2 && z < 10`"),
            ("z < 1.2.3", 7..9, "expected an operator, found 0.3", ""),
            ("éé > 1", 0..4, "no column `éé`", "columns: type, z, f_a[2], my column, element"),
        ] {
            let error = failure(text);
            assert_eq!((error.span, &*error.message), (span, message), "{text}");
            assert_eq!(error.help.unwrap_or_default(), help, "{text}");
        }
    }

    #[test]
    fn depth_and_length_are_bounded() {
        let deep = "(".repeat(100_000);
        assert!(failure(&deep).message.contains("nest more than 64 deep"));
        assert!(failure(&format!("{} z", "!".repeat(100_000))).message.contains("nest"));
        let long = vec!["1"; 2000].join("+") + " < z";
        assert!(failure(&long).message.contains("more than 1000 operators"));
    }

    #[test]
    fn an_error_is_located_in_its_text() {
        let error = failure("tpye == 2").locate("a.toml", "select = \"tpye == 2\"", 10);
        assert_eq!(error.to_string(), "a.toml:1:11: no column `tpye`");
    }
    proptest! {
        #[test]
        fn no_text_is_too_much(text in "[a-z0-9 .()<>=!&|+*/%^,'\"`_\\[\\]é-]{0,60}") {
            if let Ok(expression) = Expression::parse(&text) {
                let columns = table(3);
                let found = expression.values(&columns, 3).map(|values| values.len());
                let found = found.map_err(|error| error.span.end <= text.len());
                prop_assert!(found == Ok(3) || found == Err(true));
            } else if let Err(error) = Expression::parse(&text) {
                prop_assert!(text.get(error.span.clone()).is_some(), "{error:?}");
            }
        }
    }
}
