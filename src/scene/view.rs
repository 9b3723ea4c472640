//! Conservative test for geometries outside of a camera's view.

use glam::DVec3;

use crate::{
    data::table::Table,
    film::size::Size,
    scene::{
        format::geometry::{placement::Placement, walk::Leaf},
        tables::{Content, Tables},
    },
    tracer::{
        camera::Camera,
        shape::{Extent, Shape, plane::Plane},
        vector::unit,
    },
};

/// The relative distance by which a sphere must be outside before this is certain despite
/// rounding.
const SLACK: f64 = 1e-9;

/// The growth of a squared radius, in units of the squared distance of the sphere: a ray hits
/// everything that its equation cannot distinguish from a hit, as derived for `Screen::inflation`
/// of `accel`.
const INFLATION: f64 = 1e-13;

/// Squared lengths beyond this, or below its reciprocal, may overflow in that equation.
const HUGE: f64 = 1e200;

/// The smallest forward part of a direction that is scaled to a depth.
const LEAST_DEPTH: f64 = 1e-9;

/// The space that a camera sees: in front of the eye plane and between the outermost rays, those
/// through the outer edges of the outermost pixels.
pub(crate) struct ViewSpace {
    /// Points `p` in the view satisfy `(p - origin)·normal >= 0` for all of these.
    sides: Vec<Side>,
    /// The four corner rays as (origin, direction); all others are means of them.
    corners: [(DVec3, DVec3); 4],
    /// The largest distance between the origins of two rays.
    reach: f64,
}

/// A plane with everything visible on one side.
struct Side {
    origin: DVec3,
    normal: DVec3,
    /// The uncertainty of the normal, in units of the distance from the origin.
    doubt: f64,
}

impl Side {
    fn new(origin: DVec3, normal: DVec3) -> Self {
        let doubt = SLACK;
        Self {
            origin,
            normal,
            doubt,
        }
    }

    /// Creates the side with the normal `one × other`; if these are nearly parallel, it is
    /// uncertain. `error` is the length that their rounding is relative to.
    fn between(origin: DVec3, one: DVec3, other: DVec3, error: f64) -> Self {
        let normal = one.cross(other);
        let doubt = SLACK + 32.0 * f64::EPSILON * error / normal.length();
        Self {
            origin,
            normal: unit(normal),
            doubt,
        }
    }
}

impl ViewSpace {
    /// Returns the view of a camera in a picture of this size; `None` if the size is invalid, or if
    /// the angle is too wide for certainty.
    pub(crate) fn of(camera: &Camera, (width, height): (u32, u32)) -> Option<Self> {
        let size = Size::new(width, height).ok()?;
        let (right, top) = (
            f64::from(size.width()) - 0.5,
            f64::from(size.height()) - 0.5,
        );
        // Counterclockwise as seen by the viewer, from the bottom left.
        let corners = [(-0.5, -0.5), (right, -0.5), (right, top), (-0.5, top)].map(|(x, y)| {
            let ray = camera.ray_for(size.width(), size.height(), x, y);
            // Scaled to the same depth, so that every ray between them is a mean of them.
            let depth = -ray.direction().dot(camera.w());
            (ray.origin(), ray.direction() / depth)
        });
        if corners
            .iter()
            .any(|(_, direction)| direction.length() > 1.0 / LEAST_DEPTH)
        {
            return None;
        }
        let mut sides = vec![Side::new(camera.eye(), -camera.w())];
        for (index, (origin, direction)) in corners.into_iter().enumerate() {
            let (next_origin, next_direction) = corners[(index + 1) % 4];
            sides.push(match camera {
                Camera::Perspective(_) => {
                    let error = direction.length() * next_direction.length();
                    Side::between(origin, next_direction, direction, error)
                }
                Camera::Orthographic(_) => {
                    let error = origin.length() + next_origin.length();
                    Side::between(origin, camera.w(), next_origin - origin, error)
                }
            });
        }
        let reach = (corners[2].0 - corners[0].0).length();
        Some(Self {
            sides,
            corners,
            reach,
        })
    }

