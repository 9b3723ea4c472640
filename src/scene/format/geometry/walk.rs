//! The walks through all geometries of a scene.

use std::{iter::Enumerate, slice};

use glam::DVec3;

use crate::{
    scene::format::{
        geometry::{GeometryModel, ordinal::Ordinal, placement::Placement},
        scene::Model,
    },
    tracer::shape::{Membership, Shape},
};

impl Model {
    /// Returns every geometry, with those inside of others, in the order of the file.
    pub(crate) fn walk(&self) -> Walk<'_> {
        Walk::new(&self.geometries)
    }

    /// Returns every geometry that is one of the world or names a file of such, in the order of the
    /// file: all but groups, and the geometries that a solid consists of.
    pub(crate) fn leaves(&self) -> Leaves<'_> {
        Leaves(self.walk())
    }

    /// Returns the leaves that a geometry is or holds, in its own space.
    pub(crate) fn leaves_in(&self, around: Ordinal) -> impl Iterator<Item = Leaf<'_>> {
        let list = self.geometry(around).map_or(&[][..], slice::from_ref);
        Leaves(Walk::new(list)).map(move |mut leaf| {
            leaf.at.index = around.index;
            leaf.at.inner += around.inner;
            leaf
        })
    }

    /// Returns a leaf by its number.
    pub(crate) fn leaf(&self, at: Ordinal) -> Option<Leaf<'_>> {
        let mut geometry = self.geometries.get(at.index)?;
        let mut placement = Placement::default().within(geometry.transform());
        for child in geometry.line(at.inner)? {
            geometry = child.geometry;
            placement = placement.within(geometry.transform());
        }
        Some(Leaf::new(at, geometry, placement))
    }
}

/// A geometry of the world, or one that names a file of such.
#[derive(Clone, Debug)]
pub(crate) struct Leaf<'m> {
    pub(crate) at: Ordinal,
    pub(crate) geometry: &'m GeometryModel,
    /// That of the groups around it and its own.
    pub(crate) placement: Placement,
}

impl<'m> Leaf<'m> {
    #[inline]
    const fn new(at: Ordinal, geometry: &'m GeometryModel, placement: Placement) -> Self {
        Self {
            at,
            geometry,
            placement,
        }
    }

    /// Returns the shape in the scene, if it is a valid one; `None` for a table and a part.
    #[inline]
    pub(crate) fn shape(&self) -> Option<Shape> {
        self.placement.place(self.geometry.shape()?).ok()
    }

    /// Returns the position of an eye relative to the shape; `None` without one.
    #[inline]
    pub(crate) fn membership(&self, eye: DVec3) -> Option<Membership> {
        match self.placement.transform() {
            Ok(None) => self.geometry.membership(eye),
            _ => Some(self.shape()?.membership(eye)),
        }
    }
}

/// All geometries of a list, each before those inside of it. What a step needs where no geometry is
/// inside of another stays in registers: the rest is moved, never referred to.
#[derive(Clone, Debug)]
pub(crate) struct Walk<'m> {
    list: Enumerate<slice::Iter<'m, GeometryModel>>,
    /// The rest of what is inside of the last geometry of the list.
    inside: Option<Box<Descent<'m>>>,
}

impl<'m> Walk<'m> {
    fn new(list: &'m [GeometryModel]) -> Self {
        Self {
            list: list.iter().enumerate(),
            inside: None,
        }
    }
}

impl<'m> Iterator for Walk<'m> {
    type Item = (Ordinal, &'m GeometryModel);

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        if let Some(descent) = self.inside.take() {
            let (next, rest) = descent.next_inside();
            self.inside = rest;
            if next.is_some() {
                return next;
            }
        }
        let (index, geometry) = self.list.next()?;
        if !geometry.is_single() {
            self.inside = Some(Descent::into(geometry, index));
        }
        Some((index.into(), geometry))
    }
}

/// The leaves of a list of geometries.
#[derive(Clone, Debug)]
pub(crate) struct Leaves<'m>(Walk<'m>);

impl<'m> Iterator for Leaves<'m> {
    type Item = Leaf<'m>;

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(descent) = self.0.inside.take() {
                let (next, rest) = descent.next_leaf();
                self.0.inside = rest;
                if next.is_some() {
                    return next;
                }
            }
            let (index, geometry) = self.0.list.next()?;
            if geometry.group().is_none() {
                let placement = Placement::default().within(geometry.transform());
                return Some(Leaf::new(index.into(), geometry, placement));
            }
            self.0.inside = Some(Descent::into(geometry, index));
        }
    }
}

/// The descent through what is inside of a geometry.
#[derive(Clone, Debug)]
struct Descent<'m> {
    levels: Vec<Level<'m>>,
    at: Ordinal,
}

