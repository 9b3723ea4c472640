//! The name that somebody has probably meant, and how messages show names.

/// Names of other programs for what is called otherwise here.
const SYNONYMS: &[(&str, &str)] = &[
    ("alpha", "fov"),
    ("angle", "fov"),
    ("OrthographicCamera", "Orthographic"),
    ("PerspectiveCamera", "Perspective"),
    ("half_angle", "fov"),
    ("csv", "file"),
    ("direction", "gaze"),
    ("from", "eye"),
    ("objects", "geometries"),
    ("path", "file"),
    ("position", "eye"),
    ("position", "center"),
    ("position", "point"),
    ("r", "radius"),
    ("shapes", "geometries"),
    ("table", "file"),
    ("target", "look_at"),
    ("to", "look_at"),
];

/// The name among `known` that is nearest to `name`, if it is near.
pub(crate) fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let mut synonyms = SYNONYMS.iter().filter(|(other, _)| *other == name);
    if let Some(meant) = synonyms.find_map(|(_, meant)| known.iter().find(|name| *name == meant)) {
        return Some(meant);
    }
    let name = plain(name);
    let distances = known.iter().map(|known| {
        let other = plain(known);
        let longest = name.chars().count().max(other.chars().count());
        let distance = strsim::damerau_levenshtein(&name, &other);
        (distance, longest, *known)
    });
    distances
        .filter(|(distance, longest, _)| *distance <= (longest / 3).max(1) && distance < longest)
        .min_by_key(|(distance, _, _)| *distance)
        .map(|(_, _, known)| known)
}

/// Whether the nearest name means the same value, or only what that value is made of.
pub(crate) fn is_misspelt(name: &str) -> bool {
    !SYNONYMS.iter().any(|(other, _)| *other == name)
}

/// Upper case, underscores and hyphens are no difference worth counting.
fn plain(name: &str) -> String {
    let letters = name
        .chars()
        .take(64)
        .filter(|letter| !matches!(letter, '_' | '-'));
    letters.flat_map(char::to_lowercase).collect()
}

/// The most characters of the text that a message repeats.
const LONGEST: usize = 40;

/// A piece of the text in backticks, on one line and cut where it is long.
pub(crate) fn quote(text: &str) -> String {
    let mut shown = String::new();
    for (index, character) in text.chars().enumerate() {
        if index == LONGEST {
            shown.push('…');
            break;
        }
        if character.is_control() {
            shown.extend(character.escape_default());
        } else {
            shown.push(character);
        }
    }
    format!("`{shown}`")
}

/// Names in backticks, with commas.
pub(crate) fn list(names: &[&str]) -> String {
    let quoted: Vec<_> = names.iter().map(|name| format!("`{name}`")).collect();
    quoted.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIELDS: &[&str] = &[
        "eye", "gaze", "look_at", "up", "fov", "center", "radius", "color",
    ];

    #[test]
    fn typing_errors_find_their_name() {
        for (typed, meant) in [
            ("centre", "center"),
            ("colour", "color"),
            ("raduis", "radius"),
            ("lookAt", "look_at"),
            ("Up", "up"),
            ("angle", "fov"),
        ] {
            assert_eq!(nearest(typed, FIELDS), Some(meant));
        }
    }

    #[test]
    fn what_is_not_near_is_not_guessed() {
        for typed in ["material", "x", "", "shininess"] {
            assert_eq!(nearest(typed, FIELDS), None, "{typed}");
        }
    }
}
