//! Options with named values.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// Returns the parser of an option that takes one of `all`, each under the name given by `value`.
pub(super) fn one_of<T: Copy + Send + Sync + 'static>(
    all: impl IntoIterator<Item = T>,
    value: fn(T) -> PossibleValue,
) -> impl TypedValueParser<Value = T> {
    let all: Vec<T> = all.into_iter().collect();
    let values: Vec<_> = all.iter().map(|one| value(*one)).collect();
    PossibleValuesParser::new(values).try_map(move |name| {
        let mut all = all.iter().copied();
        all.find(|one| value(*one).matches(&name, true))
            .ok_or("unknown")
    })
}
