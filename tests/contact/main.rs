//! Where surfaces meet: each class of scenes in which a point lies on several faces, against values
//! that are found without the rule of contact.
//!
//! Three evaluations are independent of it. [`shadow`] moves a point a little towards the viewer, so that
//! it lies on no face, and asks shapes with equations of their own. [`bounces`] follows mirrored rays from
//! such a point. [`media`] takes crossings that are nearly equal for one, and knows on both sides of them
//! which solids hold the ray. The other cases compare with an equal scene in which nothing touches, or
//! with a closed formula.

mod away;
mod bounces;
mod bricks;
mod columns;
mod copies;
mod drawn;
mod edges;
mod floors;
mod form;
mod gaps;
mod lamps;
mod line;
mod media;
mod shadow;
mod stacks;
mod support;
mod terrains;
mod valleys;
mod water;
