//! Geometries that others hide wholly: inside of a sphere or a box, or behind a plane.

use glam::DVec3;

use crate::{
    film::size::Size,
    scene::{
        animation::frames::Frames,
        format::{
            geometry::{GeometryModel, ordinal::Ordinal, walk::Leaf},
            scene::Model,
        },
        framing::Framing,
        validate::eye::is_glass,
    },
    tracer::{shape::Shape, shape::plane::Plane},
};

/// The number of geometries in which others are searched: the largest.
const MOST_COVERS: usize = 100;

/// The number of eyes, of all cameras in all frames.
const MOST_EYES: usize = 1000;

/// The part of a radius that a geometry must be below the surface, so that no ray can miss the surface
/// by rounding and hit the geometry.
const SLACK: f64 = 1e-3;

/// The distance of an eye, in radii, up to which that is certain.
const FAR: f64 = 1e4;

/// A geometry that may hide others.
#[derive(Clone, Copy)]
pub(super) struct Cover {
    pub(super) at: Ordinal,
    solid: Solid,
}

#[derive(Clone, Copy)]
enum Solid {
    Ball(DVec3, f64),
    Box([DVec3; 2]),
    /// All that lies on the other side of a plane than the eyes; its normal points to these.
    Behind(DVec3, DVec3),
}

/// The points in which the rays of a camera begin: an eye and those up to a distance around it.
#[derive(Clone, Copy)]
struct Eye {
    point: DVec3,
    reach: f64,
}

impl Cover {
    /// Returns the cover of a leaf, if it is an opaque sphere, box or plane that is not placed.
    fn of(leaf: &Leaf, model: &Model, eyes: &[Eye]) -> Option<Self> {
        let solid = match leaf.geometry {
            GeometryModel::Sphere(sphere) => Solid::Ball(sphere.center.into(), sphere.radius),
            GeometryModel::Box(cuboid) => Solid::Box([cuboid.min.into(), cuboid.max.into()]),
            GeometryModel::Plane(_) => Solid::behind(leaf.shape()?.plane()?, eyes)?,
            _ => return None,
        };
        let is_free = |eye: &Eye| solid.is_beyond(eye);
        let is_placed = leaf.shape()?.transform().is_some();
        let is_cover = !is_placed && eyes.iter().all(is_free) && !is_glass(leaf.geometry, model);
        is_cover.then_some(Self { at: leaf.at, solid })
    }

    /// The name of the place of what is hidden.
    pub(super) const fn place(&self) -> &'static str {
        match self.solid {
            Solid::Ball(..) => "inside of a sphere",
            Solid::Box(_) => "inside of a box",
            Solid::Behind(..) => "behind a plane",
        }
    }
}

impl Solid {
    fn behind(plane: &Plane, eyes: &[Eye]) -> Option<Self> {
        let (point, normal) = (plane.point(), plane.normal());
        let height = (eyes.first()?.point - point).dot(normal);
        Some(Self::Behind(point, normal * height.signum()))
    }

    /// The radius of a ball around it.
    fn radius(&self) -> f64 {
        match self {
            Self::Ball(_, radius) => *radius,
            Self::Box([low, high]) => (*high - *low).length() * 0.5,
            Self::Behind(..) => f64::INFINITY,
        }
    }

    /// Returns true if no ray of an eye begins inside.
    fn is_beyond(&self, eye: &Eye) -> bool {
        let away = match self {
            Self::Ball(center, radius) => (eye.point - *center).length() - radius,
            Self::Box([low, high]) => (eye.point - eye.point.clamp(*low, *high)).length(),
            Self::Behind(point, normal) => {
                let from = eye.point - *point;
                return from.dot(*normal) > eye.reach + SLACK * (eye.reach + from.length());
            }
        };
        let radius = self.radius();
        away > eye.reach + SLACK * (eye.reach + radius) && away + eye.reach < FAR * radius
    }

    /// Returns true if a shape surely lies inside.
    fn holds(&self, shape: &Shape) -> bool {
        let slack = SLACK * self.radius();
        match self {
            Self::Ball(center, radius) => shape.farthest_from(*center) < radius - slack,
            Self::Box([low, high]) => shape.bounds().is_some_and(|[least, most]| {
                least.cmpgt(*low + slack).all() && most.cmplt(*high - slack).all()
            }),
            Self::Behind(point, normal) => shape.bounds().is_some_and(|[least, most]| {
                let nearest = DVec3::select(normal.cmpgt(DVec3::ZERO), most, least) - *point;
                let size = nearest.length() + (most - least).length();
                nearest.dot(*normal) < -SLACK * size
            }),
        }
    }
}

/// Returns the geometries that lie inside of others that hide them from every camera in every frame, with
/// these. Rows of tables, parts and copies are not looked at.
pub(super) fn enclosed(model: &Model, framing: &Framing) -> Vec<(Ordinal, Cover)> {
    let Some(eyes) = eyes(model, framing) else {
        return Vec::new();
    };
    let leaves = || {
        let leaves = model.leaves().take_while(|_| !framing.is_cancelled());
        leaves.filter(|leaf| !framing.moves(model, leaf.at))
    };
    let mut covers: Vec<_> = leaves()
        .filter_map(|leaf| Cover::of(&leaf, model, &eyes))
        .collect();
    covers.sort_by(|one, other| other.solid.radius().total_cmp(&one.solid.radius()));
    covers.truncate(MOST_COVERS);
    let hidden = leaves().filter_map(|leaf| {
        let shape = leaf.shape()?;
        let cover = covers.iter().find(|cover| cover.solid.holds(&shape))?;
        Some((leaf.at, *cover))
    });
    hidden.collect()
}

/// Returns the eyes of all cameras in all frames; `None` if a camera is invalid, or if they are too many.
fn eyes(model: &Model, framing: &Framing) -> Option<Vec<Eye>> {
    let frames = framing.frames;
    let cameras = model.all_cameras().count();
    let is_long = |frames: &Frames| cameras.saturating_mul(frames.count() as usize) > MOST_EYES;
    if frames.is_some_and(is_long) {
        return None;
    }
    let mut all = Some(Vec::new());
    Frames::each(frames, model, |number, cameras, _| {
        let eyes = cameras.all_cameras().map(|(_, camera)| {
            let size @ (width, height) = cameras.sides();
            let camera = framing.build(camera, size, number).ok()?;
            let size = Size::new(width, height).ok()?;
            let (right, top) = (f64::from(size.width()), f64::from(size.height()));
            let point = camera.eye();
            let corners = [(0.0, 0.0), (right, 0.0), (right, top), (0.0, top)];
            let away = corners.map(|(x, y)| {
                let ray = camera.ray_for(size.width(), size.height(), x, y);
                (ray.origin() - point).length()
            });
            let reach = away.into_iter().fold(0.0, f64::max);
            Some(Eye { point, reach })
        });
        let eyes = eyes.collect::<Option<Vec<_>>>();
        all = all.take().zip(eyes).map(|(all, eyes)| [all, eyes].concat());
        all.is_some() && !framing.is_cancelled()
    });
    all
}
