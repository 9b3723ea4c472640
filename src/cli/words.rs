//! Values of options that shells complete.

use std::ffi::OsStr;

use clap::{
    Arg, Command, Error,
    builder::{PossibleValue, PossibleValuesParser, StringValueParser, TypedValueParser},
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

/// The parser of an option whose values are some things of the library, each shown as `value` says.
pub(super) fn one_of<T: Copy + Send + Sync>(
    all: &'static [T],
    value: fn(T) -> PossibleValue,
) -> impl TypedValueParser<Value = T> {
    let values = all.iter().map(move |one| value(*one));
    PossibleValuesParser::new(values).try_map(move |name| {
        let mut all = all.iter().copied();
        all.find(|one| value(*one).matches(&name, false))
            .ok_or("unknown")
    })
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
