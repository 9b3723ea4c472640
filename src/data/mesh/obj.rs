//! The vertices and faces of an OBJ file, with the names of its groups.
//!
//! The format is Wavefront's (Object Files, Appendix B1 of the Advanced Visualizer manual), with the
//! colors after the coordinates that later programs write. Texture coordinates are read if they are
//! wanted. Normals are skipped; materials, lines, points and curves are skipped with a warning.

use std::io::Read;

use glam::DVec3;

use crate::{
    data::{
        fault::{At, Fault, LinePart, ReadError},
        mesh::{
            Flaw, MOST, MeshFile, Request, lines::FlawedLines, place::FilePlace, push,
            stream::Stream,
        },
    },
    text::nearest::quote,
    tracer::shape::mesh::{MeshGroup, MeshUv},
};

/// Statements that say nothing about faces, besides those of normals.
const SKIPPED: &str = "vp s mg deg bmat step cstype parm trim hole scrv sp end con bevel c_interp d_interp \
    lod maplib usemap shadow_obj trace_obj ctech stech call csh res bzp bsp cdc cdp";

pub(super) fn read(mut file: Stream<impl Read>, request: &Request) -> Result<MeshFile, ReadError> {
    file.skip_mark()?;
    let mut reader = Reader {
        mesh: MeshFile::new(request),
        has_colors: request.colors && request.value.is_none(),
        has_uv: request.uv,
        whites: FlawedLines::default(),
        bare: FlawedLines::default(),
        corners: Vec::new(),
        of_uv: Vec::new(),
        later: Vec::new(),
    };
    while let Some((line, text)) = file.line(is_continued)? {
        reader.statement(line, text)?;
    }
    reader.finish()
}

/// Statements of names, which may end with a `\`, as folders do: there, one that joins lines is a word
/// of its own.
const OF_NAMES: &str = "g o usemtl mtllib usemap maplib shadow_obj trace_obj call csh";

fn is_any(keyword: &[u8], all: &str) -> bool {
    all.split(' ').any(|one| one.as_bytes() == keyword)
}

/// Returns true if a `\` joins a line to the next: at its end, unless it is that of a name or a
/// comment. The lines before `last` have neither.
#[inline(always)]
fn is_continued(line: &[u8], last: usize) -> bool {
    line.last() == Some(&b'\\') && !is_in_name(line) && !has_comment(line, last)
}

#[cold]
fn is_in_name(line: &[u8]) -> bool {
    // However many lines are joined, this is done for each.
    let start = line.get(..256).unwrap_or(line);
    let mut words = start.split(u8::is_ascii_whitespace);
    let keyword = words.find(|word| !word.is_empty());
    keyword.is_some_and(|keyword| is_any(keyword, OF_NAMES))
        && line
            .iter()
            .nth_back(1)
            .is_some_and(|byte| !byte.is_ascii_whitespace())
}

/// Returns true if a word of the last line starts with `#`.
#[cold]
fn has_comment(line: &[u8], last: usize) -> bool {
    let mut words = line
        .get(last..)
        .unwrap_or_default()
        .split(u8::is_ascii_whitespace);
    words.any(|word| word.starts_with(b"#"))
}

struct Reader {
    mesh: MeshFile,
    /// True if colors are read.
    has_colors: bool,
    /// True if texture coordinates are read.
    has_uv: bool,
    /// The lines of the vertices without a color.
    whites: FlawedLines,
    /// The lines of the faces without texture coordinates.
    bare: FlawedLines,
    /// The corners of a face, and the texture coordinates of these.
    corners: Vec<u32>,
    of_uv: Vec<u32>,
    /// The lines that name vertices before they are given, with the vertex.
    later: Vec<(u64, Numbered, u32)>,
}

/// What the numbers in a face stand for.
#[derive(Clone, Copy)]
enum Numbered {
    Vertex,
    TextureVertex,
}

impl Numbered {
    const fn name(self) -> &'static str {
        match self {
            Self::Vertex => "vertex",
            Self::TextureVertex => "texture vertex",
        }
    }

    /// Returns how many of them there are.
    #[inline(always)]
    const fn count(self, mesh: &MeshFile) -> usize {
        match self {
            Self::Vertex => mesh.vertices.len(),
            Self::TextureVertex => mesh.uv.all.len(),
        }
    }
}

