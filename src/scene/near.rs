//! The names that other programs, and the course, give the things of the format.

use std::sync::LazyLock;

use crate::{
    scene::format::{scene::Model, thing::Thing},
    text::nearest::nearest,
};

/// Each of those names, with the name of the format.
static OTHERS: LazyLock<Vec<[&str; 2]>> = LazyLock::new(|| {
    let mut found = Vec::new();
    for field in Model::of_type().all_fields() {
        found.extend(field.others.iter().map(|other| [*other, field.name]));
        for variant in (field.of_type)().innermost().variants() {
            found.extend(variant.others.iter().map(|other| [*other, variant.name]));
        }
    }
    found
});

/// Returns the name in `known` that is meant by the name of another program, or that is most similar.
pub(crate) fn near<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let mut others = OTHERS.iter().filter(|[other, _]| *other == name);
    let meant = others.find_map(|[_, meant]| known.iter().find(|name| *name == meant));
    meant.copied().or_else(|| nearest(name, known))
}

/// Returns true if the value of the name of another program is that of the name here.
pub(crate) fn is_same_value(name: &str) -> bool {
    ![
        "alpha",
        "angle",
        "decay",
        "energy",
        "half_angle",
        "power",
        "radii",
    ]
    .contains(&name)
}
