//! What the tests of an edited scene share.

use std::sync::{Arc, mpsc};

use crate::{
    scene::options::ReadOptions,
    session::{Session, checked::Checked},
    text::{
        edit::{Edit, apply},
        syntax::Syntax,
    },
};

/// Returns the check of `text`.
pub(super) fn checked(text: &str) -> Arc<Checked> {
    let (send, receive) = mpsc::channel();
    let options = ReadOptions::new().syntax(Syntax::of_text(text));
    let _session = Session::new("mine", text, options, move |checked| {
        let _ = send.send(checked);
    });
    receive.recv().unwrap()
}

/// Returns `text` after `edits`.
pub(super) fn edited(text: &str, edits: &[Edit]) -> String {
    apply(text, edits.iter().map(std::slice::from_ref)).0
}

/// A scene with comments at places where edits meet them.
pub(super) const TEXT: &str = r##"(
    camera: Fit(), // mine
    geometries: [
        Sphere(center: (0, 0, 0), radius: 1, color: "#f00"), // red
        Group(geometries: [Sphere(center: (3, 0, 0), radius: 1, color: "#0f0", name: "green") /* , */ ,
            Sphere(center: (6, 0, 0), radius: 1, color: "#00f")]),
    ],
)
"##;
