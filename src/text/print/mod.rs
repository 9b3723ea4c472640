//! The canonical format of scene files.
//!
//! A container is written on one line if it fits; otherwise each field or element gets its own
//! line. The root and lists of structs always break. Comments stay with their node, numbers, names
//! and strings keep their spelling, and several blank lines are reduced to one.

mod comments;
mod printer;

use std::iter::once;

use crate::text::{
    print::printer::Printer,
    syntax::{NodeKind, Tree},
};

/// Formats a tree without syntax faults in the canonical format.
///
/// Line endings follow the first line of `text`; those inside strings are part of the value and
/// don't change. A byte order mark is dropped, and so is anything that is not in the tree: `Some`
/// before a value.
pub(crate) fn format(text: &str, tree: &Tree) -> String {
    Printer::new(text, tree, line_end(text, tree)).print()
}

/// Returns the line ending of the first line that does not end inside a string.
fn line_end(text: &str, tree: &Tree) -> &'static str {
    let nodes = tree.ids().map(|id| tree.node(id));
    let strings = nodes.filter(|node| {
        matches!(
            node.kind(),
            NodeKind::String | NodeKind::Bytes | NodeKind::Char
        )
    });
    let mut start = 0;
    for string in strings
        .map(|node| node.range())
        .chain(once(text.len()..text.len()))
    {
        let between = text.get(start..string.start).unwrap_or("");
        if let Some((line, _)) = between.split_once('\n') {
            return if line.ends_with('\r') { "\r\n" } else { "\n" };
        }
        start = string.end;
    }
    "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::syntax::{Syntax, parse};

    fn formatted(text: &str, syntax: Syntax) -> String {
        let tree = parse(text, syntax);
        assert!(tree.faults().is_empty(), "{:?} in {text}", tree.faults());
        let once = format(text, &tree);
        let tree = parse(&once, syntax);
        assert!(tree.faults().is_empty(), "{:?} in {once}", tree.faults());
        assert_eq!(format(&once, &tree), once, "formatted twice");
        once
    }

    fn ron(text: &str) -> String {
        formatted(text, Syntax::Ron)
    }

    #[test]
    fn short_values_are_on_one_line() {
        let text = "(camera:Perspective(eye:(0,0 , 0),\n\nfov:90,), geometries : [Sphere(radius:1),\
                    Plane()\n],)";
        let expected = "\
(
    camera: Perspective(eye: (0, 0, 0), fov: 90),
    geometries: [
        Sphere(radius: 1),
        Plane(),
    ],
)
";
        assert_eq!(ron(text), expected);
    }

    #[test]
    fn long_values_are_broken_into_lines() {
        let long = "0.12345678901234567890123456789";
        let text = format!("(a: ({long}, {long}, {long}), b: [1, 2])");
        let expected = format!(
            "(\n    a: (\n        {long},\n        {long},\n        {long},\n    ),\n    b: [1, 2],\n)\n"
        );
        assert_eq!(ron(&text), expected);
    }

    #[test]
    fn comments_are_kept_in_place() {
        let text = "\
// head

/* two */ // three
#![enable(implicit_some)]
Scene( // open
  // above a


  // near a
  a: 1 /* before the comma */, // after a
  /* inline */ b: /* value */ 2, c /* colon */ : // line
   3, d: [ /* one */ 1, 2 /* two */ ],

  e: Sphere /* name */ (x: 1), // end
  f: [],
  // dangling
) // behind
// tail
";
        let expected = "\
// head

/* two */ // three
#![enable(implicit_some)]
Scene( // open
    // above a

    // near a
    a: 1, /* before the comma */ // after a
    /* inline */ b: /* value */ 2,
    c: /* colon */ // line
        3,
    d: [
        /* one */ 1,
        2, /* two */
    ],

    e: Sphere /* name */ (
        x: 1,
    ), // end
    f: [],
    // dangling
) // behind
// tail
";
        assert_eq!(ron(text), expected);
    }

    #[test]
    fn an_empty_container_keeps_its_comments() {
        assert_eq!(ron("(a: [ // none\n])"), "(\n    a: [ // none\n    ],\n)\n");
        assert_eq!(
            ron("(a: [ /* none */ ])"),
            "(\n    a: [ /* none */\n    ],\n)\n"
        );
        assert_eq!(ron("( // none\n)"), "( // none\n)\n");
    }

    #[test]
    fn json_has_no_trailing_commas() {
        let text = "{\"a\":[1,2 ],\"b\":[{\"c\":{\"d\":null}},{}],\"e\":{}}";
        let expected = "\
{
    \"a\": [1, 2],
    \"b\": [
        {\"c\": {\"d\": null}},
        {}
    ],
    \"e\": {}
}
";
        assert_eq!(formatted(text, Syntax::Json), expected);
    }

    #[test]
    fn line_ends_are_kept_and_a_byte_order_mark_is_not() {
        let text = "\u{feff}(\r\na: 1, // one  \r\n/* two\r\nlines */ b: 2)";
        let expected = "(\r\n    a: 1, // one\r\n    /* two\r\nlines */ b: 2,\r\n)\r\n";
        assert_eq!(ron(text), expected);
    }

    #[test]
    fn comments_in_rare_places_are_kept_once() {
        // Two line comments in front of a bracket are not merged into one.
        assert_eq!(
            ron("(a: Sphere // one\n // two\n (x: 1))"),
            "(\n    a: Sphere // one\n        // two\n    (\n        x: 1,\n    ),\n)\n"
        );
        let attribute = "#![enable(/* one */ implicit_some)]";
        assert_eq!(
            ron(&format!("{attribute} (a: /* two */ 1)")),
            format!("{attribute}\n(\n    a: /* two */ 1,\n)\n")
        );
        assert_eq!(
            ron("({ (1, /* one */2): 3, [4 ] :5 })"),
            "(\n    {\n        (\n            1,\n            /* one */ 2,\n        ): 3,\n        \
             [4]: 5,\n    },\n)\n"
        );
        // A comment in front of a comma belongs to the item that the comma ends.
        assert_eq!(
            ron("[1 /* one */, /* two */ 2]"),
            "[\n    1, /* one */\n    /* two */ 2,\n]\n"
        );
    }

    #[test]
    fn blank_lines_are_those_of_the_text() {
        // A line with only a comma is not blank, and a comment that ends like an opening bracket is
        // not one.
        let text = "[\n    1\n    ,\n    2,\n    // (\n\n    (\n    ),\n]";
        let expected = "[\n    1,\n    2,\n    // (\n\n    (),\n]\n";
        assert_eq!(ron(text), expected);
    }

    #[test]
    fn line_ends_in_strings_are_values() {
        let text = "(\n    a: \"one\r\ntwo\",\n)\n";
        assert_eq!(ron(text), text);
        let text = "(a: \"one\ntwo\",\r\n)";
        assert_eq!(ron(text), "(\r\n    a: \"one\ntwo\",\r\n)\r\n");
    }

    #[test]
    fn numbers_names_and_strings_are_kept() {
        let text =
            "(\n    a: 1_000.50,\n    r#b: r#\"x\"#,\n    c: 0x5A,\n    d: \"\\u{41}\",\n)\n";
        assert_eq!(ron(text), text);
    }
}
