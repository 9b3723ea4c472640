//! Meshes of glass whose triangles turn inwards.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::{
    diagnostic::Code,
    parallel::Cancel,
    scene::{
        format::{
            geometry::{mesh::MeshModel, ordinal::Ordinal},
            scene::Model,
        },
        problem::{Focus, Problem},
        validate::found::Found,
    },
};

/// The files of meshes that were looked at: true for those whose triangles turn inwards.
pub(super) type Inward<'a> = BTreeMap<&'a str, bool>;

impl Found {
    /// Warns about a closed mesh, of glass, whose triangles turn inwards.
    pub(super) fn inward<'a>(
        &mut self,
        mesh: &'a MeshModel,
        at: Ordinal,
        model: &Model,
        known: &mut Inward<'a>,
    ) {
        let cancel = self.cancel.as_ref();
        let turns = match &mesh.file {
            None => {
                let vertices = mesh.vertices();
                let corner = |corner: u32| vertices.get(corner as usize).copied().map(DVec3::from);
                turns_inward(mesh.triangles(), corner, cancel)
            }
            Some(file) => *known.entry(&file.path).or_insert_with(|| {
                file.mesh.as_ref().is_some_and(|read| {
                    let vertices = read.mesh.vertices();
                    let corner = |corner: u32| vertices.get(corner as usize).copied();
                    turns_inward(read.mesh.triangles(), corner, cancel)
                })
            }),
        };
        if turns {
            let message = "the triangles of this glass mesh turn inwards, so that light is refracted \
                           the wrong way";
            let problem = Problem::new(Code::OddMesh, model.path_of(at), Focus::Name, message);
            self.push(problem.help("reverse the order of the corners of each triangle"));
        }
    }
}

/// The part of the sum of all volumes that is likely rounding.
const ROUNDING: f64 = 1e-9;

/// Returns true if triangles enclose a volume and go around clockwise, seen from its outside. Once
/// cancelled, it ends.
fn turns_inward(
    triangles: &[[u32; 3]],
    at: impl Fn(u32) -> Option<DVec3>,
    cancel: Option<&Cancel>,
) -> bool {
    let first = triangles.first().and_then(|[corner, ..]| at(*corner));
    let origin = first.unwrap_or_default();
    let (mut volume, mut size, mut open) = (0.0, 0.0, 0_u64);
    for (number, corners) in triangles.iter().enumerate() {
        if number % 4096 == 0 && cancel.is_some_and(Cancel::is_cancelled) {
            return false;
        }
        let [Some(a), Some(b), Some(c)] = corners.map(&at) else {
            return false;
        };
        let part = (a - origin).dot((b - origin).cross(c - origin));
        volume += part;
        size += part.abs();
        let [a, b, c] = *corners;
        // In a closed mesh, each edge is passed in both directions, so that all numbers cancel.
        for [from, to] in [[a, b], [b, c], [c, a]] {
            open = open.wrapping_add(scatter(from, to));
            open = open.wrapping_sub(scatter(to, from));
        }
    }
    open == 0 && volume < -ROUNDING * size
}

/// Returns a number for an edge that looks random: SplitMix64.
const fn scatter(from: u32, to: u32) -> u64 {
    let edge = (from as u64) << 32 | to as u64;
    let mut bits = edge.wrapping_add(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_closed_meshes_turn_inwards() {
        let vertices = [DVec3::splat(1e3), DVec3::X, DVec3::Y, DVec3::Z];
        let at = |corner: u32| vertices.get(corner as usize).copied();
        let turns = |triangles: &[[u32; 3]]| turns_inward(triangles, at, None);
        let one = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
        let other = one.map(|[a, b, c]| [a, c, b]);
        assert_ne!(turns(&one), turns(&other));
        let inward = if turns(&one) { one } else { other };
        assert!(!turns(&inward[1..]));
        let [first, rest @ ..] = inward;
        let [a, b, c] = first;
        // One triangle is turned around.
        assert!(!turns(&[[[a, c, b]].as_slice(), &rest].concat()));
        // A sheet with two sides has no volume.
        assert!(!turns(&[[a, b, c], [a, c, b]]));
        assert!(!turns(&[]));
    }
}
