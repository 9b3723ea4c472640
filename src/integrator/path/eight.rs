//! The samples of a pixel. In worlds of a few geometries, eight are followed at a time, the matte surfaces that they meet
//! in lanes. The light of each sample is that of [`PathTracer::sample`], bit for bit.

mod aim;
mod directions;
mod escape;
mod lanes;
mod scatter;

use std::{collections::VecDeque, ops::Range};

use self::{
    escape::Escape,
    lanes::{EightPaths, FirstFaces},
    scatter::{AddAimed, AimedLight, ScatterMatte},
};
use crate::{
    accel::{
        few::{Arrivals, Few, InTheWay},
        lanes::bits,
    },
    film::size::Size,
    integrator::{
        direct::Queries,
        path::{FirstFace, MOST_PANES, PathSample, PathState, PathTracer, sampler::Sampler},
        surface::Path,
    },
    simd::isa::Isa,
    tracer::{
        camera::Camera,
        contact::Departure,
        radiance::Radiance,
        ray::{BUNDLE, Bundle, Ray},
    },
};

impl<Q: Queries> PathTracer<'_, Q> {
    /// Passes on samples of a pixel, counted from the bottom left of a picture, in their order.
    pub(crate) fn each_sample(
        &self,
        (camera, size): (&Camera, Size),
        pixel: [u32; 2],
        numbers: Range<u32>,
        mut take: impl FnMut(&PathSample),
    ) {
        let isa = self.queries.isa();
        let of_pixel = Sampler::new(pixel, numbers.start, self.options.seed);
        let ray = |sampler: &Sampler| sampler.ray((camera, self.options.filter), size, pixel);
        let Some(few) = self.queries.few() else {
            let mut sampler = of_pixel;
            for number in numbers {
                sampler.restart(&of_pixel, number);
                take(&self.sample_prepared(ray(&sampler), &mut sampler, isa));
            }
            return;
        };
        let (mut first, mut next) = (numbers.start, numbers);
        let (mut paths, mut done) = (EightPaths::new(), VecDeque::new());
        let mut state = PathState {
            waits: true,
            ..PathState::new()
        };
        loop {
            for lane in bits(!paths.active) {
                if let Some(number) = next.next() {
                    done.push_back(None);
                    let sampler = &mut paths.samplers[lane];
                    sampler.restart(&of_pixel, number);
                    let ray = ray(sampler);
                    paths.begin(lane, number, &ray);
                }
            }
            if paths.active == 0 {
                return;
            }
            let ended = self.step_of_each((few, isa), &mut paths, &mut state);
            for lane in bits(ended) {
                paths.state_to(lane, &mut state);
                let sample = self.sample_at_end(&state);
                done[(paths.numbers[lane] - first) as usize] = Some(sample);
            }
            while let Some(sample) = done.front_mut().and_then(Option::take) {
                take(&sample);
                done.pop_front();
                first += 1;
            }
        }
    }

    /// The same as [`PathTracer::sample`], with the pairs of each vertex prepared.
    fn sample_prepared(&self, ray: Ray, sampler: &mut Sampler, isa: Isa) -> PathSample {
        let (mut path, mut state) = (Path::new(ray), PathState::new());
        loop {
            sampler.prepare(path.depth, isa);
            match self.step(&mut path, &mut state, sampler) {
                Some(next) => path = next,
                None => return self.sample_at_end(&state),
            }
        }
    }

    /// Does the next step of each path, and returns the lanes of those that end.
    fn step_of_each(
        &self,
        (few, isa): (Few, Isa),
        paths: &mut EightPaths,
        state: &mut PathState,
    ) -> u8 {
        let active = paths.active;
        let found = meet_each(few, paths);
        for lane in bits(active) {
            paths.samplers[lane].prepare(paths.depths[lane], isa);
        }
        let escaped = isa.run_with_vectors(Escape {
            tracer: self,
            paths,
            found: &found,
        });
        let mut aimed = AimedLight::NONE;
        let scattered = isa.run_with_vectors(ScatterMatte {
            tracer: self,
            paths,
            found: &found,
            aimed: &mut aimed,
        });
        let (escaped, in_lanes) = (escaped.unwrap_or(0), scattered.unwrap_or(0));
        let mut apart = [const { None }; BUNDLE];
        for lane in bits(active & !escaped & !in_lanes) {
            let mut path = paths.path(lane);
            paths.state_to(lane, state);
            let onward = match path.depth > self.max_depth + MOST_PANES {
                true => None,
                false => {
                    let met = self.first_face(&mut path, lane, &found);
                    self.arrive(&path, met, state, &paths.samplers[lane])
                }
            };
            match onward {
                Some(onward) => paths.go_on(lane, onward),
                None => paths.active &= !(1 << lane),
            }
            apart[lane] = state.aimed.take().inspect(|before| aimed.ask(lane, before));
            paths.set_state(lane, state);
        }
        let in_the_way = match aimed.asked {
            0 => InTheWay::default(),
            _ => few.in_the_way(aimed.bundle(), &aimed.left),
        };
        let past_glass = in_the_way.glass
            | match self.has_clear_glass && self.stops_at_glass {
                true => u8::MAX,
                false => 0,
            };
        let lit = (aimed.asked & !in_the_way.dark | aimed.open) & in_lanes;
        isa.run_with_vectors(AddAimed {
            paths,
            aimed: &aimed,
            lanes: lit & (!past_glass | aimed.open),
        });
        for lane in bits(lit & past_glass & !aimed.open) {
            apart[lane] = Some(aimed.before_shadow(lane));
        }
        for (lane, before) in apart.iter().enumerate() {
            let Some(before) = before else {
                continue;
            };
            let is = |mask: u8| mask >> lane & 1 != 0;
            let part = match before.start.is_alone() && !is(in_the_way.glass) {
                true if is(in_the_way.dark) => continue,
                true => self.past_glass(before, Radiance::WHITE),
                false => self.lit(before),
            };
            paths.state_to(lane, state);
            self.add_aimed(state, before, part);
            paths.set_state(lane, state);
        }
        active & !paths.active
    }

    /// Returns what a path meets first, and where rays begin that it sends back.
    fn first_face(&self, path: &mut Path, lane: usize, found: &FirstFaces) -> Option<FirstFace> {
        let is = |mask: u8| mask >> lane & 1 != 0;
        let met = match is(found.asked) {
            true => {
                let (id, t) = found.faces[lane]?;
                FirstFace {
                    t,
                    id,
                    start: None,
                    interface: None,
                }
            }
            // It may cross others at its origin.
            false => self.meet(path)?,
        };
        let FirstFace { t, id, .. } = met;
        let start = met
            .start
            .unwrap_or_else(|| match is(found.asked & !found.touching) {
                true => Departure::at_hit(id, None, path.ray.direction()),
                // Here, it is always known which faces rays leave.
                false => self.queries.known(&Departure::unknown(id, &path.ray, t)),
            });
        Some(FirstFace {
            start: Some(start),
            ..met
        })
    }
}

/// Returns what the paths meet first that begin on one face at most.
fn meet_each(few: Few, paths: &EightPaths) -> FirstFaces {
    let (mut t_max, mut asked) = ([0.0; BUNDLE], 0);
    for lane in bits(paths.active) {
        if paths.starts[lane].is_none() {
            t_max[lane] = f64::INFINITY;
            asked |= 1 << lane;
        }
    }
    let bundle = Bundle::new(paths.origins, paths.directions, t_max);
    let faces = few.nearest(bundle, &paths.left);
    let mut arrivals = Arrivals::NONE;
    for (lane, found) in faces.iter().enumerate() {
        if let Some((own, t)) = found {
            arrivals.set(lane, &paths.ray(lane), (*own, *t));
        }
    }
    FirstFaces {
        faces,
        asked,
        touching: few.touching(&arrivals),
    }
}
