//! Parses the Python literal in the header of a NumPy file.

/// Maximum nesting of lists, tuples and dictionaries.
const MAX_DEPTH: usize = 8;

/// A Python literal.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Literal {
    Text(String),
    Number(u64),
    Boolean(bool),
    /// A list or tuple.
    List(Vec<Literal>),
    /// A dictionary with text keys.
    Dict(Vec<(String, Literal)>),
}

impl Literal {
    /// Parses a whole text, surrounded by white space; `None` if it is anything else.
    pub(super) fn parse(text: &[u8]) -> Option<Self> {
        let mut parser = Parser { rest: text };
        let literal = parser.value(MAX_DEPTH)?;
        parser.skip_space();
        parser.rest.is_empty().then_some(literal)
    }

    /// The value of a dictionary's key.
    pub(super) fn get(&self, key: &str) -> Option<&Self> {
        match self {
            Self::Dict(entries) => entries.iter().find(|(name, _)| name == key).map(|(_, v)| v),
            _ => None,
        }
    }

    /// The entries of a list or tuple.
    pub(super) fn entries(&self) -> Option<&[Self]> {
        if let Self::List(entries) = self { Some(entries) } else { None }
    }

    /// The text of a string.
    pub(super) fn text(&self) -> Option<&str> {
        if let Self::Text(text) = self { Some(text) } else { None }
    }

    /// The value of a whole number.
    pub(super) fn number(&self) -> Option<u64> {
        if let Self::Number(number) = *self { Some(number) } else { None }
    }
}

struct Parser<'t> {
    rest: &'t [u8],
}

impl Parser<'_> {
    fn skip_space(&mut self) {
        self.rest = self.rest.trim_ascii_start();
    }

    /// The next byte that is not white space.
    fn peek(&mut self) -> Option<u8> {
        self.skip_space();
        self.rest.first().copied()
    }

    /// Consumes this byte if it is next, after white space.
    fn take(&mut self, byte: u8) -> bool {
        let is_next = self.peek() == Some(byte);
        if is_next {
            self.rest = &self.rest[1..];
        }
        is_next
    }

    fn value(&mut self, depth: usize) -> Option<Literal> {
        let depth = depth.checked_sub(1)?;
        match self.peek()? {
            b'\'' | b'"' => self.string().map(Literal::Text),
            b'0'..=b'9' => self.number().map(Literal::Number),
            b'[' => self.list(b'[', b']', depth),
            b'(' => self.list(b'(', b')', depth),
            b'{' => self.dict(depth),
            _ => self.word(),
        }
    }

    fn string(&mut self) -> Option<String> {
        let (&quote, rest) = self.rest.split_first()?;
        let end = rest.iter().position(|&byte| byte == quote)?;
        let text = &rest[..end];
        self.rest = &rest[end + 1..];
        // An escape would need more than copying; no header that NumPy writes needs one.
        (!text.contains(&b'\\')).then(|| String::from_utf8_lossy(text).into_owned())
    }

    fn number(&mut self) -> Option<u64> {
        let is_digit = |byte: &u8| byte.is_ascii_digit();
        let end = self.rest.iter().position(|byte| !is_digit(byte)).unwrap_or(self.rest.len());
        let (digits, rest) = self.rest.split_at(end);
        // Python 2 ends long integers with an L.
        self.rest = rest.strip_prefix(b"L").unwrap_or(rest);
        std::str::from_utf8(digits).ok()?.parse().ok()
    }

    fn word(&mut self) -> Option<Literal> {
        for (word, value) in [(&b"True"[..], true), (b"False", false)] {
            if let Some(rest) = self.rest.strip_prefix(word) {
                self.rest = rest;
                return Some(Literal::Boolean(value));
            }
        }
        None
    }

    /// A list, or a tuple: `(3)` counts as `(3,)`.
    fn list(&mut self, open: u8, close: u8, depth: usize) -> Option<Literal> {
        let mut entries = Vec::new();
        self.take(open);
        while !self.take(close) {
            entries.push(self.value(depth)?);
            if !self.take(b',') && self.peek()? != close {
                return None;
            }
        }
        Some(Literal::List(entries))
    }

    fn dict(&mut self, depth: usize) -> Option<Literal> {
        let mut entries = Vec::new();
        self.take(b'{');
        while !self.take(b'}') {
            self.peek()?;
            let key = self.value(1)?.text()?.to_owned();
            if !self.take(b':') {
                return None;
            }
            entries.push((key, self.value(depth)?));
            if !self.take(b',') && self.peek()? != b'}' {
                return None;
            }
        }
        Some(Literal::Dict(entries))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_are_parsed() {
        let text = b"{'descr': [('x', '<f4'), (\"y\", '<f8', (3,))], 'fortran_order': False, \
                     'shape': (12L, 4), }   \n";
        let header = Literal::parse(text).expect("a header");
        assert_eq!(header.get("fortran_order"), Some(&Literal::Boolean(false)));
        let shape = header.get("shape").and_then(Literal::entries).expect("a tuple");
        assert_eq!(shape.iter().map(Literal::number).collect::<Vec<_>>(), [Some(12), Some(4)]);
        let fields = header.get("descr").and_then(Literal::entries).expect("a list");
        let of_y = fields[1].entries().expect("a tuple");
        assert_eq!(of_y[0].text(), Some("y"));
        assert_eq!(of_y[2], Literal::List(vec![Literal::Number(3)]));
        assert_eq!(Literal::parse(b"()"), Some(Literal::List(vec![])));
    }

    #[test]
    fn anything_else_is_refused() {
        let deep = [vec![b'('; 100_000], vec![b')'; 100_000]].concat();
        for text in [
            &b""[..],
            b"{",
            b"{'a'}",
            b"{'a': 1 'b': 2}",
            b"(1 2)",
            b"(1,",
            b"'a",
            b"-1",
            b"1 2",
            b"1.5",
            b"None",
            b"99999999999999999999999",
            b"'\\n'",
            b"{[]: 1}",
            b"\xff",
            &deep,
        ] {
            assert_eq!(Literal::parse(text), None, "{}", String::from_utf8_lossy(text));
        }
    }
}
