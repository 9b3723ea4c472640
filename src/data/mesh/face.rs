//! The triangles of faces.

use std::io;

use crate::data::{
    fault::ReadError,
    mesh::{
        Flaw, MeshFile,
        place::FilePlace,
        polygon::{self, Fan, Polygon},
        push,
    },
};

/// A face that comes before its vertices: a fan.
#[derive(Clone, Copy, Debug)]
pub(super) struct Early {
    /// The first triangle.
    first: usize,
    /// The number of corners.
    corners: usize,
    place: FilePlace,
}

/// The most work for polygons that are not fans, in a file: it takes seconds.
const MOST_WORK: u64 = 1 << 30;

/// The most corners of a polygon that is not a fan.
const MOST_CORNERS: usize = 1 << 20;

impl MeshFile {
    /// Adds the triangles of a face, two less than it has corners.
    #[inline(always)]
    pub(super) fn add_face(&mut self, corners: &[u32], place: FilePlace) -> Result<(), ReadError> {
        let [first, second, rest @ ..] = corners else {
            self.few_corners(corners, place);
            return Ok(());
        };
        if rest.is_empty() {
            self.few_corners(corners, place);
        }
        let face = Early {
            first: self.triangles.len(),
            corners: corners.len(),
            place,
        };
        if !rest.is_empty() {
            self.start_face(face.first, place)?;
        }
        // One corner is read at a time: a pair would have to wait until both have been written.
        let mut last = *second;
        for next in rest {
            push(&mut self.triangles, [*first, last, *next], "triangles")?;
            last = *next;
        }
        if rest.len() == 2 && self.is_plain(corners) {
            return self.skip_check(face.first);
        }
        if rest.len() > 1 && !self.cut(face) {
            push(&mut self.early, face, "faces before their vertices")?;
        }
        Ok(())
    }

    /// Adds the texture coordinates of the triangles of the next face, given those of its corners.
    #[inline(always)]
    pub(super) fn add_uv_corners(&mut self, corners: &[u32]) -> Result<(), ReadError> {
        let [first, rest @ ..] = corners else {
            return Ok(());
        };
        for pair in rest.windows(2) {
            let triangle = [*first, pair[0], pair[1]];
            push(&mut self.uv.corners, triangle, "triangles")?;
        }
        Ok(())
    }

    /// Gives the corners of triangles the texture coordinates of their vertices, unless they have their own.
    pub(super) fn share_corners(&mut self) -> io::Result<()> {
        if self.uv.all.is_empty() || !self.uv.corners.is_empty() {
            return Ok(());
        }
        self.uv.corners.try_reserve_exact(self.triangles.len())?;
        self.uv.corners.extend_from_slice(&self.triangles);
        Ok(())
    }

    /// Notes the line of the face that starts with a triangle.
    #[inline(always)]
    pub(super) fn start_face(&mut self, first: usize, place: FilePlace) -> Result<(), ReadError> {
        match place.text_line() {
            Some(line) => Ok(self.lines.add(first, line)?),
            None => Ok(()),
        }
    }

    /// Returns true if four corners need no closer look.
    #[inline(always)]
    fn is_plain(&self, corners: &[u32]) -> bool {
        let corner = |index: u32| self.vertices.get(index as usize);
        let [a, b, c, d] = *corners else {
            return false;
        };
        match (corner(a), corner(b), corner(c), corner(d)) {
            (Some(a), Some(b), Some(c), Some(d)) => polygon::is_plain([*a, *b, *c, *d]),
            _ => false,
        }
    }

    /// Notes that two triangles have an area.
    #[inline(always)]
    fn skip_check(&mut self, first: usize) -> Result<(), ReadError> {
        match self.with_area.last_mut() {
            Some(run) if run.end == first => {
                run.end += 2;
                Ok(())
            }
            _ => push(&mut self.with_area, first..first + 2, "faces"),
        }
    }

    #[cold]
    fn few_corners(&mut self, corners: &[u32], place: FilePlace) {
        self.note(Flaw::Corners, || {
            let corners = match corners.len() {
                1 => "1 corner".to_owned(),
                count => format!("{count} corners"),
            };
            let fault = place.fault(format!("a face with {corners} is not used"));
            fault.help("a face has at least 3 corners")
        });
    }

    /// Cuts a polygon anew if its fan is wrong; returns false if some of its vertices have not been
    /// read.
    pub(super) fn cut(&mut self, face: Early) -> bool {
        let range = face.first..face.first + face.corners - 2;
        let Some(triangles) = self.triangles.get_mut(range.clone()) else {
            return true;
        };
        self.corners.clear();
        for vertex in corners_of(triangles) {
            match self.vertices.get(vertex as usize) {
                Some(at) => self.corners.push(*at),
                None => return false,
            }
        }
        let Some(fan) = Fan::of(&self.corners) else {
            return true;
        };
        let place = face.place;
        let mut crossing = None;
        if !fan.is_right {
            let cut = match self.corners.len() {
                ..=MOST_CORNERS => {
                    let polygon = Polygon::new(&fan.project(&self.corners));
                    self.work = self.work.saturating_add(polygon.work());
                    (self.work <= MOST_WORK).then(|| polygon.cut(self.cancel.as_ref()))
                }
                _ => None,
            };
            match cut {
                Some(Some(cut)) => {
                    recut(triangles, &cut);
                    if let Some(of_uv) = self.uv.corners.get_mut(range) {
                        recut(of_uv, &cut);
                    }
                }
                Some(None) => crossing = Some("the edges of a face cross"),
                None => crossing = Some("a face has too many corners that turn inward"),
            }
        }
        if let Some(what) = crossing {
            self.note(Flaw::Crossing, || {
                let fault = place.fault(format!("{what}; it is a fan around its first corner"));
                fault.help("save the mesh as triangles")
            });
        }
        if !fan.is_flat {
            self.note(Flaw::NotFlat, || {
                place.fault("the corners of a face are not in a plane").help(
                    "save the mesh as triangles, so that its shape does not depend on the program",
                )
            });
        }
        true
    }
}

/// Returns the corners of a fan.
fn corners_of(fan: &[[u32; 3]]) -> impl Iterator<Item = u32> {
    let [start @ .., _] = fan.first().copied().unwrap_or_default();
    let ends = fan.iter().map(|[.., end]| *end);
    start.into_iter().chain(ends)
}

/// Replaces the triangles of a fan by others, given as the numbers of its corners.
fn recut(fan: &mut [[u32; 3]], cut: &[[usize; 3]]) {
    let all: Vec<u32> = corners_of(fan).collect();
    for (triangle, corners) in fan.iter_mut().zip(cut) {
        *triangle = corners.map(|corner| all[corner]);
    }
}
