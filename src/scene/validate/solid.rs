//! Checks of solids combined from others.

use crate::{
    diagnostic::Code,
    scene::{
        format::{
            geometry::{GeometryModel, ordinal::Ordinal, placement::Placement, solid::SOLIDS},
            scene::Model,
            thing::Thing,
        },
        problem::{Focus, Problem},
        validate::found::Found,
    },
    tracer::shape::{Shape, solid::Operation},
};

/// What a solid may be put together from.
const WHAT_IS_SOLID: &str = "a solid is a closed shape, such as a Sphere, a Box or a capped Cylinder, a Plane, \
                             which is all that lies behind it, a Group of these, or put together from these";

impl Found {
    /// Checks what a solid is put together from.
    #[inline(never)]
    pub(super) fn solid(&mut self, solid: &GeometryModel, at: Ordinal, model: &Model) {
        let path = model.path_of(at);
        for inside in solid.inside().filter(|inside| inside.geometries.is_empty()) {
            let field = inside.field;
            let message = format!("`{field}` has no solids, expected at least 1");
            let problem = Problem::new(Code::WrongType, path.field(field), Focus::Value, message);
            self.push(problem.help(WHAT_IS_SOLID));
        }
        for child in solid.children() {
            self.operand(child.geometry, at.inside(child.number), model);
        }
    }

    /// Checks that the product of the transforms of each part of a solid, inside of it, can be inverted.
    pub(super) fn operands(
        &mut self,
        solid: &GeometryModel,
        at: Ordinal,
        model: &Model,
        around: &Placement,
    ) {
        for child in solid.children() {
            let (operand, at) = (child.geometry, at.inside(child.number));
            let placement = around.within(operand.transform());
            match placement.transform() {
                Ok(_) => self.operands(operand, at, model, &placement),
                Err(error) => {
                    if operand.transform().is_some_and(|own| own.build().is_ok()) {
                        self.cannot_be_placed(at, model, &error);
                    }
                }
            }
        }
    }

    /// Reports a solid that is empty.
    pub(super) fn empty_solid(&mut self, solid: &GeometryModel, at: Ordinal, model: &Model) {
        let Some(Ok(Shape::Solid(shape))) = solid.any_shape() else {
            return;
        };
        if !shape.is_surely_empty() {
            return;
        }
        let (why, help) = match solid.operation() {
            Some(Operation::Difference) => (
                "`minus` cuts all of the solid away",
                "move or shrink what is cut away, or remove the solid",
            ),
            _ => (
                "the operands of the solid do not meet",
                "move them until they do, or remove the solid",
            ),
        };
        let message = format!("this has no effect: {why}");
        let path = model.path_of(at);
        self.push(Problem::new(Code::NoEffect, path, Focus::Name, message).help(help));
    }

    fn operand(&mut self, geometry: &GeometryModel, at: Ordinal, model: &Model) {
        let what = match (geometry, no_solid(geometry)) {
            (_, Some(what)) => what,
            _ if geometry.group().is_some() => return self.solid(geometry, at, model),
            (GeometryModel::Cylinder(cylinder), _) => {
                return self.open(cylinder.capped, "cylinder", at, model);
            }
            (GeometryModel::Cone(cone), _) => return self.open(cone.capped, "cone", at, model),
            _ => return,
        };
        let message = format!("{what} is not a solid");
        let path = model.path_of(at);
        self.push(Problem::new(Code::WrongType, path, Focus::Name, message).help(WHAT_IS_SOLID));
    }

    fn open(&mut self, capped: Option<bool>, kind: &str, at: Ordinal, model: &Model) {
        if capped == Some(false) {
            let message = format!("a {kind} that is open is not a solid");
            let place = model.path_of(at).field("capped");
            let problem = Problem::new(Code::WrongType, place, Focus::Value, message);
            self.push(problem.help("write `capped: true`, or leave `capped` out"));
        }
    }
}

/// Returns the kind of a geometry in words, if it is not a solid, open or closed.
fn no_solid(geometry: &GeometryModel) -> Option<String> {
    let name = geometry.variant().filter(|name| !SOLIDS.contains(name))?;
    let several = geometry.words().map(|words| words.whole.to_owned());
    Some(several.unwrap_or_else(|| format!("a {}", name.to_ascii_lowercase())))
}

/// Returns true if each part of a solid has a surface, its own or one of a solid around it. One that is
/// missing or is not a solid has a fault of its own.
pub(super) fn is_covered(solid: &GeometryModel, at: Ordinal, stand_ins: &[Ordinal]) -> bool {
    solid.surface().is_given()
        || solid.children().all(|child| {
            let (operand, at) = (child.geometry, at.inside(child.number));
            stand_ins.binary_search(&at).is_ok()
                || no_solid(operand).is_some()
                || operand.surface().is_given()
                || (operand.combination().is_some() && is_covered(operand, at, stand_ins))
        })
}
