//! A series: the rows of a table as the frames of one movie.

use strahl::{Document, Scene, parallel::in_order};

use super::{
    list::List,
    shared,
    source::{RowFaults, with_row},
};
use crate::cli::{
    failure::Failure,
    params::{Columns, Params},
};

/// Number of rows that are being read or wait to be checked.
const AT_ONCE: usize = 64;

/// The rows of a table, of which each is a frame. They are read again for each use, so that a long
/// series takes no more memory than a short one.
#[derive(Clone, Copy)]
pub(super) struct Series<'b> {
    list: &'b List,
    document: &'b Document,
    columns: &'b Columns,
}

/// The result of checking all rows.
pub(super) struct Checked<'b> {
    /// The scene with the first row.
    pub(super) first: Result<Scene, Failure>,
    pub(super) faults: Vec<RowFaults>,
    /// `None` if the scene has an animation, whose frames the movie has instead.
    pub(super) series: Option<Series<'b>>,
    /// True if the colors of the rows have different ranges.
    pub(super) ranges_differ: bool,
}

impl<'b> Series<'b> {
    /// The default number of frames per second.
    pub(super) const FPS: f64 = 24.0;

    /// Reads and checks all rows.
    pub(super) fn checked(
        list: &'b List,
        document: &'b Document,
        columns: &'b Columns,
        threads: usize,
    ) -> Checked<'b> {
        let series = Self {
            list,
            document,
            columns,
        };
        let mut first: Option<Result<Scene, Failure>> = None;
        let mut all_faults = Vec::new();
        let (mut ranges, mut ranges_differ) = (None, false);
        let read = |row| (row, with_row(list, row, document, columns));
        let take =
            |(row, (scene, faults)): (usize, (Result<Scene, Failure>, Option<RowFaults>))| {
                all_faults.extend(faults);
                if let Ok(scene) = &scene {
                    let found = shared::used_ranges(scene);
                    ranges_differ |= *ranges.get_or_insert_with(|| found.clone()) != found;
                }
                first = Some(match (first.take(), scene) {
                    (None, scene) => scene,
                    (Some(Ok(first)), Ok(scene)) => series.alike(first, &scene, row),
                    (Some(Ok(_)), Err(failure)) | (Some(Err(failure)), _) => Err(failure),
                });
                Ok(())
            };
        let ended = in_order(0..series.len(), threads, AT_ONCE, read, take);
        let first = ended.and_then(|()| first.unwrap_or(Err(Failure::Found)));
        let is_animated = first
            .as_ref()
            .is_ok_and(|scene| scene.animation().is_some());
        Checked {
            first,
            faults: all_faults,
            series: (!is_animated).then_some(series),
            ranges_differ,
        }
    }

    /// Returns the scene with the first row, unless one with another does not go with it.
    fn alike(&self, first: Scene, other: &Scene, row: usize) -> Result<Scene, Failure> {
        if first.animation().is_some() || other.animation().is_some() {
            return Err(Failure::usage(
                "the scene has an animation, so each row is a movie: put {id} into the name",
            ));
        }
        let [one, size] = [&first, other].map(|scene| scene.size());
        if one != size {
            let params = self.list.params.as_ref();
            let row = params.map_or_else(String::new, |params| params.row(row));
            return Err(Failure::usage(format!(
                "{row}: the picture is {size}, but the first one of the movie is {one}"
            )));
        }
        Ok(first)
    }

    /// The number of frames.
    pub(super) fn len(&self) -> usize {
        self.list.params.as_ref().map_or(0, Params::len)
    }

    /// Returns the scene with a row.
    pub(super) fn scene(&self, row: usize) -> Result<Scene, Failure> {
        with_row(self.list, row, self.document, self.columns).0
    }
}
