//! The lines of the faces of a text, for faults that are found after it has been read.

use std::io;

use crate::data::{fault::most_listed, mesh::Flaw};

/// The lines of a flaw: the first ones, and the number of all.
#[derive(Default)]
pub(super) struct FlawedLines {
    lines: Vec<u64>,
    count: usize,
}

impl FlawedLines {
    pub(super) fn add(&mut self, flaw: Flaw, line: u64) {
        if self.lines.len() < most_listed(flaw.is_error()) {
            self.lines.push(line);
        }
        self.count += 1;
    }

    pub(super) fn all(&self) -> (&[u64], usize) {
        (&self.lines, self.count)
    }
}

/// The first triangle of a face, and the line of the face.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Start {
    triangle: usize,
    line: u64,
}

/// Faces with the same number of triangles and of lines between each two.
#[derive(Clone, Copy, Debug)]
struct Run {
    first: Start,
    last: Start,
    /// The triangles and the lines between two faces; 0 if there is only one.
    step: Start,
}

/// The lines of faces: most files need few runs.
#[derive(Clone, Debug, Default)]
pub(super) struct Lines(Vec<Run>);

impl Lines {
    /// The maximum number of runs, 12 MB; the faces behind them have no lines.
    const MOST: usize = 1 << 18;

    /// Adds the next face.
    #[inline(always)]
    pub(super) fn add(&mut self, triangle: usize, line: u64) -> io::Result<()> {
        let face = Start { triangle, line };
        if let Some(Run { last, step, .. }) = self.0.last_mut()
            && last.triangle + step.triangle == triangle
            && last.line + step.line == line
        {
            *last = face;
            return Ok(());
        }
        self.start(face)
    }

    #[cold]
    fn start(&mut self, face: Start) -> io::Result<()> {
        if let Some(run) = self.0.last_mut()
            && run.step == Start::default()
        {
            run.last = face;
            run.step = Start {
                triangle: face.triangle - run.first.triangle,
                line: face.line.saturating_sub(run.first.line),
            };
            return Ok(());
        }
        // The one behind the most ends the run before it.
        if self.0.len() <= Self::MOST {
            self.0.try_reserve(1)?;
            self.0.push(Run {
                first: face,
                last: face,
                step: Start::default(),
            });
        }
        Ok(())
    }

    /// Returns the line of the face that a triangle belongs to, if it is known.
    pub(super) fn of(&self, triangle: usize) -> Option<u64> {
        let behind = self.0.partition_point(|run| run.first.triangle <= triangle);
        let number = behind.checked_sub(1).filter(|run| *run < Self::MOST)?;
        let Run { first, last, step } = self.0.get(number)?;
        if triangle >= last.triangle {
            return Some(last.line);
        }
        let faces = (triangle - first.triangle).checked_div(step.triangle)?;
        Some(first.line + faces as u64 * step.line)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_have_the_lines_of_their_faces() {
        // The number of triangles of each face, and its line.
        let faces = [
            (1, 5),
            (1, 6),
            (3, 7),
            (1, 8),
            (1, 9),
            (2, 20),
            (2, 27),
            (2, 34),
            (1, 34),
            (1, 34),
        ];
        let (mut lines, mut all) = (Lines::default(), Vec::new());
        for (triangles, line) in faces {
            lines.add(all.len(), line).unwrap();
            all.extend([Some(line)].repeat(triangles));
        }
        let found: Vec<_> = (0..all.len()).map(|triangle| lines.of(triangle)).collect();
        assert_eq!(found, all);
        assert_eq!(Lines::default().of(0), None);
    }

    #[test]
    fn the_number_of_runs_is_bounded() {
        let mut lines = Lines::default();
        let mut line = |face: usize| {
            // No three faces are alike.
            lines.add(face, (face * face) as u64).unwrap();
        };
        let last = 2 * Lines::MOST;
        (0..last + 100).for_each(&mut line);
        assert_eq!(lines.0.len(), Lines::MOST + 1);
        let squares = [0, 1, 2, 17, last - 1].map(|face| lines.of(face));
        let expected = [0, 1, 2, 17, last - 1].map(|face| Some((face * face) as u64));
        assert_eq!(squares, expected);
        assert_eq!(lines.of(last + 50), None);
    }
}