/// The number of the texture coordinates of a corner that has none: no mesh has so many.
const NO_UV: u32 = u32::MAX;

impl Reader {
    #[inline(always)]
    fn statement(&mut self, line: u64, text: &[u8]) -> Result<(), ReadError> {
        let words = text.split(u8::is_ascii_whitespace);
        let mut words = words.filter(|word| !word.is_empty());
        let Some(keyword) = words.next() else {
            return Ok(());
        };
        let is_data = |word: &&[u8]| !word.starts_with(b"#");
        match keyword {
            b"vt" if self.has_uv => self.texture_vertex(line, words.take_while(is_data))?,
            b"vn" | b"vt" => {}
            b"v" => self.vertex(line, words.take_while(is_data))?,
            b"f" | b"fo" => self.face(line, words.take_while(is_data))?,
            b"g" | b"o" => {
                let words: Vec<_> = words.map(String::from_utf8_lossy).collect();
                self.group(words.join(" "));
            }
            b"usemtl" | b"mtllib" => self.mesh.once(Flaw::Material, || {
                let fault = At::line(line).fault("the materials of an OBJ file are not used");
                fault.help("give the mesh one `material`")
            }),
            b"l" | b"p" | b"curv" | b"curv2" | b"surf" => self.mesh.once(Flaw::NotFace, || {
                let keyword = quote(&String::from_utf8_lossy(keyword));
                At::line(line).fault(format!("{keyword} is not used, only faces `f`"))
            }),
            _ if keyword.starts_with(b"#") || is_any(keyword, SKIPPED) => {}
            _ => self.mesh.note(Flaw::Line, || {
                let keyword = String::from_utf8_lossy(keyword);
                let at = At::line(line).word(&*keyword);
                at.fault(format!(
                    "{} is not a statement of an OBJ file",
                    quote(&keyword)
                ))
            }),
        }
        Ok(())
    }

    fn group(&mut self, name: String) {
        let first = self.mesh.triangles.len();
        let groups = &mut self.mesh.groups;
        // Of several names before a face, the last is the most precise.
        groups.pop_if(|group| group.first == first);
        groups.push(MeshGroup { name, first });
    }

