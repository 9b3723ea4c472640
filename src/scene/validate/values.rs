//! Checks of colors by value.

use super::Found;
use crate::{
    diagnostic::{Code, path::Path},
    scene::{
        format::{
            color_by::{ColorByModel, ColormapModel},
            geometry::{GeometryModel, nesting::Ordinal},
            scene::Model,
            thing::Thing,
        },
        problem::{Focus, Problem},
        validate::material::both,
    },
};

impl Found {
    /// Checks the colors by value of a geometry, if it has them.
    #[inline]
    pub(super) fn color_by(&mut self, geometry: &GeometryModel, at: Ordinal, model: &Model) {
        if let Some(by) = geometry.color_by() {
            self.values(geometry, by, model.path_of(at));
        }
    }

    fn values(&mut self, geometry: &GeometryModel, by: &ColorByModel, geometry_path: Path) {
        let path = || geometry_path.clone().field("color_by");
        if geometry.surface().color.is_some() {
            let problem = both(Code::OneOf, &geometry_path, ["color", "color_by"]);
            self.push(problem.help("values have colors of their own; leave one of them out"));
        }
        by.each(|field, value| self.field(field, value, path));
        if let Some(ColormapModel::Colors(colors)) = &by.map {
            if colors.len() < 2 {
                let count = colors.len();
                let message = format!("expected at least 2 colors, found {count}");
                let path = path().field("map");
                self.push(Problem::new(Code::WrongType, path, Focus::Content, message));
            }
            for (index, color) in colors.iter().enumerate() {
                self.color(color, || path().field("map").index(index));
            }
        }
    }
}