    /// Returns true if certainly no ray hits a leaf of the scene: none of those in the table or the
    /// part that it names.
    pub(crate) fn certainly_misses(&self, leaf: &Leaf, tables: &Tables) -> bool {
        match leaf.shape() {
            Some(shape) => self.misses(&shape),
            None => match tables.get(leaf.at) {
                None => false,
                Some(Content::Table(table, _)) => self.misses_table(table, &leaf.placement),
                Some(_) => !tables.any_shape(leaf, |shape| !self.misses(shape)),
            },
        }
    }

    /// Returns true if certainly no ray hits a row of a table. An invalid one may be hit: it has its own
    /// diagnostic.
    fn misses_table(&self, table: &Table, placement: &Placement) -> bool {
        !table.any_row(|row| {
            let shape = row.shape.and_then(|shape| placement.place(shape));
            !shape.is_ok_and(|shape| self.misses(&shape))
        })
    }

    fn misses(&self, shape: &Shape) -> bool {
        match shape.extent() {
            Extent::Ball(center, radius) => self.misses_sphere(center, radius),
            Extent::Plane(plane) => self.misses_plane(plane),
        }
    }

    fn misses_plane(&self, plane: &Plane) -> bool {
        // t = ((a - o)·n)/(d·n) must be above 0 for some ray; both products are linear along the
        // edges of the view, so the corners decide.
        let (point, normal) = (plane.point(), plane.normal());
        let sides = self.corners.map(|(origin, direction)| {
            let slack = SLACK * (point.length() + origin.length()) * normal.length();
            let distance = (point - origin).dot(normal);
            let speed = direction.dot(normal);
            let speed_slack = SLACK * direction.length() * normal.length();
            if distance > slack && speed < -speed_slack {
                Some(true)
            } else if distance < -slack && speed > speed_slack {
                Some(false)
            } else {
                None
            }
        });
        sides[0].is_some() && sides.iter().all(|side| *side == sides[0])
    }

