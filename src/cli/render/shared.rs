//! What the pictures of a table's rows share: with `--fit-all`, the framing and the colors of values.

use std::collections::BTreeMap;

use serde_json::json;
use strahl::{Document, Scene, Size, Syntax, scene::Setting};

use super::{list::List, source::with_row};
use crate::cli::{failure::Failure, params::Columns};

/// The maximum number of geometries of all rows, which are kept in memory.
const MOST: usize = 1 << 24;

/// The rows of a table that are seen together.
pub(super) struct Shared {
    scenes: Vec<Scene>,
}

impl Shared {
    /// Reads all rows, and makes them share the ranges of their colors. Rows with errors, which are
    /// reported elsewhere, do not count.
    pub(super) fn of(
        list: &List,
        document: &Document,
        columns: &mut Columns,
    ) -> Result<Self, Failure> {
        let rows = list.params.as_ref().map_or(0, |params| params.len());
        let mut shared = Self { scenes: Vec::new() };
        let mut ranges: BTreeMap<String, Common> = BTreeMap::new();
        let mut total = 0;
        for row in 0..rows {
            let Ok(scene) = with_row(list, row, document, columns).0 else {
                continue;
            };
            if scene.animation().is_some() {
                return Err(Failure::usage(
                    "--fit-all is for rows without an animation, whose frames are seen together anyway",
                ));
            }
            total += scene.world().ids();
            if total > MOST {
                return Err(Failure::usage(format!(
                    "--fit-all keeps all rows in memory: they have more than {MOST} geometries"
                )));
            }
            for (path, range) in ranges_of(&scene) {
                ranges.entry(path).or_default().add(range);
            }
            shared.scenes.push(scene);
        }
        let ranges = ranges
            .iter()
            .filter(|(_, common)| common.rows == shared.scenes.len());
        let settings = ranges.filter_map(|(path, common)| common.setting(path));
        columns.for_all = settings.collect();
        Ok(shared)
    }

    /// Returns a row as it is seen together with the others in a picture of this size.
    pub(super) fn seen(&self, row: Scene, size: Size) -> Result<Scene, Failure> {
        Ok(row.framed_with(&self.scenes, size)?)
    }
}

/// The values that the colors of a geometry stand for.
pub(super) type Range = Option<[f64; 2]>;

/// Returns the ranges of the colors of a scene that are not given, but those of its values, with the
/// paths of the geometries.
fn ranges_of(scene: &Scene) -> impl Iterator<Item = (String, Range)> {
    let all = scene.color_values().filter(|values| values.part.is_none());
    let own = all.filter(|values| values.scale.range == values.data);
    own.map(|values| {
        let mut origin = values.origin.clone();
        (origin.row, origin.instance) = (None, None);
        (origin.to_string(), values.data)
    })
}

/// Returns the ranges of all colors of a scene.
pub(super) fn used_ranges(scene: &Scene) -> Vec<Range> {
    let all = scene.color_values();
    all.map(|values| values.scale.range).collect()
}

/// The ranges of a geometry in some rows.
#[derive(Default)]
struct Common {
    range: Range,
    rows: usize,
}

impl Common {
    fn add(&mut self, range: Range) {
        self.rows += 1;
        self.range = match (self.range, range) {
            (Some([low, high]), Some([from, to])) => Some([low.min(from), high.max(to)]),
            (one, other) => one.or(other),
        };
    }

    /// Returns the setting of a range that is not empty.
    fn setting(&self, path: &str) -> Option<Setting> {
        let [low, high] = self.range.filter(|[low, high]| low < high)?;
        let setting = format!("{path}.color_by.range={}", json!([low, high]));
        let setting: Setting = setting.parse().ok()?;
        Some(setting.in_syntax(Syntax::Json))
    }
}
