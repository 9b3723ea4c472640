//! Python literals, limited to those in `NumPy` array headers.

/// A value in the header.
#[derive(Debug, PartialEq)]
pub(crate) enum Value {
    Text(String),
    Flag(bool),
    Shape(Vec<usize>),
    /// Any other tuple.
    Tuple(Vec<Self>),
    List(Vec<Self>),
}

/// The number of brackets in brackets that are parsed.
const DEEPEST: usize = 16;

/// A parser for the Python literals in array headers.
pub(crate) struct Literal<'a> {
    rest: &'a str,
    /// The number of open brackets.
    depth: usize,
}

impl<'a> Literal<'a> {
    pub(crate) const fn new(text: &'a str) -> Self {
        Self {
            rest: text,
            depth: 0,
        }
    }

    pub(crate) fn is_at_end(&self) -> bool {
        self.rest.trim_ascii().is_empty()
    }

    /// Consumes `piece` and the white space before it; returns false if it does not come next.
    fn take(&mut self, piece: &str) -> bool {
        let rest = self.rest.trim_ascii_start().strip_prefix(piece);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    pub(crate) fn dictionary(&mut self) -> Option<Vec<(String, Value)>> {
        let mut entries = Vec::new();
        if !self.take("{") {
            return None;
        }
        while !self.take("}") {
            let key = self.text()?;
            if !self.take(":") || entries.iter().any(|(other, _)| *other == key) {
                return None;
            }
            entries.push((key, self.value()?));
            if !self.take(",") {
                return self.take("}").then_some(entries);
            }
        }
        Some(entries)
    }

    fn value(&mut self) -> Option<Value> {
        if self.take("True") {
            return Some(Value::Flag(true));
        }
        if self.take("False") {
            return Some(Value::Flag(false));
        }
        if self.take("(") {
            let rest = self.rest;
            if let Some(shape) = self.shape() {
                return Some(Value::Shape(shape));
            }
            self.rest = rest;
            return self.values(")").map(Value::Tuple);
        }
        if self.take("[") {
            return self.values("]").map(Value::List);
        }
        self.text().map(Value::Text)
    }

    /// Parses a quoted string; names and types contain no escapes.
    fn text(&mut self) -> Option<String> {
        let rest = self.rest.trim_ascii_start();
        let quote = rest
            .chars()
            .next()
            .filter(|quote| matches!(quote, '\'' | '"'))?;
        let (text, rest) = rest.get(1..)?.split_once(quote)?;
        self.rest = rest;
        Some(text.to_owned())
    }

    /// Parses the rest of a tuple of integers.
    fn shape(&mut self) -> Option<Vec<usize>> {
        let mut shape = Vec::new();
        while !self.take(")") {
            shape.push(self.digits()?.parse().ok()?);
            // Python 2 wrote long integers with an `L` suffix.
            self.take("L");
            if !self.take(",") {
                return self.take(")").then_some(shape);
            }
        }
        Some(shape)
    }

    fn digits(&mut self) -> Option<&'a str> {
        let rest = self.rest.trim_ascii_start();
        let end = rest
            .find(|c: char| !c.is_ascii_digit())
            .unwrap_or(rest.len());
        let (digits, rest) = rest.split_at_checked(end)?;
        self.rest = rest;
        Some(digits)
    }

    /// Parses the rest of a tuple or a list.
    fn values(&mut self, end: &str) -> Option<Vec<Value>> {
        let mut values = Vec::new();
        self.depth += 1;
        while self.depth <= DEEPEST && !self.take(end) {
            values.push(self.value()?);
            if !self.take(",") && !self.rest.trim_ascii_start().starts_with(end) {
                return None;
            }
        }
        self.depth -= 1;
        (self.depth < DEEPEST).then_some(values)
    }
}
