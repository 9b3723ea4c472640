//! Geometries inside of others: their fields, their numbers, their paths, and the walks through all
//! of them.

use std::{iter::Enumerate, slice, sync::LazyLock};

use glam::DVec3;

use crate::{
    diagnostic::path::{Path, Step},
    scene::format::{
        geometry::{GeometryModel, placement::Placement},
        scene::Model,
        thing::{Thing, Type, Variant},
        transform::TransformModel,
    },
    tracer::shape::{Membership, Shape},
};

/// The number of a geometry in a scene. Ascending numbers are in the order of the file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Ordinal {
    /// The index in the scene's list of the geometry that it is or is in.
    pub(crate) index: usize,
    /// Its number among the geometries inside of that one, depth-first from 1; 0 for that one itself.
    pub(crate) inner: usize,
}

impl From<usize> for Ordinal {
    fn from(index: usize) -> Self {
        Self { index, inner: 0 }
    }
}

impl Ordinal {
    /// Returns the number of a geometry inside of this one, by its number there.
    pub(crate) const fn inside(self, number: usize) -> Self {
        Self {
            inner: self.inner + number,
            ..self
        }
    }
}

/// The geometries in a field of another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inside<'m> {
    pub(crate) field: &'static str,
    pub(crate) geometries: &'m [GeometryModel],
    /// True for a list, whose elements have an index; false for a field that is a geometry itself.
    pub(crate) is_list: bool,
}

impl<'m> Inside<'m> {
    /// The geometries of a list.
    pub(super) const fn list(field: &'static str, geometries: &'m [GeometryModel]) -> Self {
        Self {
            field,
            geometries,
            is_list: true,
        }
    }

    /// The geometry that a field is.
    pub(super) const fn single(field: &'static str, geometry: &'m GeometryModel) -> Self {
        Self {
            field,
            geometries: slice::from_ref(geometry),
            is_list: false,
        }
    }

    /// The steps from the geometry around it to one of those in the field.
    fn steps(&self, index: usize) -> impl Iterator<Item = Step> + use<> {
        let index = self.is_list.then_some(Step::Index(index));
        [Step::Field(self.field.into())].into_iter().chain(index)
    }
}

/// The names of fields with geometries, in any geometry.
pub(crate) static FIELD_NAMES: LazyLock<Vec<&str>> = LazyLock::new(|| {
    let is_geometry = |variant: &Variant| {
        let mut all = GeometryModel::VARIANTS.iter();
        all.any(|geometry| geometry.name == variant.name)
    };
    let fields = GeometryModel::of_type().fields();
    let fields = fields.filter(|field| match (field.of_type)().innermost() {
        Type::OneOf(one_of) => one_of.variants.iter().all(is_geometry),
        _ => false,
    });
    let mut names: Vec<_> = fields.map(|field| field.name).collect();
    names.dedup();
    names
});

impl GeometryModel {
    /// Returns the number of geometries that it is: itself and all inside of it.
    pub(crate) fn total(&self) -> usize {
        let inside = self.inside().flat_map(|inside| inside.geometries);
        1 + inside.map(Self::total).sum::<usize>()
    }

    /// Returns true if `is_it` does for this geometry or any inside of it.
    pub(crate) fn any_inside(&self, is_it: &impl Fn(&Self) -> bool) -> bool {
        let mut inside = self.inside().flat_map(|inside| inside.geometries);
        is_it(self) || inside.any(|geometry| geometry.any_inside(is_it))
    }

    /// Returns the geometries in its fields, in the order of the file.
    pub(crate) fn children(&self) -> impl Iterator<Item = Child<'_>> {
        let mut end = 1;
        let fields = self.inside().enumerate();
        let all = fields.flat_map(|(place, inside)| {
            let geometries = inside.geometries.iter().enumerate();
            geometries.map(move |(index, geometry)| (place, inside, index, geometry))
        });
        all.map(move |(place, inside, index, geometry)| {
            let number = end;
            end += geometry.total();
            Child {
                place,
                inside,
                index,
                geometry,
                number,
                end,
            }
        })
    }

    /// Returns the geometries that lead to one inside of this one, by its number, which is the last.
    fn line(&self, mut number: usize) -> Option<Vec<Child<'_>>> {
        let mut line: Vec<Child> = Vec::new();
        while number > 0 {
            let around = line.last().map_or(self, |child| child.geometry);
            let child = around.children().find(|child| number < child.end)?;
            number -= child.number;
            line.push(child);
        }
        Some(line)
    }
}

/// A geometry in a field of another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Child<'m> {
    /// The number of the field.
    place: usize,
    pub(crate) inside: Inside<'m>,
    /// The index in the field.
    pub(crate) index: usize,
    pub(crate) geometry: &'m GeometryModel,
    /// Its number among the geometries inside of the other.
    pub(crate) number: usize,
    /// The number behind those inside of it.
    end: usize,
}

