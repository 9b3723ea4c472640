//! Suggestions for misspelled names, and quoting in messages.

/// The number of letters from which the start of a name stands for it.
const SHORTEST_START: usize = 3;

/// Returns the name in `known` that is most similar to `name`, if it is similar enough: the only one
/// that begins so, or the one with the fewest typing errors.
pub(crate) fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let name = plain(name);
    if name.chars().count() >= SHORTEST_START {
        let mut longer = known.iter().filter(|known| plain(known).starts_with(&name));
        if let (Some(meant), None) = (longer.next(), longer.next()) {
            return Some(meant);
        }
    }
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

/// Normalizes a name: case, underscores and hyphens are ignored in comparisons.
fn plain(name: &str) -> String {
    let letters = name
        .chars()
        .take(64)
        .filter(|letter| !matches!(letter, '_' | '-'));
    letters.flat_map(char::to_lowercase).collect()
}

/// Maximum number of characters of source text quoted in a message.
const LONGEST: usize = 40;

/// Quotes a piece of source text in backticks, on one line; long text is truncated.
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

/// Lists names in backticks, separated by commas.
pub(crate) fn list(names: &[&str]) -> String {
    let quoted: Vec<_> = names.iter().map(|name| format!("`{name}`")).collect();
    quoted.join(", ")
}

/// The largest number of names that are all listed although it is known which one is meant.
const FEW: usize = 8;

/// Returns what is expected of a name: all known ones. If it is known which is meant, many are only
/// counted.
pub(crate) fn one_of(known: &[&str], is_meant_known: bool) -> String {
    if is_meant_known && known.len() > FEW {
        format!("one of {}", known.len())
    } else {
        format!("one of {}", list(known))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIELDS: &[&str] = &[
        "eye", "gaze", "look_at", "up", "fov", "center", "radius", "color",
    ];

    #[test]
    fn many_names_are_only_counted_if_one_is_meant() {
        let many: Vec<_> = FIELDS.iter().copied().chain(["name"]).collect();
        assert_eq!(one_of(&many, true), "one of 9");
        assert!(one_of(&many, false).ends_with("`color`, `name`"));
        assert!(one_of(FIELDS, true).ends_with("`radius`, `color`"));
    }

    #[test]
    fn typing_errors_find_the_intended_name() {
        for (typed, meant) in [
            ("centre", "center"),
            ("colour", "color"),
            ("raduis", "radius"),
            ("lookAt", "look_at"),
            ("Up", "up"),
            ("look", "look_at"),
        ] {
            assert_eq!(nearest(typed, FIELDS), Some(meant));
        }
        // Nearer to `to`, but it is the start of the other.
        assert_eq!(nearest("top", &["to", "top_radius"]), Some("top_radius"));
    }

    #[test]
    fn distant_names_are_not_suggested() {
        for typed in ["material", "x", "", "shininess"] {
            assert_eq!(nearest(typed, FIELDS), None, "{typed}");
        }
    }
}
