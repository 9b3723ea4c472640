//! Shared test data: scenes, and the invariants of every tree.

use crate::text::syntax::{NodeKind, Tree};

pub(crate) const RON: &[&str] = &[
    r##"(
    version: 1,                                  // optional
    image: (width: 640, height: 480),
    camera: Perspective(
        eye: (0, 0, 0),
        gaze: (0, 0, -1),
        up: (0, 1, 0),
        fov: 90,
    ),
    cameras: {"é 2": Orthographic(eye: (0, 9, 0), gaze: (0, -1, 0), up: (0, 0, 1), scale: 2)},
    background: (0, 0, 0),
    geometries: [
        Plane(point: (0, -1, 0), normal: (0, 1, 0), color: (0, 1, 0)),
        Sphere(center: (-1, 0, -3), radius: 0.5, color: "#ff0000", name: "a ball"),
    ],
    animation: (fps: 24, frames: 48, tracks: {
        "camera.fov": [(0, 60), (2.5, 30, Smooth)],
        "background": [(0, "#000"), (1, (1, 0.5, 0), Step)],
    }),
)
"##,
    r##"#![enable(implicit_some)]
/* head /* nested */ */
Scene(
    image: Image(width: Some(1_000), height: 0x1E0u32), version: 1,
    camera: Orthographic(eye: (1.5e0, .5, 1.), look_at: Some(0, +5, -0.0f64),
        scale: 3_0.0, stretch: Some(true)),
    background: Some([1, 0.5, inf]), // [] works
    allow: ["eye-inside", r#"eye-"on"-plane"#, "a\
        b\u{e9}\x41"],
    geometries: [ Sphere(center: (1, 2, 3), r#radius: 1, color: Foo(0, 0, 0)), ],
)"##,
    "(camera:Perspective(eye:(0,0,0),look_at:(0,0,-1),fov:60),geometries:[Sphere(center:(0,0,-5),radius:1,color:\"#abc\"),Sphere(center:(0,1,-5),radius:2,color:(1,1,1))])",
    "(\n  geometries: [],\n  camera: Orthographic (\n    eye: (0, 0, 0), gaze: None, look_at: (1, 1, 1),\n    scale: NaN,\n  ),\n  background: \"multi\n line\",\n)",
    "(\n\tgeometries: [\n\t\tPlane(\n\t\t\tpoint: (0, 0, 0),\n\t\t\tnormal: (0, 1, 0),\n\t\t\tcolor: \"#fff\",\n\t\t),\n\t\tSphere(\n\t\t\tcenter: (0, 0, 0),\n\t\t\tradius: 1,\n\t\t\tcolor: \"#fff\",\n\t\t),\n\t],\n\tcamera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 60),\n)\n",
];

pub(crate) const JSON: &[&str] = &[
    r##"{
  "$schema": "https://example.org/scene.json",
  "version": 1,
  "image": {"width": 640, "height": 480},
  "camera": {
    "Perspective": {
      "eye": [0, 0, 0],
      "gaze": [0, 0, -1],
      "fov": 90
    }
  },
  "cameras": {"a": {"Perspective": {"eye": [0, 0, 0], "gaze": [0, 0, -1], "fov": 90}}, "\u0061b": {"Orthographic": {"eye": [0, 0, 0], "gaze": [0, 0, -1], "scale": 9}}},
  "background": [0, 0.5, 1e0],
  "allow": ["eye-inside", "a\u00e9\ud83d\ude00\n"],
  "geometries": [
    {"Plane": {"name": "floor", "point": [0, -1, 0], "normal": [0, 1, 0], "color": [0, 1, 0]}},
    {"Sphere": {"center": [-1, 0, -3], "radius": 0.5, "color": "#ff0000"}}
  ],
  "animation": {"fps": 24, "frames": 48, "tracks": {"camera.fov": [[0, 60], [2.5, 30, "Smooth"]]}}
}
"##,
    "{\"camera\":{\"Orthographic\":{\"eye\":[0,0,0],\"look_at\":[0,0,-1],\"scale\":2,\"stretch\":true,\"up\":null}},\"geometries\":[]}",
    "[1, -0, 0.5, 1E+5, 1e-5, true, false, null, \"\\\"\\\\\\/\\b\\f\", [], {}, {\"a\": {\"b\": [[]]}}]",
];

/// Panics if the tree violates an invariant.
pub(crate) fn check(text: &str, tree: &Tree) {
    let inside = |r: &std::ops::Range<usize>| {
        assert!(r.start <= r.end && r.end <= text.len(), "{r:?} in {text:?}");
        assert!(
            text.is_char_boundary(r.start) && text.is_char_boundary(r.end),
            "{r:?} in {text:?}"
        );
    };
    let mut last_end = vec![usize::MAX; tree.len()];
    let mut counts = vec![0usize; tree.len()];
    for id in tree.ids() {
        let node = tree.node(id);
        inside(&node.range());
        if let Some(name) = node.name() {
            inside(&name);
            assert!(name.end <= node.range().end);
        }
        match node.parent() {
            None => assert_eq!(id.index(), 0),
            Some(parent) => {
                assert!(parent < id);
                let p = tree.node(parent);
                let (pr, r) = (p.range(), node.range());
                assert!(
                    pr.start <= r.start && r.end <= pr.end,
                    "{r:?} outside {pr:?} in {text:?}"
                );
                let last = &mut last_end[parent.index()];
                assert!(
                    *last == usize::MAX || *last <= r.start,
                    "siblings overlap at {r:?} in {text:?}"
                );
                *last = r.end;
                counts[parent.index()] += 1;
            }
        }
    }
    for id in tree.ids() {
        let node = tree.node(id);
        assert_eq!(tree.children(id).count(), counts[id.index()], "in {text:?}");
        assert!(tree.children(id).all(|c| tree.node(c).parent() == Some(id)));
        match node.kind() {
            NodeKind::Struct | NodeKind::Map => {
                assert_eq!(counts[id.index()] % 2, 0, "odd fields in {text:?}");
                assert_eq!(tree.fields(id).count() * 2, counts[id.index()]);
            }
            NodeKind::Tuple | NodeKind::List => {}
            _ => assert_eq!(counts[id.index()], 0, "in {text:?}"),
        }
    }
    let mut last = 0;
    for c in tree.comments() {
        inside(&c.range());
        assert!(c.range().start >= last && c.range().end > c.range().start);
        last = c.range().end;
    }
    let mut previous = None;
    for f in tree.faults() {
        inside(&f.range);
        assert!(
            previous.is_none_or(|p| p < f.range.start),
            "two faults at {} in {text:?}",
            f.range.start
        );
        previous = Some(f.range.start);
        assert!(
            !f.message.is_empty() && !f.message.contains('\n'),
            "{:?}",
            f.message
        );
        assert!(
            !f.help
                .as_ref()
                .is_some_and(|h| h.is_empty() || h.contains('\n')),
            "{:?}",
            f.help
        );
        if let Some((range, _)) = &f.label {
            inside(range);
            assert!(!range.is_empty());
        }
    }
}
