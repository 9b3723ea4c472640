//! The orbit of the cameras in a scene file.

use crate::scene::format::{camera::UP, object::object};

object! {
    /// A turn of all cameras about a line, at constant speed: what they look at stays in its place in
    /// the picture, and a movie that repeats goes on without a jump.
    pub struct OrbitModel = "Orbit" {
        /// A point on the line, such as the one that the cameras look at.
        around: Point,
        /// The direction of the line; (0, 1, 0) is the default.
        axis: Direction = UP,
        /// The number of full turns in all frames; 1 is the default. Seen from where the axis points,
        /// the cameras go counterclockwise, and clockwise where the number is negative.
        turns: Number = 1.0,
    }
}