/// The geometries that follow on a level, and their placement.
#[derive(Clone, Debug)]
struct Level<'m> {
    geometries: slice::Iter<'m, GeometryModel>,
    placement: Placement,
}

/// What comes next in a descent, and the rest of it.
type Next<'m, T> = (Option<T>, Option<Box<Descent<'m>>>);

impl<'m> Descent<'m> {
    #[cold]
    fn into(geometry: &'m GeometryModel, index: usize) -> Box<Self> {
        let mut descent = Self {
            levels: Vec::new(),
            at: index.into(),
        };
        descent.enter(geometry);
        Box::new(descent)
    }

    /// Steps into a geometry.
    fn enter(&mut self, geometry: &'m GeometryModel) {
        let placement = self.placement().within(geometry.transform());
        let inside = geometry.inside().rev();
        let levels = inside.map(|inside| Level {
            geometries: inside.geometries.iter(),
            placement: placement.clone(),
        });
        self.levels.extend(levels);
    }

    /// The placement of the geometry after the last step.
    fn placement(&self) -> Placement {
        let level = self.levels.last();
        level.map_or_else(Placement::default, |level| level.placement.clone())
    }

    /// Returns the next geometry, without a step into it.
    fn step(&mut self) -> Option<&'m GeometryModel> {
        while let Some(level) = self.levels.last_mut() {
            if let Some(geometry) = level.geometries.next() {
                self.at.inner += 1;
                return Some(geometry);
            }
            self.levels.pop();
        }
        None
    }

    #[cold]
    fn next_inside(mut self: Box<Self>) -> Next<'m, (Ordinal, &'m GeometryModel)> {
        let Some(geometry) = self.step() else {
            return (None, None);
        };
        let at = self.at;
        self.enter(geometry);
        (Some((at, geometry)), Some(self))
    }

    #[cold]
    fn next_leaf(mut self: Box<Self>) -> Next<'m, Leaf<'m>> {
        while let Some(geometry) = self.step() {
            if geometry.group().is_some() {
                self.enter(geometry);
                continue;
            }
            let leaf = Leaf::new(
                self.at,
                geometry,
                self.placement().within(geometry.transform()),
            );
            self.at.inner += geometry.total() - 1;
            return (Some(leaf), Some(self));
        }
        (None, None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{diagnostic::path::Path, scene::tests::oracle, text::syntax::Syntax};

    const TEXT: &str = r#"(camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 1), geometries: [
        Sphere(center: (0, 0, 0), radius: 1, name: "a"),
        Group(name: "b", geometries: [
            Sphere(center: (0, 0, 0), radius: 1, name: "c"),
            Group(name: "d", geometries: []),
            Group(name: "e", geometries: [Sphere(center: (0, 0, 0), radius: 1, name: "f")]),
            Sphere(center: (0, 0, 0), radius: 1, name: "g"),
        ]),
        Sphere(center: (0, 0, 0), radius: 1, name: "h"),
    ])"#;

    #[test]
    fn numbers_paths_and_walks_agree() {
        let mut model = oracle::model(TEXT, Syntax::Ron).unwrap();
        let name = |geometry: &GeometryModel| geometry.name().unwrap().to_owned();
        let found: Vec<_> = model.walk().collect();
        let names: String = found.iter().map(|(_, geometry)| name(geometry)).collect();
        assert_eq!(names, "abcdefgh");
        assert!(found.is_sorted_by_key(|(at, _)| *at));
        let paths: Vec<_> = found.iter().map(|(at, _)| model.path_of(*at)).collect();
        let inner = "geometries[1].geometries[2].geometries[0]";
        assert_eq!(paths[5].to_string(), inner);
        for ((at, geometry), path) in found.iter().zip(&paths) {
            assert_eq!(model.geometry(*at), Some(*geometry));
            let radius = path.field("radius");
            let steps = path.steps().len();
            assert_eq!(model.geometry_on(radius.steps()), Some((*at, steps)));
        }
        let leaves = model.leaves().map(|leaf| {
            assert_eq!(model.geometry(leaf.at), Some(leaf.geometry));
            name(leaf.geometry)
        });
        assert_eq!(leaves.collect::<String>(), "acfgh");
        for at in found.iter().map(|(at, _)| *at).collect::<Vec<_>>() {
            let expected = model.geometry(at).map(name);
            assert_eq!(model.geometry_mut(at).map(|found| name(found)), expected);
        }
        let nowhere = Ordinal { index: 1, inner: 6 };
        assert_eq!(
            (model.geometry(nowhere), model.geometries[1].total()),
            (None, 6)
        );
        let nowhere = Path::ROOT.field("geometries").index(3);
        assert_eq!(model.geometry_on(nowhere.steps()), None);
    }
}
