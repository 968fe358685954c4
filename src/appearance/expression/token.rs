//! Splits an expression into tokens.

use std::ops::Range;

use super::failure::ExpressionError;

/// A piece of an expression.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    Number(f64),
    /// A text in quotation marks, without them.
    Text(String),
    /// The name of a column or function.
    Name(String),
    /// An operator, a bracket or a comma.
    Sign(&'static str),
    End,
}

/// A token with its bytes in the text.
#[derive(Clone, Debug)]
pub(super) struct SpannedToken {
    pub(super) token: Token,
    pub(super) span: Range<usize>,
}

/// Longer signs come first.
const SIGNS: [&str; 18] = [
    "&&", "||", "==", "!=", "<=", ">=", "<", ">", "+", "-", "*", "/", "%", "^", "!", "(", ")", ",",
];

/// Splits the text; the last token is [`Token::End`].
///
/// # Errors
/// At the first character that begins no token.
pub(super) fn tokens(text: &str) -> Result<Vec<SpannedToken>, ExpressionError> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(c) = text[at..].chars().next() {
        if c.is_whitespace() {
            at += c.len_utf8();
            continue;
        }
        let (token, length) = next(&text[at..], at)?;
        found.push(SpannedToken { token, span: at..at + length });
        at += length;
    }
    found.push(SpannedToken { token: Token::End, span: at..at });
    Ok(found)
}

/// The token at the start of `rest`, which begins with no blank, and its length in bytes.
fn next(rest: &str, at: usize) -> Result<(Token, usize), ExpressionError> {
    let first = rest.chars().next().unwrap_or_default();
    if first.is_ascii_digit() || first == '.' {
        return number(rest, at);
    }
    if first.is_alphabetic() || first == '_' {
        let length = name_length(rest);
        return Ok((Token::Name(rest[..length].to_owned()), length));
    }
    if matches!(first, '"' | '\'' | '`') {
        return quoted(rest, first, at);
    }
    if let Some(sign) = SIGNS.into_iter().find(|sign| rest.starts_with(sign)) {
        return Ok((Token::Sign(sign), sign.len()));
    }
    let error =
        ExpressionError::new(at..at + first.len_utf8(), format!("`{first}` is no operator"));
    Err(error.with_help(instead_of(first).map(str::to_owned)))
}

fn instead_of(sign: char) -> Option<&'static str> {
    match sign {
        '=' => Some("write `==` to compare"),
        '&' => Some("write `&&` for \"and\""),
        '|' => Some("write `||` for \"or\""),
        _ => None,
    }
}

/// Length of a name: letters, digits, `_` and `.`, and an index as in `f_a[2]`.
fn name_length(rest: &str) -> usize {
    let is_part = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
    let length = rest.find(|c| !is_part(c)).unwrap_or(rest.len());
    let behind = &rest[length..];
    let index = behind.strip_prefix('[').and_then(|inner| {
        let digits = inner.find(|c: char| !c.is_ascii_digit())?;
        (digits > 0 && inner[digits..].starts_with(']')).then_some(digits + 2)
    });
    length + index.unwrap_or(0)
}

fn number(rest: &str, at: usize) -> Result<(Token, usize), ExpressionError> {
    let bytes = rest.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let mut length = digits(0);
    if bytes.get(length) == Some(&b'.') {
        length += 1 + digits(length + 1);
    }
    if matches!(bytes.get(length), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(length + 1), Some(b'+' | b'-')));
        let exponent = digits(length + 1 + sign);
        if exponent > 0 {
            length += 1 + sign + exponent;
        }
    }
    match rest[..length].parse() {
        Ok(number) => Ok((Token::Number(number), length)),
        Err(_) => Err(ExpressionError::new(
            at..at + length,
            format!("`{}` is no number", &rest[..length]),
        )),
    }
}

fn quoted(rest: &str, mark: char, at: usize) -> Result<(Token, usize), ExpressionError> {
    let Some(length) = rest[1..].find(mark) else {
        let message = format!("there is no second {mark} to this one");
        return Err(ExpressionError::new(at..at + 1, message));
    };
    let inner = rest[1..=length].to_owned();
    let token = if mark == '`' { Token::Name(inner) } else { Token::Text(inner) };
    Ok((token, length + 2))
}
