//! Checks of copies of other geometries.

use super::Found;
use crate::{
    diagnostic::Code,
    scene::{
        format::{
            geometry::{GeometryModel, InstancesModel, ordinal::Ordinal},
            scene::Model,
        },
        instances::{Prototypes, Refused},
        problem::{Focus, Problem},
        unknown,
    },
    text::nearest::quote,
};

impl Found {
    /// Checks what copies are of, for each list of them.
    pub(super) fn prototypes(&mut self, lists: Vec<(Ordinal, &InstancesModel)>, model: &Model) {
        if lists.is_empty() {
            return;
        }
        let mut prototypes = Prototypes::new(model);
        for (at, named) in lists {
            if self.is_cancelled() {
                return;
            }
            match prototypes.of(&named.of, at) {
                Ok(of) => self.lights_of_copies(of, at, model),
                Err(refused) => self.not_copied(&named.of, &refused, at, model),
            }
        }
    }

    /// Warns if what is copied has lights, which are not copied.
    fn lights_of_copies(&mut self, of: Ordinal, at: Ordinal, model: &Model) {
        let shines = |geometry: &GeometryModel| match geometry {
            GeometryModel::Part(part) => part.lights == Some(true),
            _ => false,
        };
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
    pub(super) fn instances(&mut self, instances: &InstancesModel, at: Ordinal, model: &Model) {
        let path = model.path_of(at);
        let helps = [
            "leave one of them out",
            "give a transform for each copy, or name a .csv, .npy or .npz `file`",
        ];
        let is_fine = self.one_of(instances, Code::OneOf, &path, helps);
        let Some(transforms) = instances.transforms.as_ref().filter(|_| is_fine) else {
            return;
        };
        let of_table = [
            ("columns", instances.columns.is_some()),
            ("array", instances.array.is_some()),
        ];
        for (field, _) in of_table.into_iter().filter(|(_, is_given)| *is_given) {
            let message = "this has no effect: there is no `file`";
            let problem = Problem::new(Code::NoEffect, path.field(field), Focus::Value, message);
            self.push(problem.help("remove it"));
        }
        let place = path.field("transforms");
        if transforms.is_empty() {
            let message = "this has no effect: there are no transforms";
            let problem = Problem::new(Code::NoEffect, place, Focus::Value, message);
            return self.push(problem.help("add a transform for each copy, or remove it"));
        }
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
            Refused::Instances(of) => refuse(
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
