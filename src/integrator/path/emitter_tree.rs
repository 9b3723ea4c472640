//! A tree over emitters that have a place, which chooses one of many in the time of its depth.

use glam::DVec3;

/// The number of emitters with a place up to which there is no tree.
const FEW: usize = 32;

/// An emitter with a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlacedEmitter {
    /// Its number among all.
    pub(super) number: usize,
    pub(super) middle: DVec3,
    /// The irradiance that it brings to a point at a distance of 1, or so.
    pub(super) power: f64,
}

/// A tree over emitters. Inside of it, one is chosen in proportion to its power over the squared distance.
#[derive(Clone, Debug, Default)]
pub(super) struct EmitterTree {
    /// The root first, each before those inside of it.
    nodes: Vec<EmitterNode>,
    /// The node of each emitter, by its number.
    leaves: Vec<Option<usize>>,
}

/// Some emitters.
#[derive(Clone, Debug)]
struct EmitterNode {
    /// The middle of the box around their middles, and the square of half of its diagonal.
    middle: DVec3,
    half_squared: f64,
    power: f64,
    parent: usize,
    content: Content,
}

#[derive(Clone, Copy, Debug)]
enum Content {
    /// The two parts.
    Parts([usize; 2]),
    /// One emitter.
    Emitter(usize),
}

impl EmitterTree {
    /// Creates a tree; `None` if there are few.
    pub(super) fn new(mut placed: Vec<PlacedEmitter>) -> Option<Self> {
        if placed.len() <= FEW {
            return None;
        }
        let most = placed.iter().map(|one| one.number).max()?;
        let mut tree = Self {
            nodes: Vec::with_capacity(2 * placed.len() - 1),
            leaves: vec![None; most + 1],
        };
        tree.add(&mut placed, 0);
        Some(tree)
    }

    /// Adds a node of some emitters, and returns its number.
    fn add(&mut self, placed: &mut [PlacedEmitter], parent: usize) -> usize {
        let node = self.nodes.len();
        let empty = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let [low, high] = placed.iter().fold(empty, |[low, high], one| {
            [low.min(one.middle), high.max(one.middle)]
        });
        let half = (high - low) / 2.0;
        self.nodes.push(EmitterNode {
            middle: low + half,
            half_squared: half.dot(half),
            power: placed.iter().fold(0.0, |sum, one| sum + one.power),
            parent,
            content: Content::Emitter(placed[0].number),
        });
        if let [one] = placed {
            self.leaves[one.number] = Some(node);
            return node;
        }
        let axis = half.max_position();
        placed.sort_by(|one, other| {
            let order = one.middle[axis].total_cmp(&other.middle[axis]);
            order.then(one.number.cmp(&other.number))
        });
        let (left, right) = placed.split_at_mut(placed.len() / 2);
        let parts = [self.add(left, node), self.add(right, node)];
        self.nodes[node].content = Content::Parts(parts);
        node
    }

    /// Returns true if an emitter is in the tree.
    pub(super) fn has(&self, number: usize) -> bool {
        self.leaves.get(number).is_some_and(Option::is_some)
    }

    /// Returns the weight of all emitters at a point.
    pub(super) fn weight(&self, point: DVec3) -> f64 {
        self.nodes[0].weight(point)
    }

    /// Chooses an emitter for a point by a number below 1: it and its probability. `weight` is that of one
    /// emitter; `None` if none of those that are left brings anything.
    pub(super) fn choose(
        &self,
        point: DVec3,
        mut u: f64,
        weight: impl Fn(usize) -> f64,
    ) -> Option<(usize, f64)> {
        let (mut node, mut probability) = (0, 1.0);
        loop {
            let parts = match self.nodes[node].content {
                Content::Emitter(number) => return Some((number, probability)),
                Content::Parts(parts) => parts,
            };
            let [first, other] = parts.map(|part| self.part(part, point, &weight));
            let sum = first + other;
            let at = u * sum;
            let weight;
            if at < first {
                (node, weight, u) = (parts[0], first, at / first);
            } else if other > 0.0 {
                (node, weight, u) = (parts[1], other, (at - first) / other);
            } else {
                return None;
            }
            probability *= weight / sum;
        }
    }

