//! Edits of a text that move a camera or a geometry. Comments and layout stay.

use std::collections::BTreeSet;

use glam::DVec3;

use crate::{
    diagnostic::error::Error,
    pipeline::Scene,
    scene::{
        format::{field::FieldKind, geometry::GeometryModel},
        origin::Origin,
    },
    session::{
        camera::Motion,
        checked::Checked,
        rewrite::Rewrite,
        view::{View, pivot},
    },
    text::edit::Edit,
    tracer::{camera::Camera, vector::unit},
};

/// The fraction of a length below which a change of it is not worth a digit.
const NOTICED: f64 = 1e-4;
/// The fraction of a pixel below which a shift is not worth a digit.
const OF_A_PIXEL: f64 = 0.1;

impl Checked {
    /// Returns the edits that write the movement of a view into its camera.
    ///
    /// # Errors
    ///
    /// A text with errors, and a camera whose numbers are not those of the text because an
    /// animation or a setting changes them.
    pub fn move_camera(&self, view: &View) -> Result<Vec<Edit>, Error> {
        let scene = self.current()?;
        let before = view.before_motion(scene)?;
        let camera = *before.camera();
        let pivot = pivot(&before);
        let moved = view.motion.of(&camera, pivot);
        let (moved, after) = moved.map_err(|error| Error::refused(error.to_string()))?;
        let path = view.path_of_camera(scene);
        let distance = (moved.eye() - after).length();
        let mut rewrite = Rewrite::new(&self.document);
        if before.is_framed() {
            let Motion { pan, dolly, .. } = view.motion;
            if pan != [0.0; 2] || dolly != 0.0 {
                return Err(Error::refused(
                    "the camera is a `Fit`, which frames all geometries and can only turn; \
                     `strahl convert --explicit-camera` gives it an eye",
                ));
            }
            let (from, turned) = (-camera.gaze(), -moved.gaze());
            rewrite.vector(&path.field("from"), from, turned, from.length() * NOTICED)?;
            return Ok(rewrite.edits);
        }
        rewrite.vector(
            &path.field("eye"),
            camera.eye(),
            moved.eye(),
            distance * NOTICED,
        )?;
        match before.target() {
            Some(target) => {
                let point = target + (after - pivot);
                rewrite.vector(&path.field("look_at"), target, point, distance * NOTICED)?;
            }
            None => {
                let gaze = camera.gaze();
                let finest = gaze.length() * NOTICED;
                rewrite.vector(&path.field("gaze"), gaze, moved.gaze(), finest)?;
            }
        }
        if let (Camera::Orthographic(camera), Camera::Orthographic(moved)) = (camera, moved) {
            let finest = moved.scale() * NOTICED;
            rewrite.number(&path.field("scale"), camera.scale(), moved.scale(), finest)?;
        }
        Ok(rewrite.edits)
    }

    /// Returns the edits that move the camera of a view back, or forth, until all bounded geometries are in the
    /// picture. Its direction stays.
    ///
    /// # Errors
    ///
    /// As [`Checked::move_camera`], and a scene without bounded geometries.
    pub fn frame_all(&self, view: &View) -> Result<Vec<Edit>, Error> {
        let scene = self.current()?;
        let before = view.before_motion(scene)?;
        if before.is_framed() {
            return Err(Error::refused(
                "the camera is a `Fit`, which frames all geometries",
            ));
        }
        let (camera, moved) = (before.camera(), before.camera_of_all()?);
        let ahead = unit(camera.gaze());
        let distance = (middle(&before) - moved.eye()).dot(ahead);
        let finest = distance * NOTICED;
        let path = view.path_of_camera(scene);
        let mut rewrite = Rewrite::new(&self.document);
        rewrite.vector(&path.field("eye"), camera.eye(), moved.eye(), finest)?;
        if let Some(target) = before.target() {
            let point = moved.eye() + ahead * distance;
            rewrite.vector(&path.field("look_at"), target, point, finest)?;
        }
        if let (Camera::Orthographic(camera), Camera::Orthographic(moved)) = (camera, moved) {
            let finest = moved.scale() * NOTICED;
            rewrite.number(&path.field("scale"), camera.scale(), moved.scale(), finest)?;
        }
        Ok(rewrite.edits)
    }