    #[inline(always)]
    fn vertex<'t>(
        &mut self,
        line: u64,
        words: impl Iterator<Item = &'t [u8]>,
    ) -> Result<(), ReadError> {
        let place = FilePlace::line(line);
        let mesh = &mut self.mesh;
        let (numbers, count) = mesh.numbers(line, words);
        if !matches!(count, 3 | 4 | 6) {
            mesh.note(Flaw::Length, || {
                let fault = place.fault(format!("{count} numbers in a vertex"));
                fault.help("write x, y and z, and r, g and b behind them if it has a color")
            });
        }
        let [x, y, z, r, g, b] = numbers;
        if self.has_colors && count == 6 {
            self.white()?;
            self.mesh.add_color([r, g, b], place)?;
        } else {
            self.whites.add(Flaw::Colorless, line);
        }
        self.mesh.add_vertex(DVec3::new(x, y, z), place)
    }

    #[inline(always)]
    fn texture_vertex<'t>(
        &mut self,
        line: u64,
        words: impl Iterator<Item = &'t [u8]>,
    ) -> Result<(), ReadError> {
        let place = FilePlace::line(line);
        // What may be missing is 0; the third is of solid textures.
        let ([u, v, _], count) = self.mesh.numbers(line, words);
        if !matches!(count, 1..=3) {
            self.mesh.note(Flaw::Length, || {
                let fault = place.fault(format!("{count} numbers in a texture vertex"));
                fault.help("write u and v")
            });
        }
        self.mesh.add_uv([u, v], place)
    }

    /// Gives white to the vertices without a color.
    #[inline(always)]
    fn white(&mut self) -> Result<(), ReadError> {
        let mesh = &mut self.mesh;
        while mesh.colors.len() < mesh.vertices.len() {
            push(&mut mesh.colors, [1.0; 3], "colors")?;
        }
        Ok(())
    }

    #[inline(always)]
    fn face<'t>(
        &mut self,
        line: u64,
        words: impl Iterator<Item = &'t [u8]>,
    ) -> Result<(), ReadError> {
        self.corners.clear();
        self.of_uv.clear();
        for word in words {
            // The numbers of a texture vertex and of a normal follow.
            let mut parts = word.split(|byte| *byte == b'/');
            let vertex = (Numbered::Vertex, parts.next().unwrap_or_default());
            let Some(corner) = self.corner(line, word, vertex)? else {
                return Ok(());
            };
            push(&mut self.corners, corner, "corners")?;
            if !self.has_uv {
                continue;
            }
            let uv = match parts.next() {
                None | Some([]) => Some(NO_UV),
                Some(part) => self.corner(line, word, (Numbered::TextureVertex, part))?,
            };
            let Some(uv) = uv else {
                return Ok(());
            };
            push(&mut self.of_uv, uv, "corners")?;
        }
        if self.of_uv.contains(&NO_UV) {
            self.bare.add(Flaw::Untextured, line);
        }
        // Before the face, which may be cut in another way.
        self.mesh.add_uv_corners(&self.of_uv)?;
        self.mesh.add_face(&self.corners, FilePlace::line(line))
    }

    /// Returns the vertex that a part of a word stands for, unless it is at fault.
    #[inline(always)]
    fn corner(
        &mut self,
        line: u64,
        word: &[u8],
        (kind, part): (Numbered, &[u8]),
    ) -> Result<Option<u32>, ReadError> {
        let before = kind.count(&self.mesh);
        let index = str::from_utf8(part).ok().and_then(|text| text.parse().ok());
        let Some(index) = index else {
            self.mesh.note(Flaw::Number, || {
                let word = String::from_utf8_lossy(word);
                let at = At::line(line).word(&*word);
                let fault = at.fault(format!("{} is not a corner of a face", quote(&word)));
                fault.help("write the number of a vertex, or `vertex/texture/normal`")
            });
            return Ok(None);
        };
        let corner = corner(index, before);
        match corner {
            None => {
                let fault = || missing(line, kind, index, before);
                self.mesh.note(Flaw::Index, fault);
            }
            Some(corner) if corner as usize >= before => {
                push(&mut self.later, (line, kind, corner), "corners")?;
            }
            Some(_) => {}
        }
        Ok(corner)
    }

    fn finish(mut self) -> Result<MeshFile, ReadError> {
        if !self.mesh.colors.is_empty() {
            self.white()?;
            self.mesh
                .note_all(Flaw::Colorless, self.whites.all(), |line| {
                    let fault = At::line(*line).fault("a vertex without a color is white");
                    fault.help("give all vertices a color, or none")
                });
        }
        if self.mesh.uv.corners.iter().flatten().all(|uv| *uv == NO_UV) {
            self.mesh.uv = MeshUv::default();
        } else {
            self.mesh
                .note_all(Flaw::Untextured, self.bare.all(), |line| {
                    let fault = At::line(*line);
                    let fault = fault.fault("a face without texture coordinates shows no texture");
                    fault.help("give all faces texture coordinates, or none")
                });
        }
        for (line, kind, corner) in self.later {
            let count = kind.count(&self.mesh);
            if corner as usize >= count {
                let index = i64::from(corner) + 1;
                let fault = || missing(line, kind, index, count);
                self.mesh.note(Flaw::Index, fault);
            }
        }
        Ok(self.mesh)
    }
}

/// Returns the vertex that a number in a face stands for, with `before` of them before it: from 1,
/// or from -1 backwards. It may be one that the file does not have.
#[inline(always)]
fn corner(index: i64, before: usize) -> Option<u32> {
    let from_0 = match index {
        1.. => index - 1,
        0 => return None,
        _ => index.checked_add(before as i64)?,
    };
    u32::try_from(from_0)
        .ok()
        .filter(|corner| (*corner as usize) < MOST)
}

#[cold]
fn missing(line: u64, kind: Numbered, index: i64, vertices: usize) -> Fault {
    let why = match (index, vertices) {
        (0, _) => "the first is 1".to_owned(),
        (_, 0) => "there are none".to_owned(),
        (..0, _) => format!("there are {vertices} before it"),
        (1.., _) => format!("the file has {vertices}, 1 to {vertices}"),
    };
    let at = At::line(line).part(LinePart::Number(index as f64));
    at.fault(format!("{} {index} does not exist, {why}", kind.name()))
}