    /// Returns the probability of an emitter of the tree.
    pub(super) fn probability(
        &self,
        point: DVec3,
        number: usize,
        weight: impl Fn(usize) -> f64,
    ) -> f64 {
        let Some(mut node) = self.leaves.get(number).copied().flatten() else {
            return 0.0;
        };
        let mut probability = 1.0;
        while node > 0 {
            let parent = self.nodes[node].parent;
            if let Content::Parts(parts) = self.nodes[parent].content {
                let [first, other] = parts.map(|part| self.part(part, point, &weight));
                let own = if parts[0] == node { first } else { other };
                if own <= 0.0 {
                    return 0.0;
                }
                probability *= own / (first + other);
            }
            node = parent;
        }
        probability
    }

    /// Returns the weight of a node at a point: of one emitter, its own.
    fn part(&self, node: usize, point: DVec3, weight: impl Fn(usize) -> f64) -> f64 {
        let node = &self.nodes[node];
        match node.content {
            Content::Emitter(number) => weight(number),
            Content::Parts(_) => node.weight(point),
        }
    }
}

impl EmitterNode {
    fn weight(&self, point: DVec3) -> f64 {
        let to = point - self.middle;
        let weight = self.power / to.dot(to).max(self.half_squared);
        match weight.is_finite() {
            true => weight,
            false => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::random::Rng;

    fn tree(count: usize) -> (EmitterTree, Vec<PlacedEmitter>) {
        let mut random = Rng(5);
        let placed = |number| PlacedEmitter {
            number: 3 * number,
            middle: 4.0 * random.vector(),
            power: random.magnitude(-2.0, 2.0),
        };
        let placed: Vec<_> = (0..count).map(placed).collect();
        (EmitterTree::new(placed.clone()).unwrap(), placed)
    }

    #[test]
    fn emitters_are_chosen_as_often_as_their_probability_says() {
        let (tree, placed) = tree(50);
        for point in [DVec3::ZERO, DVec3::new(3.0, -2.0, 9.0)] {
            // One of them brings nothing.
            let weight = |number: usize| match number {
                6 => 0.0,
                _ => {
                    placed[number / 3].power / (placed[number / 3].middle - point).length_squared()
                }
            };
            let count = 100_000;
            let mut found = [0; 50];
            for step in 0..count {
                let u = (f64::from(step) + 0.5) / f64::from(count);
                let (number, probability) = tree.choose(point, u, weight).unwrap();
                let other = tree.probability(point, number, weight);
                assert!((probability / other - 1.0).abs() < 1e-14);
                found[number / 3] += 1;
            }
            let mut sum = 0.0;
            for (place, found) in found.into_iter().enumerate() {
                let probability = tree.probability(point, 3 * place, weight);
                sum += probability;
                let part = f64::from(found) / f64::from(count);
                assert!(
                    (part - probability).abs() < 3e-4,
                    "{place} {part} {probability}"
                );
            }
            assert!((sum - 1.0).abs() < 1e-12);
            assert!(!tree.has(1) && tree.has(3));
        }
    }

    #[test]
    fn few_need_no_tree() {
        let one = |number| PlacedEmitter {
            number,
            middle: DVec3::ONE,
            power: 1.0,
        };
        assert!(EmitterTree::new((0..FEW).map(one).collect()).is_none());
        // All in one place: the tree ends.
        let tree = EmitterTree::new((0..100).map(one).collect()).unwrap();
        let (number, probability) = tree.choose(DVec3::ZERO, 0.999, |_| 1.0).unwrap();
        assert_eq!(number, 99);
        assert!((probability - 0.01).abs() < 0.01);
    }
}