    /// Returns the edits that shift a geometry of the scene, seen in a view, by pixels: to the
    /// right, and down. It stays in a plane that is parallel to the picture.
    ///
    /// # Errors
    ///
    /// A text with errors, a table, a part, a group, and a geometry that an animation moves.
    pub fn move_geometry(
        &self,
        view: &View,
        geometry: &Origin,
        [right, down]: [f64; 2],
    ) -> Result<Vec<Edit>, Error> {
        let scene = view.of(self.current()?)?;
        let path = geometry.path();
        let mut rewrite = Rewrite::new(&self.document);
        let fields = GeometryModel::VARIANTS
            .iter()
            .flat_map(|variant| variant.fields());
        let places = fields.filter(|field| field.kind == FieldKind::Point);
        let places: BTreeSet<_> = places.map(|field| field.name).collect();
        let found = places.into_iter().map(|name| path.field(name));
        let found = found.filter_map(|path| Some((rewrite.read_vector(&path)?, path)));
        let found: Vec<_> = found.collect();
        let Some((first, _)) = found.first() else {
            let message = "only a geometry whose place is in the text can be moved, not a table, a part or a \
                 group";
            return Err(Error::refused(message));
        };
        let shape = scene.world().with_id(scene.ids(geometry).start);
        // The numbers of a geometry in groups are those before the groups move it.
        let shift = match shape.and_then(|geometry| geometry.shape().transform()) {
            None => shift(&scene, *first, right, -down),
            Some(transform) => {
                let place = transform.point(*first);
                transform.point_back(place + shift(&scene, place, right, -down)) - *first
            }
        };
        let step = (shift / libm::hypot(right, down).max(1.0)).length();
        for (point, path) in found {
            rewrite.vector(&path, point, point + shift, step * OF_A_PIXEL)?;
        }
        Ok(rewrite.edits)
    }

    fn current(&self) -> Result<&Scene, Error> {
        match &self.scene {
            Some(ready) if !self.is_broken() => Ok(&ready.scene),
            _ => Err(Error::refused("the scene has errors")),
        }
    }
}

/// Returns the middle of the bounded geometries of a scene.
fn middle(scene: &Scene) -> DVec3 {
    let geometries = scene.world().geometries().iter();
    let bounds = geometries.filter_map(|geometry| geometry.shape().bounds());
    let whole = bounds
        .reduce(|[low, high], [other_low, other_high]| [low.min(other_low), high.max(other_high)]);
    whole.map_or(DVec3::ZERO, |[low, high]| low.midpoint(high))
}

