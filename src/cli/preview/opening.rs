//! Opening the page in the browser.
//!
//! Everybody on a machine can read the arguments of a running program, and the address of the page
//! contains its token. So the browser gets the path of a private file that leads to the address.

use std::{
    io::{self, Write},
    sync::Mutex,
};

use tempfile::TempPath;

use crate::cli::threads::lock;

/// The private file, as long as nobody has opened the page.
#[derive(Default)]
pub(super) struct Opening(Mutex<Option<TempPath>>);

impl Opening {
    /// Opens an address in the browser.
    pub(super) fn open(&self, url: &str) -> io::Result<()> {
        let mut file = tempfile::Builder::new()
            .prefix("strahl-preview-")
            .suffix(".html")
            .tempfile()?;
        write!(
            file,
            "<!doctype html><meta charset=\"utf-8\"><title>strahl preview</title>\
             <meta http-equiv=\"refresh\" content=\"0; url={url}\"><a href=\"{url}\">strahl preview</a>"
        )?;
        let file = file.into_temp_path();
        let path = file.to_path_buf();
        *lock(&self.0) = Some(file);
        open::that_detached(path)
    }

    /// Removes the file.
    pub(super) fn end(&self) {
        lock(&self.0).take();
    }
}
