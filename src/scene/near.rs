//! The names that other programs, and the course, give the things of the format.

use std::sync::LazyLock;

use crate::{
    scene::format::{field::Field, scene::Model, thing::Type},
    text::nearest::nearest,
};

/// Each of those names, with the name of the format.
static OTHERS: LazyLock<Vec<[&str; 2]>> = LazyLock::new(|| {
    let mut found = Vec::new();
    add(Model::FIELDS, &mut found, &mut Vec::new());
    found
});

/// Adds those of fields, and of what is in them.
fn add(
    fields: &'static [Field],
    found: &mut Vec<[&'static str; 2]>,
    seen: &mut Vec<&'static [Field]>,
) {
    if seen.iter().any(|other| std::ptr::eq(*other, fields)) {
        return;
    }
    seen.push(fields);
    for field in fields {
        found.extend(field.others.iter().map(|other| [*other, field.name]));
        match (field.of_type)().innermost() {
            Type::Object(object, _) => add(object.fields, found, seen),
            Type::OneOf(one_of) => {
                for variant in one_of.variants {
                    found.extend(variant.others.iter().map(|other| [*other, variant.name]));
                    add(variant.fields(), found, seen);
                }
            }
            _ => {}
        }
    }
}

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