/// Returns the shift in the scene of a point that moves by pixels in the picture, to the right and
/// up, at constant depth.
fn shift(scene: &Scene, point: DVec3, right: f64, up: f64) -> DVec3 {
    let (camera, size) = (scene.camera(), scene.size());
    let depth = (camera.eye() - point).dot(camera.w());
    let at = |x: f64, y: f64| {
        let ray = camera.ray_for(size.width(), size.height(), x, y);
        let from = (camera.eye() - ray.origin()).dot(camera.w());
        let along = -ray.direction().dot(camera.w());
        ray.at((depth - from) / along)
    };
    let middle = [size.width(), size.height()].map(|side| f64::from(side - 1) / 2.0);
    at(middle[0] + right, middle[1] + up) - at(middle[0], middle[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::tests::{checked, edited};

    fn orbit(right: f64, up: f64) -> View {
        View {
            motion: Motion {
                orbit: [right, up],
                ..Motion::default()
            },
            ..View::default()
        }
    }

    #[test]
    fn a_camera_that_frames_can_only_turn() {
        let text = r##"(camera: Fit(from: (0, 0, 2) /* front */), geometries: [
            Sphere(center: (5, 5, 5), radius: 1, color: "#f00")])"##;
        let checked = checked(text);
        let edits = checked.move_camera(&orbit(90.0, 0.0)).unwrap();
        let expected = text.replace("(0, 0, 2)", "(-2, 0, 0)");
        assert_eq!(edited(text, &edits), expected);
        let pan = View {
            motion: Motion {
                pan: [0.5, 0.0],
                ..Motion::default()
            },
            ..View::default()
        };
        let error = checked.move_camera(&pan).unwrap_err().to_string();
        assert!(error.contains("--explicit-camera"), "{error}");
    }

    #[test]
    fn a_camera_beside_the_geometries_frames_all() {
        let geometries = r##"geometries: [Sphere(center: (5, 1, 0), radius: 1, color: "#f00"),
            Plane(point: (0, 0, 0), normal: (0, 1, 0), color: "#0f0"),
            Sphere(center: (7, 1, 0), radius: 1, color: "#f00")])"##;
        for (camera, framed) in [
            (
                "Perspective(eye: (0, 1, /* far */ -5), look_at: (0, 1, -9), fov: 60)",
                "Perspective(eye: (6, 1, /* far */ 3.1993), look_at: (6, 1, 0),",
            ),
            (
                "Orthographic(eye: (0, 1, -5), gaze: (0, 0, -2), scale: 1)",
                "Orthographic(eye: (6, 1, ",
            ),
        ] {
            let text = format!("(camera: {camera}, {geometries}");
            let found = checked(&text);
            let edits = found.frame_all(&View::default()).unwrap();
            let text = edited(&text, &edits);
            assert!(text.contains(framed), "{text}");
            let found = checked(&text);
            let scene = &found.scene().unwrap().scene;
            let seen = scene.seen(&crate::RenderOptions::new()).unwrap();
            let seen: Vec<_> = seen.iter().map(|seen| (seen.id, seen.bounds)).collect();
            for id in [0, 2] {
                let [x, _, width, _] = seen.iter().find(|seen| seen.0 == id).unwrap().1;
                assert!(x > 0 && x + width < 640, "{seen:?}");
            }
            // It is as near as that allows.
            let again = found.frame_all(&View::default()).unwrap();
            assert!(again.is_empty(), "{again:?}");
        }
        let plane =
            "(camera: Perspective(eye: (0, 1, 0), look_at: (0, 1, 5), fov: 60), geometries: [
            Plane(point: (0, 0, 0), normal: (0, 1, 0), color: \"#0f0\")])";
        assert!(checked(plane).frame_all(&View::default()).is_err());
    }

    fn origin(path: &str) -> Origin {
        path.parse().unwrap()
    }

    const TEXT: &str = r##"( // mine
    camera: Perspective(
        eye: (0, 0, /* far */ 5.0), // keep me
        look_at: (0, 0,0), fov: 60),
    geometries: [ Sphere(center: (0, 0, 0), radius: 1, color: "#f00"),
        Plane(point: (0, -1, 0), normal: (0, 1, 0), color: "#0f0"), ],
)"##;

    #[test]
    fn only_the_numbers_change() {
        let checked = checked(TEXT);
        let edits = checked.move_camera(&orbit(90.0, 0.0)).unwrap();
        let expected = TEXT.replace("eye: (0, 0, /* far */ 5.0)", "eye: (-5, 0, /* far */ 0)");
        assert_eq!(edited(TEXT, &edits), expected);

        let edits = checked
            .move_geometry(&View::default(), &origin("geometries[0]"), [10.0, 0.0])
            .unwrap();
        let moved = edited(TEXT, &edits);
        // At the depth 5, 480 pixels are 2·5·tan 30° high.
        let expected = 10.0 * 10.0 * libm::tan(std::f64::consts::PI / 6.0) / 480.0;
        let found = moved.split("Sphere(center: (").nth(1).unwrap();
        let found: f64 = found.split(',').next().unwrap().parse().unwrap();
        assert!((found - expected).abs() < 1e-3, "{found} {expected}");
        assert_eq!(moved.replace(&found.to_string(), "0"), TEXT);
        let edits = checked
            .move_geometry(&View::default(), &origin("geometries[1]"), [0.0, 10.0])
            .unwrap();
        assert_eq!(edits.len(), 1, "{edits:?}");
    }

    #[test]
    fn a_geometry_in_a_group_is_moved_alone() {
        let text = TEXT.replace(
            "geometries: [ Sphere",
            "geometries: [ Group(geometries: [Sphere",
        );
        let text = text.replace("#f00\"),", "#f00\")]),");
        let checked = checked(&text);
        let found = checked.document().geometry_at(text.find("radius").unwrap());
        let sphere = origin("geometries[0].geometries[0]");
        assert_eq!(found, Some(sphere.clone()));
        let view = View::default();
        let edits = checked.move_geometry(&view, &sphere, [10.0, 0.0]).unwrap();
        let moved = edited(&text, &edits);
        assert!(
            moved.contains("Group(geometries: [Sphere(center: (0.1"),
            "{moved}"
        );
        let whole = checked.move_geometry(&view, &origin("geometries[0]"), [10.0, 0.0]);
        assert!(whole.is_err());
        // In a group of half the size, turned by half a turn, the shift is twice as large, and back.
        let turn = "Group(transform: (rotate: (axis: (0, 0, 1), angle: 180), scale: 0.5), ";
        let text = text.replace("Group(", turn);
        let checked = self::checked(&text);
        let edits = checked.move_geometry(&view, &sphere, [10.0, 0.0]).unwrap();
        let moved = edited(&text, &edits);
        assert!(moved.contains("Sphere(center: (-0.2"), "{moved}");
        // Each copy before it has an id.
        let copies = "geometries: [ Instances(of: \"ball\", transforms: [(), ()]), ";
        let text = text.replace("geometries: [ ", copies);
        let text = text.replace("Plane(", "Plane(name: \"ball\", ");
        let checked = self::checked(&text);
        let sphere = origin("geometries[1].geometries[0]");
        let edits = checked.move_geometry(&view, &sphere, [10.0, 0.0]).unwrap();
        let moved = edited(&text, &edits);
        assert!(moved.contains("Sphere(center: (-0.2"), "{moved}");
    }

    #[test]
    fn a_named_camera_of_json_by_gaze() {
        let text = r##"{"cameras": {"a b": {"Orthographic": {"eye": [0, 0, 9],
            "gaze": [0, 0, -1], "scale": 4}}}, "geometries": [
            {"Sphere": {"center": [0, 0, 0], "radius": 1, "color": "#f00"}}]}"##;
        let view = View {
            camera: Some("a b".to_owned()),
            motion: Motion {
                orbit: [0.0, 45.0],
                pan: [0.0, 0.0],
                dolly: libm::log(2.0),
            },
            ..View::default()
        };
        let edits = checked(text).move_camera(&view).unwrap();
        let expected = text
            .replace("[0, 0, 9]", "[0, -6.364, 6.364]")
            .replace("[0, 0, -1]", "[0, 0.7071, -0.7071]")
            .replace("\"scale\": 4", "\"scale\": 2");
        assert_eq!(edited(text, &edits), expected);
    }

    #[test]
    fn what_an_animation_moves_is_not_written() {
        let text = TEXT.replace(
            "\n)",
            "\n    animation: (frames: 2, fps: 1, tracks: {\"camera.eye\": [(0, (1, 0, 5)), (1, (2, 0, 5))]}),\n)",
        );
        let error = checked(&text).move_camera(&orbit(9.0, 0.0)).unwrap_err();
        assert!(error.to_string().contains("animation"), "{error}");
        let broken = checked("(camera: 1)").move_camera(&orbit(9.0, 0.0));
        assert!(broken.is_err());
    }
}
