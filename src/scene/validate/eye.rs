//! Checks for geometries that hide everything else from a camera.

use glam::DVec3;

use crate::{
    data::table::Row,
    diagnostic::{Code, path::Path},
    scene::{
        format::{
            geometry::{GeometryModel, walk::Leaf},
            material::Surface,
            scene::Model,
        },
        problem::{Focus, Problem},
        tables::Tables,
        validate::{camera::Eye, found::Found},
    },
    text::nearest::quote,
    tracer::{
        geometry::Geometry,
        shape::{Membership, Shape},
    },
};

impl Eye<'_> {
    fn name(&self) -> String {
        match self.camera {
            None => "the eye of the camera".to_owned(),
            Some(name) => format!("the eye of the camera {}", quote(name)),
        }
    }
}

impl Found {
    /// Reports a geometry that blocks an eye.
    #[inline(always)]
    pub(super) fn eye(&mut self, eye: &Eye, leaf: &Leaf, surroundings: &mut Surroundings) {
        let membership = leaf.membership(eye.point);
        // Almost all of a million.
        if !matches!(membership, Some(Membership::Outside)) {
            self.blocked(eye, (leaf, membership), surroundings);
        }
    }

    /// Reports a geometry that blocks an eye, given the position of the eye relative to it.
    #[inline(never)]
    fn blocked(
        &mut self,
        eye: &Eye,
        (leaf, membership): (&Leaf, Option<Membership>),
        surroundings: &mut Surroundings,
    ) {
        let (model, tables) = (surroundings.model, surroundings.tables);
        let mut hides = |center: DVec3, radius: f64| {
            (eye.point - center).length() < radius && surroundings.reach_beyond(center, radius)
        };
        let is_lit = self.is_lit;
        let is_clear = || is_lit && is_glass(leaf.geometry, model);
        let place = || model.path_of(leaf.at);
        match membership {
            Some(Membership::Outside) => {}
            Some(Membership::Inside(center, radius)) => {
                let is_blocked = hides(center, radius) && !is_clear();
                if let Some(shape) = leaf.shape().filter(|_| is_blocked) {
                    let what = format!("this {}", shape.kind());
                    self.eye_inside(eye, place(), &what, shape.kind());
                }
            }
            Some(Membership::EdgeOn(what)) => self.eye_on_plane(eye, place(), what),
            None => {
                if let Some(content) = tables.get(leaf.at)
                    && let Ok(all) = content.geometries(&leaf.placement)
                {
                    let are_copies = leaf.geometry.copies().is_some();
                    self.eye_among(eye, &all, are_copies, &place(), &mut hides);
                }
                let Ok(transform) = leaf.placement.transform() else {
                    return;
                };
                let mut first = None;
                // Reported once per table.
                let has_one = |row: Row| {
                    let shape = row.shape.and_then(|shape| leaf.placement.place(shape));
                    let Ok(shape) = shape else { return false };
                    if let Membership::Inside(center, radius) = shape.membership(eye.point)
                        && hides(center, radius)
                    {
                        first = Some((row.index, shape.kind()));
                    }
                    first.is_some()
                };
                let table = tables.of(leaf.at).filter(|table| match transform {
                    None => table.may_enclose(eye.point),
                    Some(transform) => table.may_enclose(transform.point_back(eye.point)),
                });
                table.map(|table| table.any_row(has_one));
                if let Some((row, kind)) = first.filter(|_| !is_clear()) {
                    let what = format!("the {kind} of row {row}");
                    self.eye_inside(eye, place(), &what, kind);
                }
            }
        }
    }

    /// Reports the first geometry of a part, or the copies, that blocks an eye, in each way.
    fn eye_among(
        &mut self,
        eye: &Eye,
        geometries: &[Geometry],
        are_copies: bool,
        place: &Path,
        mut hides: impl FnMut(DVec3, f64) -> bool,
    ) {
        let (mut inside, mut edge_on) = (None, None);
        for geometry in geometries {
            let is_clear = self.is_lit && geometry.has_glass();
            match geometry.shape().membership(eye.point) {
                Membership::Inside(center, radius) if inside.is_none() && hides(center, radius) => {
                    inside = (!is_clear).then(|| geometry.shape().kind_of_one());
                }
                Membership::EdgeOn(what) => edge_on = edge_on.or(Some(what)),
                Membership::Inside(..) | Membership::Outside => {}
            }
        }
        if let Some(kind) = inside {
            let (what, kind) = match are_copies {
                true => ("one of these copies", "copy"),
                false => (&*format!("a {kind} of this part"), kind),
            };
            self.eye_inside(eye, place.clone(), what, kind);
        }
        if let Some(what) = edge_on {
            let what = format!("{what} in this part");
            self.eye_on_plane(eye, place.clone(), &what);
        }
    }

    fn eye_inside(&mut self, eye: &Eye, path: Path, what: &str, kind: &str) {
        let message = format!("{} is inside {what}", eye.name());
        let problem = Problem::new(Code::EyeInside, path, Focus::Name, message);
        self.push(problem.help(format!("nothing outside the {kind} is visible")));
    }

    fn eye_on_plane(&mut self, eye: &Eye, path: Path, plane: &str) {
        let eye = eye.name();
        let message = format!("{eye} is exactly on {plane}, which hides it");
        let problem = Problem::new(Code::EyeOnPlane, path, Focus::Name, message);
        self.push(problem.help("move the eye or the plane, even if only a little"));
    }
}

/// Returns true if people look through a geometry in a lit scene.
pub(super) fn is_glass(geometry: &GeometryModel, model: &Model) -> bool {
    geometry.surfaces().iter().any(is_of_glass(model))
}

/// Returns whether a surface is of glass.
pub(super) fn is_of_glass(model: &Model) -> impl Fn(&Surface) -> bool {
    move |surface| {
        let own = surface.material;
        let material = own.and_then(|material| material.resolve(model.materials.as_ref()));
        material.is_some_and(|material| material.is_glass())
    }
}

/// The geometries around a sphere with the eye inside; nothing is computed before it is needed.
pub(crate) struct Surroundings<'a> {
    model: &'a Model,
    tables: &'a Tables,
    /// The largest radius of the balls that enclose the shapes; infinite if a shape is unbounded.
    largest: Option<f64>,
    /// The last of the largest spheres, and the result for it.
    last: Option<(DVec3, bool)>,
}

impl<'a> Surroundings<'a> {
    /// Creates the search among a scene's geometries and the tables and parts that they name.
    pub(crate) fn new(model: &'a Model, tables: &'a Tables) -> Self {
        Self {
            model,
            tables,
            largest: None,
            last: None,
        }
    }

    fn largest(&mut self) -> f64 {
        if let Some(largest) = self.largest {
            return largest;
        }
        let mut largest = 0.0;
        self.tables.any_shape_of(self.model, |shape| {
            largest = f64::max(largest, shape.extent().radius());
            false
        });
        self.largest = Some(largest);
        largest
    }

    /// Returns true if a geometry lies wholly or partly outside of the sphere.
    pub(crate) fn reach_beyond(&mut self, center: DVec3, radius: f64) -> bool {
        // A larger sphere cannot lie inside of a smaller one, so only the largest are tested
        // against all others; the result for one holds for those equal to it.
        if radius < self.largest() {
            return true;
        }
        match self.last {
            Some((other, beyond)) if other == center => beyond,
            _ => {
                let is_beyond = |shape: &Shape| shape.farthest_from(center) > radius;
                let beyond = self.tables.any_shape_of(self.model, is_beyond);
                self.last = Some((center, beyond));
                beyond
            }
        }
    }
}
