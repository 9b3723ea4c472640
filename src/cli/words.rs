//! Values of options that shells complete.

use std::ffi::OsStr;

use clap::{
    Arg, Command, Error,
    builder::{PossibleValue, StringValueParser, TypedValueParser},
};

/// The parser of an option whose values have names.
#[derive(Clone)]
pub(super) struct Words<T> {
    parse: fn(&str) -> Result<T, String>,
    all: fn() -> Vec<PossibleValue>,
}

impl<T> Words<T> {
    /// A parser, and the names that a shell offers.
    pub(super) const fn new(
        parse: fn(&str) -> Result<T, String>,
        all: fn() -> Vec<PossibleValue>,
    ) -> Self {
        Self { parse, all }
    }
}

impl<T: Clone + Send + Sync + 'static> TypedValueParser for Words<T> {
    type Value = T;

    fn parse_ref(&self, command: &Command, arg: Option<&Arg>, value: &OsStr) -> Result<T, Error> {
        let parse = self.parse;
        let parser = StringValueParser::new().try_map(move |text| parse(&text));
        parser.parse_ref(command, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new((self.all)().into_iter()))
    }
}
