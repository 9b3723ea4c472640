//! Handwritten faulty texts: the exact position and message of every fault.
use super::common::check as check_tree;
use crate::text::syntax::{CommentKind, NodeKind, Syntax, parse};

/// A text, and the start and message of each of its faults.
type Case = (&'static str, &'static [(usize, &'static str)]);

const RON: &[Case] = &[
    ("(a: 1 b: 2)", &[(6, "expected `,` or `)`, found `b`")]),
    ("(a: (1 2, 3))", &[(7, "expected `,` or `)`, found `2`")]),
    ("(a: [1 2])", &[(7, "expected `,` or `]`, found `2`")]),
    (
        r#"(a: 1, b: "x" c: 2)"#,
        &[(14, "expected `,` or `)`, found `c`")],
    ),
    (
        "(g: [A(x: 1) A(x: 2)])",
        &[(13, "expected `,` or `]`, found `A`")],
    ),
    ("(a 1, b: 2)", &[(3, "expected `:` after `a`, found `1`")]),
    (
        "(a: 1, image (width: 1))",
        &[(13, "expected `:` after `image`, found `(`")],
    ),
    ("(a = 1)", &[(3, "expected `:`, found `=`")]),
    ("(a: 1; b: 2)", &[(5, "expected `,` or `)`, found `;`")]),
    (
        "(a: 1, b: )",
        &[(10, "expected a value for `b`, found `)`")],
    ),
    ("(a: , b: 1)", &[(4, "expected a value for `a`, found `,`")]),
    (
        "(a:
 b: 1)",
        &[(5, "expected a value for `a`, found `b`")],
    ),
    ("(a: 1, b)", &[(8, "expected `:` after `b`, found `)`")]),
    ("(a: 1,, b: 2)", &[(6, "expected a value, found `,`")]),
    ("(,)", &[(1, "expected a value, found `,`")]),
    ("(a:: 1)", &[(3, "expected a value, found `:`")]),
    ("(a: 1: 2)", &[(5, "expected `,` or `)`, found `:`")]),
    ("(: 1)", &[(1, "expected a field name, found `:`")]),
    ("(a: 1, 2, 3)", &[(7, "expected a field name, found `2`")]),
    ("(a: (1, 2, 3, b: 2)", &[(14, "expected `)`, found `b`")]),
    (
        "(a: (1, 2, 3",
        &[(12, "expected `)`, found the end of the file")],
    ),
    (
        "(a: [(1, 2",
        &[(10, "expected `)`, found the end of the file")],
    ),
    ("(a: (0, 0, 0], b: 1)", &[(12, "expected `)`, found `]`")]),
    (
        "(g: [A(x: (0, 0, 0)], b: 1)",
        &[(19, "expected `)`, found `]`")],
    ),
    ("(g: [A(x: 1], b: 1)", &[(11, "expected `)`, found `]`")]),
    (
        "(g: [A(x: (0, 0, 0)), y: 1), A(x: 2)])",
        &[(19, "unexpected `)`")],
    ),
    ("(a: 1))", &[(6, "unexpected `)`")]),
    ("(a: 1), b: 2)", &[(5, "unexpected `)`")]),
    (
        "(a: 1) (b: 2)",
        &[(7, "expected the end of the file, found `(`")],
    ),
    ("(a: 1}", &[(5, "expected `)`, found `}`")]),
    (
        "(
    camera: P(
        eye: (0, 0, 0),
        fov: 90,
    background: (0, 0, 0),
    list: [],
)",
        &[(15, "`(` is not closed")],
    ),
    (
        "(
    camera: P(
        eye: (0, 0, 0),
        fov: 90
    background: (0, 0, 0),
)",
        &[(15, "`(` is not closed")],
    ),
    (
        "(
    list: [
        A(x: 1, y: (1, 1, 1),
        A(x: 1, y: (1, 1, 1)),
    ],
)",
        &[(23, "`(` is not closed")],
    ),
    (
        "(
    list: [
        A(x: 1, y: (1, 1, 1)),
        A(x: 1, y: (1, 1, 1)
    ],
    version: 1,
)",
        &[(54, "`(` is not closed")],
    ),
    (
        "(
    list: [
        A(x: 1),
    version: 1,
)",
        &[(12, "`[` is not closed")],
    ),
    (
        "(
    list: [
        A(x: 1),
    ),
    version: 1,
)",
        &[(35, "expected `]`, found `)`")],
    ),
    (
        "(
    list:
        A(x: 1),
        A(x: 2),
    ],
    version: 1,
)",
        &[(37, "expected a field name, found `A`")],
    ),
    (
        "(
    list: [
        A(x: 1)),
        A(x: 2),
    ],
)",
        &[(29, "unexpected `)`")],
    ),
    (
        "(
    camera: P(
        eye: 0, 0, 0),
        fov: 90,
    ),
)",
        &[(33, "expected a field name, found `0`")],
    ),
    (
        "(g: [A(x: 0, 0, 0), y: 1), A(x: 2)])",
        &[(13, "expected a field name, found `0`")],
    ),
    (
        "(g: [A x: 1, y: 2), A(x: 2)])",
        &[(7, "expected `(`, found `x`")],
    ),
    (
        "(g: [A{x: 1}, A[x: 2]])",
        &[
            (6, "expected `(`, found `{`"),
            (15, "expected `(`, found `[`"),
        ],
    ),
    (
        "(g: [A(x (0, 0), y: 1), A(x: 2)])",
        &[(7, "expected `:` after `x`")],
    ),
    (
        "a: 1,
b: 2,",
        &[(0, "expected `(`, found `a`")],
    ),
    (r#"(a: "x"#, &[(4, "unterminated string")]),
    (
        r#"(a: "x,
 b: 1)"#,
        &[(4, "unterminated string")],
    ),
    (
        r##"(g: [A(c: "#ff0000), A(c: "#00ff00")])"##,
        &[(10, "unterminated string")],
    ),
    ("(c: #ff0000, b: 1)", &[(4, "unexpected `#ff0000`")]),
    (
        r#"(c: ff0000", b: 1)"#,
        &[(4, r##"expected `"`, found `ff0000"`"##)],
    ),
    (
        r#"(c: "ff""ff")"#,
        &[(8, r##"expected `,` or `)`, found `"ff"`"##)],
    ),
    (
        "(a: 'abc', b: 'def')",
        &[(4, "expected one character in single quotes, found `'abc'`")],
    ),
    (
        r#"(a: "\q", b: "\u{110000}")"#,
        &[(5, "invalid escape `\\q`"), (14, "invalid escape `\\u`")],
    ),
    (r#"(a: r#"x, b: 1)"#, &[(4, "unterminated string")]),
    ("(a: /* x", &[(4, "unclosed block comment")]),
    ("(a: 1 / 2)", &[(4, "expected a number, found `1 / 2`")]),
    (
        "(a: 1.2.3, b: --1, c: 1..2, d: 0x, e: 5i128, f: _1)",
        &[
            (4, "unreadable number `1.2.3`"),
            (14, "unreadable number `--1`"),
            (22, "unreadable number `1..2`"),
            (31, "unreadable number `0x`"),
            (38, "unreadable number `5i128`"),
        ],
    ),
    (
        "(a: 1， b： “x”， c: −5)",
        &[
            (5, "unexpected character `，`"),
            (10, "unexpected character `：`"),
            (14, "unexpected character `“`"),
            (21, "unexpected character `，`"),
            (28, "unexpected character `−`"),
        ],
    ),
    (
        "(a: …, b: ...)",
        &[(4, "unexpected `…`"), (12, "unreadable number `...`")],
    ),
    (
        "(@a: 1, b: @, c: 5@)",
        &[
            (1, "unexpected `@`"),
            (11, "unexpected `@`"),
            (18, "unexpected `@`"),
        ],
    ),
    (
        "(a:\u{a0}1,\u{a0}b:\u{3000}2)",
        &[(
            3,
            "unexpected character U+00A0, which only looks like white space",
        )],
    ),
    (
        "(a: 1, \u{1} b: (",
        &[(7, "unexpected control character U+0001")],
    ),
    (
        r#"("a": 1, "b": 2)"#,
        &[(1, r##"expected a field name, found `"a"`"##)],
    ),
    ("(a-b: 1)", &[(1, "expected a name, found `a-b`")]),
    ("[a: 1]", &[(0, "expected `(`, found `[`")]),
    ("", &[(0, "expected a scene, found an empty file")]),
    (
        " // only a comment",
        &[(0, "expected a scene, found an empty file")],
    ),
    (
        "hello world",
        &[(6, "expected the end of the file, found `world`")],
    ),
    (")", &[(0, "expected a scene, found `)`")]),
    (
        "#![enable(foo)] (a: 1)",
        &[(10, "expected the name of an extension, found `foo`")],
    ),
    (
        "#![enable(implicit_some] (a: 1)",
        &[(23, "expected `)`, found `]`")],
    ),
    ("#[x] (a: 1)", &[(1, "expected `!`, found `[`")]),
    (
        "(a: 1, #![enable(implicit_some)] b: 2)",
        &[(7, "unexpected `#![enable(implicit_some)]`")],
    ),
    (r#"{"a" 1, b: 2 c: 3}"#, &[(5, "expected `:`, found `1`")]),
];

const JSON: &[Case] = &[
    (
        r#"{"a": 1 "b": 2}"#,
        &[(8, r##"expected `,` or `}`, found `"b"`"##)],
    ),
    (
        r#"{"a": 1
 "b": 2
 "c": 3}"#,
        &[
            (9, r##"expected `,` or `}`, found `"b"`"##),
            (17, r##"expected `,` or `}`, found `"c"`"##),
        ],
    ),
    (
        "[1 2 3]",
        &[
            (3, "expected `,` or `]`, found `2`"),
            (5, "expected `,` or `]`, found `3`"),
        ],
    ),
    (
        r#"{"a" 1}"#,
        &[(5, r##"expected `:` after `"a"`, found `1`"##)],
    ),
    (
        r#"{"a", "b", "c"}"#,
        &[(4, r##"expected `:` after `"a"`, found `,`"##)],
    ),
    (r#"{"a" = 1}"#, &[(5, "expected `:`, found `=`")]),
    (
        r#"{"a": 1; "b": 2}"#,
        &[(7, "expected `,` or `}`, found `;`")],
    ),
    (
        r#"{"a": , "b": 1}"#,
        &[(6, r##"expected a value for `"a"`, found `,`"##)],
    ),
    (
        r#"{"a": }"#,
        &[(6, r##"expected a value for `"a"`, found `}`"##)],
    ),
    (r#"{"a": 1: 2}"#, &[(7, "expected `,` or `}`, found `:`")]),
    ("{1: 2}", &[(1, "expected a string as key, found `1`")]),
    ("{: 2}", &[(1, "expected a key, found `:`")]),
    (
        r#"{"a": 1,}"#,
        &[(7, "expected a value after `,`, found `}`")],
    ),
    ("[1, 2,]", &[(5, "expected a value after `,`, found `]`")]),
    ("[1,,2]", &[(3, "expected a value, found `,`")]),
    ("[,1]", &[(1, "expected a value, found `,`")]),
    (
        r#"{"a": [1, 2, 3, "b": 2}"#,
        &[(16, r##"expected `]`, found `"b"`"##)],
    ),
    (r#"{"a": [1, 2, 3}"#, &[(14, "expected `]`, found `}`")]),
    (
        r#"{"a": {"b": [1, 2}, "c": 3}"#,
        &[(17, "expected `]`, found `}`")],
    ),
    (r#"[{"a": 1}, {"b": 2]"#, &[(18, "expected `}`, found `]`")]),
    (
        r#"{"a": (1, 2], "b": 1}"#,
        &[(6, "expected a JSON value, found `(`")],
    ),
    (
        r#"{"a": [1, 2), "b": 1}"#,
        &[(11, "expected `]`, found `)`")],
    ),
    (r#"{"a": 1}}"#, &[(8, "unexpected `}`")]),
    (r#"{"a": 1}, "b": 2}"#, &[(7, "unexpected `}`")]),
    (
        r#"{"a": 1} {"b": 2}"#,
        &[(9, "expected the end of the file, found `{`")],
    ),
    (
        r#"{"a": 1"#,
        &[(7, "expected `}`, found the end of the file")],
    ),
    (
        r#"[[{"a": 1"#,
        &[(9, "expected `}`, found the end of the file")],
    ),
    (
        r#"{
  "camera": {
    "P": {
      "fov": 90
  },
  "list": []
}"#,
        &[(45, "expected two `}`, found one")],
    ),
    (
        r#"{
  "camera": {"x": 1,
  "list": []
}"#,
        &[(14, "`{` is not closed")],
    ),
    (
        r#"{
  "list": [
    {"A": {"x": 1},
    {"A": {"x": 1}}
  ],
  "b": 1
}"#,
        &[(18, "`{` is not closed")],
    ),
    (
        r#"{
  "list": [
    {"A": {"x": 1}},
    {"A": {"x": 1}
  ],
  "b": 1
}"#,
        &[(39, "`{` is not closed")],
    ),
    (
        r#"{
  "list": [
    {"A": {"x": [0, 0, 0, "y": 1}},
    {"A": {"x": 1}}
  ]
}"#,
        &[(40, r##"expected `]`, found `"y"`"##)],
    ),
    (
        r#"{"list": [{"A": {"x": 0, 0, 0], "y": 1}}]}"#,
        &[(25, "expected a key, found `0`")],
    ),
    (
        r#"{"list": [{"A": "x": 0, "y": 1}}]}"#,
        &[(16, r##"expected `{`, found `"x"`"##)],
    ),
    (
        r#"{"list": ["A": {"x": 0, "y": 1}}, {"A": {"x": 1}}]}"#,
        &[(10, r##"expected `{`, found `"A"`"##)],
    ),
    (
        r#"{"list": [{{"A": {"x": 0, "y": 1}}]}"#,
        &[(11, "unexpected `{`")],
    ),
    (r#"["a": 1, "b": 2}"#, &[(0, "expected `{`, found `[`")]),
    (
        r#""a": 1, "b": 2"#,
        &[(0, r##"expected `{`, found `"a"`"##)],
    ),
    (r#"{"a": "x"#, &[(6, "unterminated string")]),
    (
        r#"{"a": "x,
 "b": 1}"#,
        &[(6, "unterminated string")],
    ),
    (r#"{"a: [1], "b": "x"}"#, &[(1, "unterminated string")]),
    (
        r#"{a": [1], "b": "x"}"#,
        &[(1, r##"expected `"`, found `a"`"##)],
    ),
    (
        r#"{""a": 1, "b": "x""}"#,
        &[(1, r##"unexpected `"`"##), (18, r##"unexpected `"`"##)],
    ),
    (
        "{'a': 'b', 'c': 1}",
        &[(1, "expected a double quote, found `'a'`")],
    ),
    (
        r#"{'a": 1, "b": "x'}"#,
        &[
            (1, r#"expected a double quote, found `'a"`"#),
            (14, "unterminated string"),
        ],
    ),
    (
        "{\"a\": \"tab\tx\"}",
        &[(10, "control character U+0009 in a string")],
    ),
    (
        r#"{"a": "\q", "b": "\ud800", "c": "\u12"}"#,
        &[
            (7, "invalid escape `\\q`"),
            (18, "invalid escape `\\u`"),
            (33, "invalid escape `\\u`"),
        ],
    ),
    (
        "{a: 1, b: 2}",
        &[(1, "expected a string as key, found `a`")],
    ),
    (
        r#"// x
{"a": 1 /* y */}"#,
        &[(0, "unexpected comment `//`")],
    ),
    (r#"{"a": 1 /* y"#, &[(8, "unexpected comment `/*`")]),
    (
        "[01, 1., .5, +1, -, 1e, 0x1, 1_0, 1.5.5]",
        &[
            (1, "unreadable number `01`"),
            (5, "unreadable number `1.`"),
            (9, "unreadable number `.5`"),
            (13, "unreadable number `+1`"),
            (17, "unreadable number `-`"),
            (20, "unreadable number `1e`"),
            (24, "unreadable number `0x1`"),
            (29, "unreadable number `1_0`"),
            (34, "unreadable number `1.5.5`"),
        ],
    ),
    (
        "[NaN, Infinity, True, none, foo]",
        &[
            (1, "expected a value, found `NaN`"),
            (6, "expected a value, found `Infinity`"),
            (16, "expected a value, found `True`"),
            (22, "expected a value, found `none`"),
            (28, "expected a value, found `foo`"),
        ],
    ),
    (
        r#"{"a": 1，"b"：“x”}"#,
        &[
            (7, "unexpected character `，`"),
            (13, "unexpected character `：`"),
            (16, "unexpected character `“`"),
        ],
    ),
    (
        "{\"a\":\u{a0}1, \"b\": 2}",
        &[(
            5,
            "unexpected character U+00A0, which only looks like white space",
        )],
    ),
    (
        "{\"a\": 1, \0 \"b\": (",
        &[(9, "unexpected control character U+0000")],
    ),
    (r#"{"a": 1, ...}"#, &[(9, "unreadable number `...`")]),
    (
        "(camera: P(eye: (0, 0, 0), fov: 90.), list: [A(x: 1)],)",
        &[(0, "expected a JSON value, found `(`")],
    ),
    (
        "// a scene
Scene(camera: P(fov: .5))",
        &[(11, "expected a JSON value, found `Scene`")],
    ),
    (
        r#"{"a": (1, 2), "b": 1.}"#,
        &[(6, "expected a JSON value, found `(`")],
    ),
    ("", &[(0, "expected a scene, found an empty file")]),
    ("abc", &[(0, "expected a value, found `abc`")]),
    ("}", &[(0, "expected a scene, found `}`")]),
    (r#"{"a": 1 @ "b": 2}"#, &[(8, "unexpected `@`")]),
];

fn check(cases: &[Case], syntax: Syntax) {
    for (text, expected) in cases {
        let tree = parse(text, syntax);
        super::common::check(text, &tree);
        let found: Vec<_> = tree
            .faults()
            .iter()
            .map(|f| (f.range.start, f.message.as_str()))
            .collect();
        assert_eq!(found, *expected, "in {text:?}");
        assert!(
            tree.faults().iter().all(|f| f.help.is_some()),
            "no help for {text:?}"
        );
    }
}

#[test]
fn ron() {
    assert!(RON.len() >= 40);
    check(RON, Syntax::Ron);
}

#[test]
fn json() {
    assert!(JSON.len() >= 40);
    check(JSON, Syntax::Json);
}

#[test]
fn labels_and_help() {
    let tree = parse("(a: [1, 2\n", Syntax::Ron);
    let fault = &tree.faults()[0];
    assert_eq!(fault.range, 9..9);
    assert_eq!(fault.help.as_deref(), Some("add `])`"));
    assert_eq!(fault.label, Some((4..5, "opened here".to_owned())));
    let tree = parse("(\"center\": 1)", Syntax::Ron);
    assert_eq!(
        tree.faults()[0].help.as_deref(),
        Some("RON writes `center:` without quotes")
    );
    let tree = parse("{\"a\": 1} // x", Syntax::Json);
    assert_eq!(
        tree.faults()[0].help.as_deref(),
        Some("JSON does not support comments")
    );
    let tree = parse("(x: 1)", Syntax::Json);
    assert!(
        tree.faults()[0]
            .help
            .as_deref()
            .unwrap()
            .starts_with("this looks like RON")
    );
}

#[test]
fn a_tree_of_ron() {
    let text = "\u{feff}#![enable(implicit_some)] #![type = \"S\"] // head\nScene (a: Foo(1, 0x2), /* k */ r#b: [None, true, Bar,], c: (), d: {\"k\": 'x'},) // end";
    let tree = parse(text, Syntax::Ron);
    super::common::check(text, &tree);
    assert!(tree.faults().is_empty(), "{:?}", tree.faults());
    let attributes: Vec<_> = tree
        .attributes()
        .iter()
        .map(|range| &text[range.clone()])
        .collect();
    assert_eq!(
        attributes,
        ["#![enable(implicit_some)]", "#![type = \"S\"]"]
    );
    let root = tree.root().unwrap();
    assert_eq!(tree.node(root).kind(), NodeKind::Struct);
    assert_eq!(tree.node(root).name().map(|r| &text[r]), Some("Scene"));
    let fields: Vec<_> = tree
        .fields(root)
        .map(|(key, value)| {
            (
                crate::text::syntax::name(&text[tree.node(key).range()]),
                tree.node(value).kind(),
                &text[tree.node(value).range()],
            )
        })
        .collect();
    assert_eq!(
        fields,
        [
            ("a", NodeKind::Tuple, "Foo(1, 0x2)"),
            ("b", NodeKind::List, "[None, true, Bar,]"),
            ("c", NodeKind::Unit, "()"),
            ("d", NodeKind::Map, "{\"k\": 'x'}"),
        ]
    );
    let list = tree.fields(root).nth(1).unwrap().1;
    let items: Vec<_> = tree.children(list).map(|id| tree.node(id).kind()).collect();
    assert_eq!(
        items,
        [NodeKind::Null, NodeKind::Bool(true), NodeKind::Name]
    );
    let comments: Vec<_> = tree
        .comments()
        .iter()
        .map(|c| (&text[c.range()], c.kind))
        .collect();
    assert_eq!(
        comments,
        [
            ("// head", CommentKind::Line),
            ("/* k */", CommentKind::Block),
            ("// end", CommentKind::Line)
        ]
    );
    assert_eq!(tree.comments_in(tree.node(root).range()).len(), 1);
}

#[test]
fn comments_everywhere() {
    let text = "// 1\r\n/* 2 */ ( // 3\n a /* 4 */ : /* 5 */ 1 /* 6 */ , // 7\n /* 8\n */ b: 2 // 9\n) // 10";
    let tree = parse(text, Syntax::Ron);
    super::common::check(text, &tree);
    assert!(tree.faults().is_empty());
    let found: Vec<_> = tree.comments().iter().map(|c| &text[c.range()]).collect();
    let expected = [
        "// 1",
        "/* 2 */",
        "// 3",
        "/* 4 */",
        "/* 5 */",
        "/* 6 */",
        "// 7",
        "/* 8\n */",
        "// 9",
        "// 10",
    ];
    assert_eq!(found, expected);
}

#[test]
fn holes() {
    let text = "(a: , b: @)";
    let tree = parse(text, Syntax::Ron);
    let root = tree.root().unwrap();
    let values: Vec<_> = tree
        .fields(root)
        .map(|(_, v)| (tree.node(v).kind(), tree.node(v).range()))
        .collect();
    assert_eq!(values, [(NodeKind::Error, 3..3), (NodeKind::Error, 9..10)]);
}

#[test]
fn nothing_readable_is_spoiled_by_what_follows_it() {
    // The bracket that closed too early is opened again.
    let text = r#"[1, {}90f64, "a": {"b": [[]]}}]"#;
    check_tree(text, &parse(text, Syntax::Json));
    let text = "(a: {}@, b: 1@, c: 2)";
    let tree = parse(text, Syntax::Ron);
    check_tree(text, &tree);
    let values = tree.fields(tree.root().unwrap());
    let kinds: Vec<_> = values.map(|(_, v)| tree.node(v).kind()).collect();
    assert_eq!(kinds, [NodeKind::Map, NodeKind::Error, NodeKind::Number]);
}
