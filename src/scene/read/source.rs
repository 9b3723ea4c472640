//! A text read from its file in blocks, so that it is never whole in memory.

use std::{
    cell::OnceCell,
    fs::File,
    io::Read,
    mem,
    sync::{Mutex, MutexGuard, PoisonError},
};

use super::reader::{Misfit, Result};

/// The minimum size of a block, followed by its small surplus.
pub(super) const BLOCK: usize = if cfg!(test) { 1 << 7 } else { 1 << 18 };
const MORE: usize = BLOCK / 64;
/// The distance from the end of the bytes read where the search for a cut starts.
const NEAR: usize = if cfg!(test) { 1 << 4 } else { 1 << 10 };
/// The size of the part of a file that must contain everything before its long list. Tests use
/// less.
const HEAD: u64 = if cfg!(test) { 1 << 8 } else { 1 << 16 };

/// A file whose first part has been read.
pub(super) struct Source<'f> {
    file: &'f File,
    /// The apparent number of bytes.
    pub(super) length: usize,
    head: String,
    /// The bytes read after the head.
    beyond: Vec<u8>,
    /// The text after the long list, once read.
    rest: OnceCell<String>,
    /// Buffers of earlier blocks, reused because fresh memory costs more than reading into it.
    spare: Spare,
}

type Spare = Mutex<Vec<Vec<u8>>>;

impl<'f> Source<'f> {
    /// Opens a source at the start of a file.
    pub(super) fn new(mut file: &'f File, length: usize) -> Result<Self> {
        let mut head = Vec::new();
        let read = file.by_ref().take(HEAD).read_to_end(&mut head);
        read.map_err(|_| Misfit)?;
        // The last character may be incomplete.
        let end = std::str::from_utf8(&head).map_or_else(|error| error.valid_up_to(), str::len);
        let beyond = head.split_off(end);
        Ok(Self {
            file,
            length,
            head: text(head)?,
            beyond,
            rest: OnceCell::new(),
            spare: Spare::default(),
        })
    }

    /// Returns the start of the file as text, without a byte order mark.
    pub(super) fn head(&self) -> &str {
        self.head.strip_prefix('\u{feff}').unwrap_or(&self.head)
    }

    /// Returns true if the whole file has been read, not only its head.
    pub(super) fn is_read(&self) -> bool {
        self.rest.get().is_some()
    }

    /// Returns the rest of the head and everything after it, cut by `guess`.
    pub(super) fn blocks(&self, rest: &str, guess: Guess) -> Blocks<'_> {
        Blocks {
            file: self.file,
            spare: &self.spare,
            bytes: [rest.as_bytes(), &self.beyond].concat(),
            guess,
            ended: false,
        }
    }

    /// Returns the text after the long list.
    pub(super) fn rest(&self, blocks: &[Block]) -> &str {
        let texts = blocks.iter().map(AsRef::as_ref);
        self.rest.get_or_init(|| texts.collect())
    }
}

/// A piece of the text.
pub(super) struct Block<'s> {
    text: String,
    spare: &'s Spare,
}

impl AsRef<str> for Block<'_> {
    fn as_ref(&self) -> &str {
        &self.text
    }
}

impl Drop for Block<'_> {
    fn drop(&mut self) {
        let mut bytes = mem::take(&mut self.text).into_bytes();
        bytes.clear();
        lock(self.spare).push(bytes);
    }
}

fn lock(spare: &Spare) -> MutexGuard<'_, Vec<Vec<u8>>> {
    spare.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A function that returns a place to cut, at or after another one.
pub(super) type Guess = fn(&[u8], usize) -> Option<usize>;

/// The blocks of a text.
pub(super) struct Blocks<'s> {
    file: &'s File,
    spare: &'s Spare,
    /// The bytes read that belong to the next block.
    bytes: Vec<u8>,
    guess: Guess,
    ended: bool,
}

impl<'s> Blocks<'s> {
    fn read(&mut self) -> Result<String> {
        loop {
            self.bytes.reserve(BLOCK + MORE);
            let mut block = self.file.take(BLOCK as u64);
            let read = block.read_to_end(&mut self.bytes).map_err(|_| Misfit)?;
            self.ended = read < BLOCK;
            if self.ended {
                return text(mem::take(&mut self.bytes));
            }
            // The cut is as late as possible; in a long comment there is none. The bytes read
            // before have been searched, except for a place at their end.
            let new = read + NEAR;
            let backs = [NEAR, NEAR << 4, new].into_iter();
            let mut places = backs.map(|back| self.bytes.len().saturating_sub(back));
            if let Some(cut) = places.find_map(|from| (self.guess)(&self.bytes, from)) {
                let mut rest = lock(self.spare).pop().unwrap_or_default();
                rest.extend_from_slice(&self.bytes[cut..]);
                self.bytes.truncate(cut);
                return text(mem::replace(&mut self.bytes, rest));
            }
        }
    }
}

impl<'s> Iterator for Blocks<'s> {
    type Item = Result<Block<'s>>;

    fn next(&mut self) -> Option<Self::Item> {
        (!self.ended).then(|| {
            let text = self.read();
            self.ended |= text.is_err();
            let spare = self.spare;
            text.map(|text| Block { text, spare })
        })
    }
}

/// Converts bytes to text; rejects NUL, which no scene contains.
fn text(bytes: Vec<u8>) -> Result<String> {
    if bytes.contains(&0) {
        return Err(Misfit);
    }
    String::from_utf8(bytes).map_err(|_| Misfit)
}

#[cfg(test)]
mod tests {
    use std::io::{Seek, Write};

    use crate::{parallel::Pool, scene::read, text::syntax::Syntax};

    fn is_known(text: &[u8]) -> bool {
        let mut file = tempfile::tempfile().unwrap();
        file.write_all(text).unwrap();
        file.rewind().unwrap();
        read::file(&file, text.len(), Syntax::Ron, &Pool::Calling).is_some()
    }

    #[test]
    fn the_whole_file_is_checked() {
        let camera = "camera: Orthographic(eye: (0, 0, 0), gaze: (0, 0, 1), scale: 3)";
        let sphere = "Sphere(center: (0, 0, 5), radius: 1, color: \"#fff\"),\n";
        for count in [1, 2, 3, 10, 100] {
            let list = sphere.repeat(count);
            let scene = |end: &str| format!("({camera}, geometries: [{list}]{end}").into_bytes();
            let torn = |byte: u8| {
                let mut scene = scene(")");
                let at = scene.len() / 2;
                let quote = scene[at..].iter().position(|byte| *byte == b'"');
                scene.insert(at + quote.unwrap_or(0) + 1, byte);
                scene
            };
            assert!(is_known(&scene(")")));
            assert!(is_known(&scene(", background: \"#000\")\n// é")));
            assert!(!is_known(&scene(")x")));
            assert!(!is_known(&scene(", background: \"#000\"")));
            assert!(!is_known(&torn(0)) && !is_known(&torn(0xff)));
        }
        // The list is empty, and the head ends far from the end.
        let empty = format!("({camera}, geometries: []){}x", " ".repeat(500));
        assert!(!is_known(empty.as_bytes()));
    }
}
