//! The triangles of an STL file of text, as programs and people write it.
//!
//! Words count, not lines, except where a line is the only end: of names and of comments. Colors are
//! not read.

use std::io::Read;

use glam::DVec3;

use crate::{
    data::{
        bytes::LONGEST_LINE,
        fault::{At, Fault, ReadError},
        mesh::{
            Flaw, MeshFile,
            join::Joined,
            number,
            place::FilePlace,
            push,
            stl_facet::{Facet, is_like_a_number},
            stream::Stream,
        },
    },
    text::nearest::{list, quote},
    tracer::shape::mesh::MeshGroup,
};

/// A place between the words of a text.
#[derive(Clone, Copy, PartialEq)]
enum State {
    Outside,
    Solid,
    Facet,
    Loop,
    LoopEnd,
}

/// The keywords, each with the state before and after.
const KEYWORDS: [(&str, State, State); 7] = [
    ("solid", State::Outside, State::Solid),
    ("facet", State::Solid, State::Facet),
    ("outer", State::Facet, State::Loop),
    ("vertex", State::Loop, State::Loop),
    ("endloop", State::Loop, State::LoopEnd),
    ("endfacet", State::LoopEnd, State::Solid),
    (END_SOLID, State::Solid, State::Outside),
];

/// The last keyword of a solid; some programs write the name without a space behind it.
const END_SOLID: &str = "endsolid";

/// The starts of comments.
const COMMENTS: [&[u8]; 3] = [b"#", b"//", b";"];

/// Returns the keywords that may follow in a state.
fn expected(state: State) -> String {
    let after = KEYWORDS.iter().filter(|(_, from, _)| *from == state);
    let names: Vec<_> = after.map(|(name, ..)| *name).collect();
    list(&names)
}

#[inline(always)]
pub(super) fn is(word: &[u8], keyword: &str) -> bool {
    word.eq_ignore_ascii_case(keyword.as_bytes())
}

/// Returns the keyword that a word is; with `has_end`, the word `end` is before it.
fn keyword(word: &[u8], has_end: bool) -> Option<&'static str> {
    let start = word.get(..END_SOLID.len()).unwrap_or(word);
    let mut names = KEYWORDS.iter().map(|(name, ..)| *name);
    match has_end {
        true => names.find(|name| name.strip_prefix("end").is_some_and(|name| is(word, name))),
        false if is(start, END_SOLID) => Some(END_SOLID),
        false => names.find(|name| is(word, name)),
    }
}

pub(super) fn read(mut file: Stream<impl Read>, mesh: MeshFile) -> Result<MeshFile, ReadError> {
    file.skip_mark()?;
    let mut reader = Reader {
        mesh,
        joined: Joined::default(),
        corners: Vec::new(),
        state: State::Outside,
        start: 0,
        facet: 0,
        naming: None,
        skipped: None,
        has_end: false,
        may_skip_numbers: false,
        vertex: None,
    };
    loop {
        // All state between facets is that of the solid, where a line ends its name and comments.
        while reader.state == State::Solid && !reader.has_end {
            file.have(Facet::USUAL)?;
            let line_end = file.line_end()?;
            let Some(facet) = Facet::parse(file.bytes(), line_end) else {
                break;
            };
            reader.facet(&facet, file.lines() + 1)?;
            file.skip(facet.length, facet.ends);
        }
        let Some((line, word)) = file.word()? else {
            break;
        };
        reader.word(line, word)?;
    }
    reader.finish()
}

struct Reader {
    mesh: MeshFile,
    joined: Joined,
    /// The corners of the facet.
    corners: Vec<u32>,
    state: State,
    /// The line on which the solid starts.
    start: u64,
    /// The line on which the facet starts.
    facet: u64,
    /// True after `facet` in the name of the solid, which ends with its line or at `facet normal`.
    naming: Option<bool>,
    /// The line whose further words are skipped.
    skipped: Option<u64>,
    /// True after the word `end`.
    has_end: bool,
    /// True after `facet` and `color`.
    may_skip_numbers: bool,
    vertex: Option<Vertex>,
}

/// A vertex that is being read.
struct Vertex {
    line: u64,
    numbers: [f64; 3],
    count: usize,
}

