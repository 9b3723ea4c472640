//! What the tests of an edited scene share.

use std::sync::{Arc, mpsc};

use crate::{
    scene::options::ReadOptions,
    session::{Checked, Session},
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
