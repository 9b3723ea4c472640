//! Checks of copies of other geometries.

use crate::{
    diagnostic::Code,
    scene::{
        copies::{Prototypes, Refused},
        format::{
            geometry::{GeometryModel, PartModel, kind::CopiesModel, ordinal::Ordinal},
            scene::Model,
        },
        problem::{Focus, Problem},
        unknown,
        validate::found::Found,
    },
    text::nearest::quote,
};

impl Found {
    /// Checks what copies are of, for each list of them.
    pub(super) fn prototypes(&mut self, lists: Vec<(Ordinal, CopiesModel)>, model: &Model) {
        if lists.is_empty() {
            return;
        }
        let mut prototypes = Prototypes::new(model);
        for (at, named) in lists {
            if self.is_cancelled() {
                return;
            }
            match prototypes.of(named.of, at) {
                Ok(of) => self.lights_of_copies(of, at, model),
                Err(refused) => self.not_copied(named.of, &refused, at, model),
            }
        }
    }

    /// Warns if what is copied has lights, which are not copied.
    fn lights_of_copies(&mut self, of: Ordinal, at: Ordinal, model: &Model) {
        let shines = |geometry: &GeometryModel| geometry.part().is_some_and(PartModel::lights);
        let geometry = model.geometry(of);
        if !geometry.is_some_and(|geometry| geometry.any_inside(&shines)) {
            return;
        }
        let message = "this has no effect on lights: the copies of a part do not shine";
        let place = model.path_of(at).field("of");
        let problem = Problem::new(Code::NoEffect, place, Focus::Value, message);
        let help =
            "write a `Part` with `lights: true` and a `transform` for each copy that is to shine";
        self.push(
            problem
                .help(help)
                .label(model.path_of(of), Focus::Name, "the lights are here"),
        );
    }

    /// Checks the places of copies.
    #[inline(never)]
    pub(super) fn places_of_copies(
        &mut self,
        geometry: &GeometryModel,
        copies: CopiesModel,
        at: Ordinal,
        model: &Model,
    ) {
        let path = model.path_of(at);
        let helps = [
            "leave one of them out",
            "give a transform for each copy, or name a .csv, .npy or .npz `file`",
        ];
        let is_fine = self.one_of(geometry, Code::OneOf, &path, helps);
        let Some(transforms) = copies.transforms.filter(|_| is_fine) else {
            return;
        };
        let place = path.field("transforms");
        let around = model
            .leaf(at)
            .map(|leaf| leaf.placement)
            .unwrap_or_default();
        for (index, transform) in transforms.iter().enumerate() {
            self.transform(transform, &|| place.index(index));
            let Ok(built) = transform.build() else {
                continue;
            };
            let product = around.transform().ok().flatten();
            if let Some(Err(error)) = product.map(|around| around.times(&built)) {
                let message = format!("cannot be placed: {error}");
                let place = place.index(index);
                self.push(Problem::new(Code::OutOfRange, place, Focus::Value, message));
            }
        }
    }

    /// Reports a geometry that cannot be copied.
    fn not_copied(&mut self, name: &str, refused: &Refused, at: Ordinal, model: &Model) {
        let place = model.path_of(at).field("of");
        let found = quote(name);
        let refuse = |of: Ordinal, message: String, help: &str| {
            let place = place.clone();
            let problem = Problem::new(Code::WrongType, place, Focus::Value, message).help(help);
            match of == at {
                true => problem,
                false => problem.label(model.path_of(of), Focus::Name, "this geometry"),
            }
        };
        let problem = match *refused {
            Refused::Itself(of) => refuse(
                of,
                format!("{found} holds these instances themselves"),
                "name a geometry that does not hold them",
            ),
            Refused::Copies(of) => refuse(
                of,
                format!("{found} holds instances itself, which cannot be copied again"),
                "name what they are copies of",
            ),
            Refused::Operand(of) => refuse(
                of,
                format!("{found} is an operand of a solid, which is not seen alone"),
                "name the whole solid, or a geometry outside of it",
            ),
            Refused::Unknown => {
                let known = model.walk().filter_map(|(_, geometry)| geometry.name());
                let known: Vec<_> = known.take(MOST).collect();
                let message = unknown::message("geometry", name, &known);
                let problem = Problem::new(Code::UnknownName, place, Focus::Value, message);
                let problem = problem.help("give the geometry to copy a `name`");
                problem.meaning(name, &known)
            }
        };
        self.push(problem);
    }
}

/// The largest number of names that a message chooses from.
const MOST: usize = 10_000;
