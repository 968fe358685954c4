//! Parses tokens into a tree, by precedence climbing.

use crate::names::did_you_mean;

use super::failure::ExpressionError;
use super::token::{SpannedToken, Token, tokens};
use super::tree::{Binary, FOLDS, FUNCTIONS, Node, NodeKind, Unary};

/// How deep brackets, functions and signs may nest.
const MAX_DEPTH: usize = 64;

/// How many operators and functions an expression may have.
const MAX_NODES: usize = 1000;

/// The operators between two values, with how tightly they bind.
const OPERATORS: [(&str, Binary, u8); 14] = [
    ("||", Binary::Or, 1),
    ("&&", Binary::And, 2),
    ("==", Binary::Equal, 3),
    ("!=", Binary::Differs, 3),
    ("<", Binary::Less, 3),
    ("<=", Binary::AtMost, 3),
    (">", Binary::Greater, 3),
    (">=", Binary::AtLeast, 3),
    ("+", Binary::Add, 4),
    ("-", Binary::Subtract, 4),
    ("*", Binary::Multiply, 5),
    ("/", Binary::Divide, 5),
    ("%", Binary::Remainder, 5),
    ("^", Binary::Power, 7),
];

/// How tightly a sign in front binds: looser than a power, tighter than a product.
const SIGN_BINDS: u8 = 6;

/// What to do about a name of a column that looks like several tokens.
const NAMES_IN_BACKTICKS: &str =
    "the name of a column with spaces or brackets stands in backticks: `d (mm)` / 2";

/// Parses a whole expression.
///
/// # Errors
/// At the first token that does not fit.
pub(super) fn parse(text: &str) -> Result<Node, ExpressionError> {
    let tokens = tokens(text)?;
    if tokens.len() == 1 {
        let help = "such as `type == 2 && z < 10`".to_owned();
        return Err(ExpressionError::new(0..text.len(), "the expression is empty").with_help(help));
    }
    let mut parser = Parser { tokens, at: 0, depth: 0, nodes: 0 };
    let node = parser.binary(0)?;
    match parser.peek() {
        Token::End => Ok(node),
        Token::Name(_) => {
            Err(parser.unexpected("an operator").with_help(NAMES_IN_BACKTICKS.to_owned()))
        }
        _ => Err(parser.unexpected("an operator")),
    }
}

struct Parser {
    tokens: Vec<SpannedToken>,
    at: usize,
    depth: usize,
    nodes: usize,
}

impl Parser {
    fn peek(&self) -> &Token {
        &self.tokens[self.at].token
    }

    fn take(&mut self) -> SpannedToken {
        let taken = self.tokens[self.at].clone();
        self.at = (self.at + 1).min(self.tokens.len() - 1);
        taken
    }

    fn accept(&mut self, sign: &str) -> bool {
        let is_there = matches!(self.peek(), Token::Sign(found) if *found == sign);
        if is_there {
            self.take();
        }
        is_there
    }

    fn operator(&self) -> Option<(Binary, u8)> {
        let Token::Sign(sign) = self.peek() else { return None };
        OPERATORS.into_iter().find(|(known, ..)| known == sign).map(|(_, op, binds)| (op, binds))
    }

    /// A chain of operators that bind at least this tightly.
    fn binary(&mut self, at_least: u8) -> Result<Node, ExpressionError> {
        self.deeper()?;
        let mut left = self.unary()?;
        while let Some((op, binds)) = self.operator().filter(|(_, binds)| *binds >= at_least) {
            if op.is_comparison()
                && matches!(&left.kind, NodeKind::Binary(b, ..) if b.is_comparison())
            {
                let help = "join two comparisons: `0 < z && z < 10`".to_owned();
                let span = self.tokens[self.at].span.clone();
                return Err(
                    ExpressionError::new(span, "a comparison has two sides").with_help(help)
                );
            }
            self.take();
            let is_power = op == Binary::Power;
            let right = self.binary(if is_power { SIGN_BINDS } else { binds + 1 })?;
            left = self.joined(op, left, right)?;
        }
        self.depth -= 1;
        Ok(left)
    }

    fn joined(&mut self, op: Binary, left: Node, right: Node) -> Result<Node, ExpressionError> {
        self.count()?;
        let span = left.span.start..right.span.end;
        Ok(Node { kind: NodeKind::Binary(op, Box::new(left), Box::new(right)), span })
    }