impl Reader {
    #[inline]
    fn word(&mut self, line: u64, word: &[u8]) -> Result<(), ReadError> {
        if self.skipped == Some(line) {
            // Another solid may follow in a text of one line.
            if self.state != State::Outside || self.start != line || !is(word, "solid") {
                return Ok(());
            }
            self.skipped = None;
        } else if COMMENTS.iter().any(|comment| word.starts_with(comment))
            && (self.naming.is_none() || self.start != line)
        {
            self.skipped = Some(line);
            return Ok(());
        }
        if let Some(has_facet) = self.naming.filter(|_| self.start == line) {
            let is_facet = has_facet && is(word, "normal");
            if !is_facet && !is(word, END_SOLID) {
                self.naming = Some(is(word, "facet"));
                self.name(word);
                return Ok(());
            }
            if is_facet {
                self.cut_name();
                self.naming = None;
                self.facet = line;
                self.state = State::Facet;
                self.may_skip_numbers = true;
                return Ok(());
            }
        }
        self.naming = None;
        if self.may_skip_numbers && (is_like_a_number(word) || is(word, "normal")) {
            return Ok(());
        }
        if !self.has_end && is(word, "end") {
            self.has_end = true;
            return Ok(());
        }
        let keyword = keyword(word, std::mem::take(&mut self.has_end));
        if let Some(vertex) = &mut self.vertex
            && keyword.is_none()
            && !is(word, "color")
        {
            let number = number(word);
            if let Some(slot) = vertex.numbers.get_mut(vertex.count) {
                *slot = number.unwrap_or_default();
            }
            vertex.count += 1;
            if number.is_none() {
                self.mesh.not_a_number(line, word);
            }
            return Ok(());
        }
        self.end_vertex()?;
        self.may_skip_numbers = false;
        match keyword {
            None if is(word, "color") => {
                self.may_skip_numbers = true;
                self.mesh.once(Flaw::Material, || {
                    let fault = At::line(line).fault("the colors of an STL file are not used");
                    fault.help("give the mesh one `color` or `material`")
                });
                Ok(())
            }
            None if self.state == State::Loop && is(word, "loop") => Ok(()),
            _ => self.keyword(line, word, keyword),
        }
    }

    /// Adds a whole facet, behind the end of this line.
    #[inline]
    fn facet(&mut self, facet: &Facet, line: u64) -> Result<(), ReadError> {
        (self.naming, self.skipped, self.may_skip_numbers) = (None, None, false);
        let mut corners = [0; 3];
        for (corner, (at, ends)) in corners.iter_mut().zip(facet.corners) {
            let place = FilePlace::line(line + ends);
            let at = DVec3::from_array(at);
            *corner = self.joined.vertex(at, &mut self.mesh, place)?;
        }
        let first = self.mesh.triangles.len();
        let place = FilePlace::line(line + facet.start);
        self.mesh.start_face(first, place)?;
        push(&mut self.mesh.triangles, corners, "triangles")
    }

    fn keyword(
        &mut self,
        line: u64,
        word: &[u8],
        keyword: Option<&'static str>,
    ) -> Result<(), ReadError> {
        let mut keywords = KEYWORDS.iter();
        let found = keywords.find(|(name, from, _)| Some(*name) == keyword && *from == self.state);
        let Some((keyword, _, to)) = found else {
            let state = self.state;
            self.skipped = Some(line);
            self.mesh.note(Flaw::Line, || {
                let (expected, word) = (expected(state), String::from_utf8_lossy(word));
                let at = At::line(line).word(&*word);
                at.fault(format!("expected {expected}, found {}", quote(&word)))
            });
            return Ok(());
        };
        self.state = *to;
        match *keyword {
            "solid" => {
                self.start = line;
                self.naming = Some(false);
                self.mesh.groups.push(MeshGroup {
                    name: String::new(),
                    first: self.mesh.triangles.len(),
                });
            }
            "facet" => {
                self.facet = line;
                self.may_skip_numbers = true;
            }
            "outer" => self.corners.clear(),
            "vertex" => {
                let (numbers, count) = ([0.0; 3], 0);
                self.vertex = Some(Vertex {
                    line,
                    numbers,
                    count,
                });
            }
            "endloop" => {
                let place = FilePlace::line(self.facet);
                self.mesh.add_face(&self.corners, place)?;
            }
            END_SOLID => self.skipped = Some(line),
            _ => {}
        }
        Ok(())
    }

    /// Adds a word to the name of the solid.
    fn name(&mut self, word: &[u8]) {
        if let Some(MeshGroup { name, .. }) = self.mesh.groups.last_mut()
            && name.len() + word.len() < LONGEST_LINE
        {
            if !name.is_empty() {
                name.push(' ');
            }
            name.push_str(&String::from_utf8_lossy(word));
        }
    }

    /// Removes the last word of the name of the solid.
    fn cut_name(&mut self) {
        if let Some(MeshGroup { name, .. }) = self.mesh.groups.last_mut() {
            name.truncate(name.rfind(' ').unwrap_or_default());
        }
    }

    #[inline]
    fn end_vertex(&mut self) -> Result<(), ReadError> {
        let Some(vertex) = self.vertex.take() else {
            return Ok(());
        };
        let Vertex {
            line,
            numbers,
            count,
        } = vertex;
        if count != numbers.len() {
            self.mesh.note(Flaw::Length, || {
                At::line(line).fault(format!("{count} numbers, expected 3"))
            });
        }
        let at = DVec3::from_array(numbers);
        let corner = self
            .joined
            .vertex(at, &mut self.mesh, FilePlace::line(line))?;
        push(&mut self.corners, corner, "corners")
    }

    fn finish(mut self) -> Result<MeshFile, ReadError> {
        self.end_vertex()?;
        if self.state != State::Outside {
            let state = self.state;
            self.mesh.note(Flaw::End, || {
                let expected = expected(state);
                Fault::new(format!(
                    "the file is cut off: expected {expected} at its end"
                ))
            });
        }
        Ok(self.mesh)
    }
}