    fn misses_sphere(&self, center: DVec3, radius: f64) -> bool {
        // An invalid radius has its own diagnostic.
        radius > 0.0
            && self.sides.iter().any(|side| {
                let from_side = center - side.origin;
                let distance = from_side.length() + self.reach;
                let scale = (distance * distance).max(radius * radius);
                let grown = (radius * radius + INFLATION * scale).sqrt();
                let slack = side.doubt * (distance + radius + side.origin.length());
                // False if the numbers overflow.
                (1.0 / HUGE..HUGE).contains(&scale) && from_side.dot(side.normal) + grown < -slack
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::format::{
        camera::CameraModel,
        color::ColorModel,
        geometry::{GeometryModel, ordinal::Ordinal, plane::PlaneModel, sphere::SphereModel},
        image::ImageModel,
        orthographic::OrthographicModel,
        perspective::PerspectiveModel,
        rare::Rare,
    };

    const WHITE: ColorModel = ColorModel::Hex([255; 3]);

    fn view(camera: CameraModel) -> ViewSpace {
        ViewSpace::of(&camera.build().unwrap(), ImageModel::default().sides()).unwrap()
    }

    fn perspective() -> ViewSpace {
        view(CameraModel::Perspective(PerspectiveModel {
            eye: [0.0; 3],
            gaze: Some([0.0, 0.0, -1.0]),
            look_at: None,
            up: None,
            fov: 90.0,
            aperture: None,
            focus: None,
            focus_at: None,
        }))
    }

    fn orthographic() -> ViewSpace {
        view(CameraModel::Orthographic(OrthographicModel {
            eye: [0.0; 3],
            gaze: Some([0.0, 0.0, -1.0]),
            look_at: None,
            up: None,
            scale: 3.0,
            stretch: None,
        }))
    }

    fn leaf(geometry: &GeometryModel) -> Leaf<'_> {
        Leaf {
            at: Ordinal::default(),
            geometry,
            placement: Placement::default(),
        }
    }

    fn misses(view: &ViewSpace, center: [f64; 3], radius: f64) -> bool {
        let sphere = GeometryModel::Sphere(SphereModel {
            center,
            radius,
            color: Some(WHITE),
            material: None,
            rare: Rare::default(),
            name: None,
        });
        view.certainly_misses(&leaf(&sphere), &Tables::default())
    }

    fn misses_plane(view: &ViewSpace, point: [f64; 3], normal: [f64; 3]) -> bool {
        let plane = GeometryModel::Plane(Box::new(PlaneModel {
            point,
            normal,
            color: Some(WHITE),
            texture: None,
            material: None,
            transform: None,
            name: None,
        }));
        view.certainly_misses(&leaf(&plane), &Tables::default())
    }

    #[test]
    fn spheres_behind_and_beside_a_perspective_view() {
        let view = perspective();
        assert!(!misses(&view, [0.0, 0.0, -3.0], 0.5), "ahead");
        assert!(misses(&view, [0.0, 0.0, 3.0], 0.5), "behind");
        assert!(!misses(&view, [0.0, 0.0, 0.4], 0.5), "around the eye");
        // The picture is 4:3 and its half angle is 45 degrees upwards.
        assert!(misses(&view, [0.0, 5.0, -3.0], 0.5), "above");
        assert!(misses(&view, [0.0, -5.0, -3.0], 0.5), "below");
        assert!(
            !misses(&view, [0.0, 3.5, -3.0], 0.5),
            "across the upper edge"
        );
        assert!(!misses(&view, [3.9, 0.0, -3.0], 0.1), "at the right edge");
        assert!(misses(&view, [5.0, 0.0, -3.0], 0.5), "to the right");
        assert!(misses(&view, [-5.0, 0.0, -3.0], 0.5), "to the left");
    }

    #[test]
    fn spheres_behind_and_beside_an_orthographic_view() {
        let view = orthographic();
        assert!(!misses(&view, [1.9, 1.4, -3.0], 0.1), "in the corner");
        assert!(misses(&view, [2.5, 0.0, -3.0], 0.1), "to the right");
        assert!(misses(&view, [-2.5, 0.0, -3.0], 0.1), "to the left");
        assert!(misses(&view, [0.0, 1.9, -3.0], 0.1), "above");
        assert!(misses(&view, [0.0, -1.9, -3.0], 0.1), "below");
        assert!(misses(&view, [0.0, 0.0, 3.0], 0.1), "behind");
    }

    #[test]
    fn planes() {
        let view = perspective();
        assert!(
            !misses_plane(&view, [0.0, -1.0, 0.0], [0.0, 1.0, 0.0]),
            "a floor"
        );
        assert!(
            !misses_plane(&view, [0.0, 0.0, -9.0], [0.0, 0.0, 1.0]),
            "a wall ahead"
        );
        assert!(
            !misses_plane(&view, [0.0, 0.0, -9.0], [0.0, 0.0, -1.0]),
            "a wall from behind"
        );
        assert!(
            misses_plane(&view, [0.0, 0.0, 9.0], [0.0, 0.0, 1.0]),
            "a wall behind"
        );
        assert!(
            misses_plane(&view, [0.0, 0.0, 9.0], [0.0, 0.5, -1.0]),
            "a leaning wall behind"
        );
        let view = orthographic();
        assert!(
            misses_plane(&view, [0.0, 0.0, 9.0], [0.0, 0.0, 1.0]),
            "a wall behind"
        );
        assert!(
            !misses_plane(&view, [0.0, 0.0, 1.0], [0.0, 1.0, 1.0]),
            "a slope through the view"
        );
    }
}