    fn unary(&mut self) -> Result<Node, ExpressionError> {
        let begin = self.tokens[self.at].span.start;
        let op = match self.peek() {
            Token::Sign("-") => Unary::Negate,
            Token::Sign("!") => Unary::Not,
            _ => return self.primary(),
        };
        self.take();
        let inner = self.binary(SIGN_BINDS)?;
        self.applied(op, inner, begin)
    }

    fn applied(&mut self, op: Unary, inner: Node, begin: usize) -> Result<Node, ExpressionError> {
        self.count()?;
        let span = begin..inner.span.end;
        Ok(Node { kind: NodeKind::Unary(op, Box::new(inner)), span })
    }

    fn primary(&mut self) -> Result<Node, ExpressionError> {
        let is_value = matches!(self.peek(), Token::Number(_) | Token::Text(_) | Token::Name(_));
        if !is_value {
            if self.accept("(") {
                let inner = self.binary(0)?;
                self.demand(")")?;
                return Ok(inner);
            }
            return Err(self.unexpected("a column, a number or a bracket"));
        }
        let SpannedToken { token, span } = self.take();
        let kind = match token {
            Token::Number(number) => NodeKind::Number(number),
            Token::Text(text) => NodeKind::Text(text),
            Token::Name(name) if self.accept("(") => return self.function(&name, span),
            Token::Name(name) => NodeKind::Column(name),
            Token::Sign(_) | Token::End => return Err(self.unexpected("a value")),
        };
        Ok(Node { kind, span })
    }

    /// The arguments of a function, behind its bracket.
    fn function(
        &mut self,
        name: &str,
        span: std::ops::Range<usize>,
    ) -> Result<Node, ExpressionError> {
        let first = self.binary(0)?;
        if let Some((_, op)) = FOLDS.into_iter().find(|(known, _)| *known == name) {
            let mut all = first;
            while self.accept(",") {
                let next = self.binary(0)?;
                all = self.joined(op, all, next)?;
            }
            self.demand(")")?;
            return Ok(Node { span: span.start..self.end_of_last(), ..all });
        }
        let Some((_, op)) = FUNCTIONS.into_iter().find(|(known, _)| *known == name) else {
            let known = FOLDS.iter().map(|(name, _)| *name);
            let known = known.chain(FUNCTIONS.iter().map(|(name, _)| *name));
            let help = did_you_mean(name, known.clone());
            let all = || {
                let known = known.collect::<Vec<_>>().join(", ");
                format!("functions: {known}; {NAMES_IN_BACKTICKS}")
            };
            let error = ExpressionError::new(span, format!("there is no function `{name}`"));
            return Err(error.with_help(help.unwrap_or_else(all)));
        };
        self.demand(")")?;
        let mut node = self.applied(op, first, span.start)?;
        node.span.end = self.end_of_last();
        Ok(node)
    }

    fn end_of_last(&self) -> usize {
        self.tokens[self.at.saturating_sub(1)].span.end
    }

    fn demand(&mut self, sign: &'static str) -> Result<(), ExpressionError> {
        if self.accept(sign) { Ok(()) } else { Err(self.unexpected(&format!("`{sign}`"))) }
    }

    fn unexpected(&self, expected: &str) -> ExpressionError {
        let SpannedToken { token, span } = &self.tokens[self.at];
        let found = match token {
            Token::End => "the end".to_owned(),
            Token::Sign(sign) => format!("`{sign}`"),
            Token::Number(number) => number.to_string(),
            Token::Text(text) => format!("{text:?}"),
            Token::Name(name) => format!("`{name}`"),
        };
        ExpressionError::new(span.clone(), format!("expected {expected}, found {found}"))
    }

    fn deeper(&mut self) -> Result<(), ExpressionError> {
        self.depth += 1;
        if self.depth <= MAX_DEPTH {
            return Ok(());
        }
        let message = format!("brackets and signs nest more than {MAX_DEPTH} deep");
        Err(ExpressionError::new(self.tokens[self.at].span.clone(), message))
    }

    fn count(&mut self) -> Result<(), ExpressionError> {
        self.nodes += 1;
        if self.nodes <= MAX_NODES {
            return Ok(());
        }
        let message = format!("the expression has more than {MAX_NODES} operators");
        Err(ExpressionError::new(self.tokens[self.at].span.clone(), message))
    }
}
