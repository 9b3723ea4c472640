//! The names that other programs, and the course, give the things of the format.

use std::sync::LazyLock;

use crate::{
    scene::format::{scene::Model, thing::Thing},
    text::nearest::nearest,
};

/// Each of those names, with the name of the format; true if the value is the same.
static OTHERS: LazyLock<Vec<(&str, &str, bool)>> = LazyLock::new(|| {
    let mut found = Vec::new();
    for field in Model::of_type().all_fields() {
        found.extend(field.others.iter().map(|other| (*other, field.name, true)));
        found.extend(field.unlike.iter().map(|other| (*other, field.name, false)));
        for variant in (field.of_type)().innermost().variants() {
            found.extend(
                variant
                    .others
                    .iter()
                    .map(|other| (*other, variant.name, true)),
            );
        }
    }
    found
});

/// Returns the name in `known` that is meant by the name of another program, or that is most similar.
pub(crate) fn near<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let mut others = OTHERS.iter().filter(|(other, ..)| *other == name);
    let meant = others.find_map(|(_, meant, _)| known.iter().find(|name| *name == meant));
    meant.copied().or_else(|| nearest(name, known))
}

/// Returns true if the value of the name of another program is that of the name here.
pub(crate) fn is_same_value(name: &str) -> bool {
    let mut others = OTHERS.iter().filter(|(other, ..)| *other == name);
    others.all(|(.., is_same)| *is_same)
}
