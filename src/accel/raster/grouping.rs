//! How the pixels of a picture are grouped: tiles, and in each tile groups of as many pixels as a
//! vector has lanes.

use crate::simd::LANES;

/// The side of a tile, in pixels.
pub(crate) const TILE: u32 = 16;
/// How many columns a group has: the squarer groups are, the fewer of them a sphere touches.
pub(super) const WIDE: usize = 4;
/// How many rows a group has. Its pixels are numbered row by row from the top left.
pub(super) const HIGH: usize = LANES / WIDE;
/// How many groups a tile is wide.
pub(super) const ACROSS: usize = TILE as usize / WIDE;
/// How many groups a tile has, row by row from the top left.
pub(super) const GROUPS: usize = ACROSS * (TILE as usize / HIGH);
