//! Checks of copies of other geometries.

use super::Found;
use crate::{
    diagnostic::Code,
    scene::{
        format::{
            geometry::{GeometryModel, InstancesModel, nesting::Ordinal},
            scene::Model,
            transform::TransformModel,
        },
        instances::Refused,
        problem::{Cure, Focus, Problem},
    },
    text::nearest::{list, nearest, quote},
    tracer::error::GeometryError,
};

impl Found {
    /// Checks what the copies are of, and their places.
    #[inline(never)]
    pub(super) fn instances(&mut self, instances: &InstancesModel, at: Ordinal, model: &Model) {
        let path = model.path_of(at);
        if let Err(refused) = model.copied(&instances.of, at) {
            self.not_copied(&instances.of, &refused, at, model);
        }
        let transforms = instances.transforms.as_deref().unwrap_or_default();
        let place = path.field("transforms");
        if transforms.is_empty() {
            let message = "this has no effect: there are no transforms";
            let problem = Problem::new(Code::NoEffect, place, Focus::Value, message);
            return self.push(problem.help("add a transform for each copy, or remove it"));
        }
        for (index, transform) in transforms.iter().enumerate() {
            self.transform(transform, &place.index(index));
            self.instance(transform, index, at, model);
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
                let message = match &*known {
                    [] => format!("unknown geometry {found}, the scene has none with a name"),
                    known => {
                        format!("unknown geometry {found}, expected one of {}", list(known))
                    }
                };
                let problem = Problem::new(Code::UnknownName, place, Focus::Value, message);
                match nearest(name, &known) {
                    Some(meant) => problem
                        .help(format!("did you mean {}?", quote(meant)))
                        .cure(Cure::Write(serde_json::Value::from(meant).to_string())),
                    None => problem.help("give the geometry to copy a `name`"),
                }
            }
        };
        self.push(problem);
    }

    /// Checks that a copy can be placed: the product of its transform with those around the copies,
    /// and with that of what is copied, can be inverted.
    fn instance(&mut self, transform: &TransformModel, index: usize, at: Ordinal, model: &Model) {
        let Some(around) = model.leaf(at).map(|leaf| leaf.placement) else {
            return;
        };
        let of = match model.geometry(at) {
            Some(GeometryModel::Instances(instances)) => model.copied(&instances.of, at).ok(),
            _ => None,
        };
        let own = of.and_then(|of| model.geometry(of)?.transform());
        let fails = |error: GeometryError| format!("cannot be placed: {error}");
        let is_fine = |transform: &TransformModel| transform.build().is_ok();
        if around.transform().is_err() || !is_fine(transform) || !own.is_none_or(is_fine) {
            return;
        }
        let whole = around.within(Some(transform)).within(own);
        if let Err(error) = whole.transform() {
            let place = model.path_of(at).field("transforms").index(index);
            self.push(Problem::new(
                Code::OutOfRange,
                place,
                Focus::Value,
                fails(error),
            ));
        }
    }
}

/// The largest number of names that a message chooses from.
const MOST: usize = 10_000;
