//! Where a camera looks.

use glam::DVec3;

use crate::scene::format::numbers::Triple;

/// The default up direction.
pub(crate) const UP: Triple = [0.0, 1.0, 0.0];

/// The directions of a camera, with the defaults filled in.
pub(crate) struct Sight {
    /// The point that rays start at, or the middle of the picture.
    pub(crate) eye: DVec3,
    /// The direction of view: `gaze`, `look_at - eye` or `-from`; 0 where none is given.
    pub(crate) gaze: DVec3,
    /// The point `look_at`, where there is one.
    pub(crate) target: DVec3,
    /// The field that `gaze` comes from.
    pub(crate) aim: Aim,
    /// True if the scene does not give that field.
    pub(crate) aim_is_default: bool,
    /// The direction that is up.
    pub(crate) up: DVec3,
    /// True if the scene gives no `up`.
    pub(crate) up_is_default: bool,
}

/// The field that the direction of view comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Aim {
    /// The direction itself.
    Gaze,
    /// A point.
    LookAt,
    /// The opposite direction.
    From,
}

impl Sight {
    pub(super) fn new(
        eye: Triple,
        gaze: Option<Triple>,
        look_at: Option<Triple>,
        up: Option<Triple>,
    ) -> Self {
        let seen = look_at.map(|point| DVec3::from(point) - DVec3::from(eye));
        Self {
            eye: eye.into(),
            gaze: gaze.map(DVec3::from).or(seen).unwrap_or(DVec3::ZERO),
            target: look_at.unwrap_or_default().into(),
            aim: match gaze.is_none() && seen.is_some() {
                true => Aim::LookAt,
                false => Aim::Gaze,
            },
            aim_is_default: false,
            up: up.unwrap_or(UP).into(),
            up_is_default: up.is_none(),
        }
    }

    /// Returns the field that the gaze comes from, and its name in messages.
    pub(crate) const fn name(&self) -> (&'static str, &'static str) {
        match self.aim {
            Aim::Gaze => ("gaze", "`gaze`"),
            Aim::LookAt => ("look_at", "`look_at` - `eye`"),
            Aim::From => ("from", "`from`"),
        }
    }

    /// Returns the point `look_at`, if the camera has one.
    pub(crate) fn target(&self) -> Option<DVec3> {
        (self.aim == Aim::LookAt).then_some(self.target)
    }
}
