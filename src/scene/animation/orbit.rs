//! Cameras that orbit around a line, at constant distance and speed.

use std::f64::consts::TAU;

use glam::{DMat3, DVec3};

use crate::{
    scene::format::{
        animation::OrbitModel,
        camera::CameraModel,
        field::{FieldKind, Slot},
        thing::Thing,
    },
    tracer::{camera::fit::Turntable, transform::Rotation, vector::unit},
};

impl OrbitModel {
    /// Returns the rotation at a frame, or `None` if the cameras are at their start, to the last
    /// bit, as after a full turn.
    fn rotation(&self, number: u32, frames: u32) -> Option<Rotation> {
        let turns = self.turns() * f64::from(number) / f64::from(frames);
        let part = turns.fract();
        (part != 0.0).then(|| Rotation::new(self.axis().into(), part * TAU))
    }

    /// Returns the rotations at some frames.
    pub(super) fn turntable(&self, numbers: &[u32], frames: u32) -> Turntable {
        let turns = numbers.iter().map(|number| {
            let rotation = self.rotation(*number, frames);
            let axes = [DVec3::X, DVec3::Y, DVec3::Z];
            let turned = axes.map(|axis| rotation.as_ref().map_or(axis, |turn| turn.of(axis)));
            DMat3::from_cols(turned[0], turned[1], turned[2])
        });
        Turntable {
            around: self.around.into(),
            axis: unit(self.axis().into()),
            turns: turns.collect(),
        }
    }

    /// Turns a camera from its place in the file to its place at a frame. One that frames what it
    /// sees has no place yet.
    pub(super) fn turn(&self, camera: &mut CameraModel, number: u32, frames: u32) {
        let Some(rotation) = self.rotation(number, frames).filter(|_| !camera.is_fit()) else {
            return;
        };
        let around = DVec3::from(self.around);
        let vectors = camera
            .fields()
            .iter()
            .filter(|field| field.kind.is_vector());
        for field in vectors {
            if let Some(Slot::Vector(vector)) = camera.slot(field.name) {
                let place = DVec3::from(*vector);
                *vector = match field.kind {
                    FieldKind::Point => around + rotation.of(place - around),
                    _ => rotation.of(place),
                }
                .into();
            }
        }
    }
}
