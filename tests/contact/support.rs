//! Random numbers, counts of wrong rays, and scenes in white.

use std::{env, fmt::Display};

use strahl::{
    Color, Geometry, Lighting, Ray, Vec3, World,
    light::{Directional, Light},
    shape::Transform,
};

use crate::form::Form;

/// A xorshift* generator, as that of the unit tests. The seed must not be 0.
pub(crate) struct Rng(pub(crate) u64);

impl Rng {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    /// Returns a number from 0 to `n - 1`.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        ((self.next() >> 32) as usize) % n.max(1)
    }

    /// Returns a number from -1 to 1.
    pub(crate) fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Returns a number between two others.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (self.signed() + 1.0) * 0.5 * (high - low)
    }

    /// Returns a point in the cube from -1 to 1.
    pub(crate) fn vector(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }

    /// Returns a unit vector.
    pub(crate) fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.vector();
            if (0.01..1.0).contains(&v.length_squared()) {
                return unit(v);
            }
        }
    }

    /// Returns one of several values.
    pub(crate) fn one<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())]
    }

    /// Returns a rotation about a random axis, after a scale, before a shift.
    pub(crate) fn turned(&mut self, scale: Vec3, shift: Vec3) -> Transform {
        let turn = (self.direction(), self.between(0.2, 3.0));
        Transform::new(shift, Some(turn), scale).unwrap()
    }
}

pub(crate) fn unit(v: Vec3) -> Vec3 {
    v / v.length()
}

/// Returns the number of cases to test: `STRAHL_CASES` if set, else a quarter of `whole`, or all of it
/// with `STRAHL_FULL`.
pub(crate) fn cases(whole: usize) -> usize {
    let given = env::var("STRAHL_CASES").ok();
    let few = match env::var_os("STRAHL_FULL") {
        Some(_) => whole,
        None => whole.div_ceil(4),
    };
    given.and_then(|n| n.parse().ok()).unwrap_or(few)
}

/// The rays of a class of scenes whose light is wrong.
#[derive(Debug)]
pub(crate) struct Tally {
    class: &'static str,
    rays: usize,
    /// Those that bring too little light.
    dark: usize,
    /// Those that bring too much.
    lit: usize,
    /// Those whose right value is not known: at a border of two of them.
    unsure: usize,
    /// The first wrong ones.
    examples: Vec<String>,
    /// The number of wrong ones by the names of scenes.
    by_scene: Vec<(&'static str, usize)>,
}

impl Tally {
    pub(crate) const fn new(class: &'static str) -> Self {
        Self {
            class,
            rays: 0,
            dark: 0,
            lit: 0,
            unsure: 0,
            examples: Vec::new(),
            by_scene: Vec::new(),
        }
    }

    /// Counts a ray whose light should be `right`, if that is known.
    pub(crate) fn count(
        &mut self,
        [found, tolerance]: [f64; 2],
        right: Option<f64>,
        example: impl FnOnce() -> String,
    ) {
        let Some(right) = right else {
            self.unsure += 1;
            return;
        };
        self.rays += 1;
        if (found - right).abs() <= tolerance {
            return;
        }
        match found < right {
            true => self.dark += 1,
            false => self.lit += 1,
        }
        if self.examples.len() < 4 {
            let text = format!("found {found}, right {right}: {}", example());
            self.examples.push(text.chars().take(1500).collect());
        }
    }

    /// The number of rays.
    pub(crate) const fn rays(&self) -> usize {
        self.rays
    }

    /// The number of wrong rays.
    pub(crate) const fn wrong(&self) -> usize {
        self.dark + self.lit
    }

    /// Notes the scene of the wrong rays since their number was `before`.
    pub(crate) fn note(&mut self, name: &'static str, before: usize) {
        let wrong = self.wrong() - before;
        match self.by_scene.iter_mut().find(|(known, _)| *known == name) {
            Some((_, count)) => *count += wrong,
            None => self.by_scene.push((name, wrong)),
        }
    }

    /// Fails if more rays are too dark or too bright than may be.
    #[track_caller]
    pub(crate) fn at_most(self, dark: usize, lit: usize) {
        let Self {
            class,
            rays,
            unsure,
            examples,
            by_scene,
            ..
        } = &self;
        let counts = format!(
            "{class}: {rays} rays, {} wrong dark, {} wrong lit, {unsure} unsure",
            self.dark, self.lit
        );
        let wrong: Vec<_> = by_scene.iter().filter(|(_, wrong)| *wrong > 0).collect();
        println!("{counts} {wrong:?}");
        assert!(*rays > 0, "{counts}");
        assert!(unsure * 10 <= rays + unsure, "{counts}");
        assert!(
            self.dark <= dark && self.lit <= lit,
            "{counts}\n{}",
            examples.join("\n")
        );
    }

    /// Fails if more rays of `whole` are too dark or too bright than may be, and in proportion of others.
    #[track_caller]
    pub(crate) fn at_most_of(self, whole: usize, [dark, lit]: [usize; 2]) {
        let part = |count: usize| count.max((count * self.rays).div_ceil(whole));
        let (dark, lit) = (part(dark), part(lit));
        self.at_most(dark, lit);
    }

    /// Fails if any ray is wrong.
    #[track_caller]
    pub(crate) fn none(self) {
        self.at_most(0, 0);
    }
}

/// Returns white shapes.
pub(crate) fn white(forms: &[Form]) -> Vec<Geometry> {
    let shapes = forms.iter().map(Form::shape);
    shapes
        .map(|shape| Geometry::new(shape, Color::WHITE))
        .collect()
}

/// Returns a light of intensity 1 that shines along a direction.
pub(crate) fn sun(direction: Vec3) -> Light {
    Directional::new(direction, Color::WHITE, 1.0, true)
        .unwrap()
        .into()
}

/// Returns a black world with shapes and a light.
pub(crate) fn lit_by(geometries: &[Geometry], light: Light) -> World {
    World::new(geometries.to_vec(), Color::BLACK).lit(Lighting::new(vec![light]))
}

/// Returns the text of an example.
pub(crate) fn example(forms: impl std::fmt::Debug, ray: &Ray, light: impl Display) -> String {
    let [o, d] = [ray.origin().to_array(), ray.direction().to_array()];
    format!("o {o:?} d {d:?} {light}\n    {forms:?}")
}
