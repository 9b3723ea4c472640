//! The grouping of pixels: tiles, and in each tile groups of as many pixels as a vector has lanes.

use crate::simd::LANES;

/// The side of a tile, in pixels.
pub(crate) const TILE: u32 = 16;
/// Number of columns in a group: the squarer groups are, the fewer of them a sphere touches.
pub(super) const WIDE: usize = 4;
/// Number of rows in a group. Its pixels are numbered row by row from the top left.
pub(super) const HIGH: usize = LANES / WIDE;
/// Number of groups across a tile.
pub(super) const ACROSS: usize = TILE as usize / WIDE;
/// Number of groups in a tile, row by row from the top left.
pub(super) const GROUPS: usize = ACROSS * (TILE as usize / HIGH);