impl Child<'_> {
    /// Returns the number of the steps that lead to it, if these do.
    fn is_on(&self, steps: &[Step]) -> Option<usize> {
        let count = match (self.inside.is_list, steps.get(1)) {
            (false, _) => 1,
            (true, Some(Step::Index(index))) if *index == self.index => 2,
            (true, _) => return None,
        };
        (steps.first()?.name() == Some(self.inside.field)).then_some(count)
    }
}

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

    /// Returns the meshes that are in files of their own.
    pub(crate) fn meshes_in_files(&self) -> Vec<Ordinal> {
        let all = self.walk();
        let all = all.filter(|(_, geometry)| geometry.mesh_file().is_some());
        all.map(|(at, _)| at).collect()
    }

    /// Drops the meshes that were read from files, and returns their number.
    pub(crate) fn forget_meshes(&mut self) -> usize {
        let mut forgotten = 0;
        for at in self.meshes_in_files() {
            let file = self.geometry_mut(at).and_then(GeometryModel::mesh_file_mut);
            forgotten += usize::from(file.is_some_and(|file| file.mesh.take().is_some()));
        }
        forgotten
    }

    /// Returns true if a geometry is one of those that a solid consists of.
    pub(crate) fn is_operand(&self, at: Ordinal) -> bool {
        let whole = self.geometries.get(at.index).filter(|_| at.inner > 0);
        let mut line = whole
            .and_then(|whole| whole.line(at.inner))
            .into_iter()
            .flatten();
        line.any(|child| child.inside.field != Self::LONG)
    }

    /// Returns a geometry by its number.
    pub(crate) fn geometry(&self, at: Ordinal) -> Option<&GeometryModel> {
        let whole = self.geometries.get(at.index)?;
        if at.inner == 0 {
            return Some(whole);
        }
        Some(whole.line(at.inner)?.pop()?.geometry)
    }

    /// Returns a geometry by its number, writable.
    pub(crate) fn geometry_mut(&mut self, at: Ordinal) -> Option<&mut GeometryModel> {
        let mut found = self.geometries.get_mut(at.index)?;
        if at.inner == 0 {
            return Some(found);
        }
        let line = found.line(at.inner)?.into_iter();
        for (place, index) in line
            .map(|child| (child.place, child.index))
            .collect::<Vec<_>>()
        {
            found = found.inside_mut().nth(place)?.get_mut(index)?;
        }
        Some(found)
    }

    /// Returns true if a geometry is inside of another.
    pub(crate) fn holds(&self, around: Ordinal, at: Ordinal) -> bool {
        let is_behind = around.index == at.index && around.inner < at.inner;
        is_behind
            && self
                .geometry(around)
                .is_some_and(|around_it| at.inner < around.inner + around_it.total())
    }

    /// Returns the path of a geometry.
    pub(crate) fn path_of(&self, at: Ordinal) -> Path {
        let path = Path::ROOT.field(Self::LONG).index(at.index);
        let whole = self.geometries.get(at.index).filter(|_| at.inner > 0);
        let line = whole.and_then(|whole| whole.line(at.inner));
        let steps = line.into_iter().flatten();
        let steps = steps.flat_map(|child| child.inside.steps(child.index));
        path.join(&steps.collect::<Vec<_>>())
    }

    /// Returns the transforms of a geometry and of those around it, from outermost to innermost.
    pub(crate) fn transforms(&self, at: Ordinal) -> Vec<&TransformModel> {
        let Some(whole) = self.geometries.get(at.index) else {
            return Vec::new();
        };
        let line = whole.line(at.inner).into_iter().flatten();
        let all = [whole].into_iter().chain(line.map(|child| child.geometry));
        all.filter_map(GeometryModel::transform).collect()
    }

    /// Returns the innermost geometry on a path, and the number of steps that lead to it; `None` if
    /// the path leads elsewhere.
    pub(crate) fn geometry_on(&self, path: &[Step]) -> Option<(Ordinal, usize)> {
        let [list, Step::Index(index), ..] = path else {
            return None;
        };
        if list.name() != Some(Self::LONG) {
            return None;
        }
        let (mut at, mut steps) = (Ordinal::from(*index), 2);
        let mut around = self.geometries.get(*index)?;
        while let Some((more, child)) = around.children().find_map(|child| {
            let more = child.is_on(path.get(steps..)?)?;
            Some((more, child))
        }) {
            at.inner += child.number;
            steps += more;
            around = child.geometry;
        }
        Some((at, steps))
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
    use crate::{scene::tests::oracle, text::syntax::Syntax};

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
