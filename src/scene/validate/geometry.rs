//! Checks of geometries.

use crate::{
    diagnostic::{Code, path::Path},
    scene::{
        duplicates::Duplicates,
        format::{
            geometry::{GeometryModel, MeshModel, ordinal::Ordinal},
            scene::Model,
            thing::Thing,
        },
        framing::Framing,
        problem::{Cure, Focus, Problem},
        validate::{found::Found, material::both},
    },
    text::nearest::quote,
};

impl Found {
    pub(super) fn geometry(&mut self, geometry: &GeometryModel, at: Ordinal, model: &Model) {
        let path = || model.path_of(at);
        geometry.each(|field, value| self.field(field, value, path));
        // The fields of a sphere have nothing to do with each other, and it may be one of a million.
        if !matches!(geometry, GeometryModel::Sphere(_)) || geometry.transform().is_some() {
            self.between_fields(geometry, at, model);
        }
    }

    pub(super) fn between_fields(&mut self, geometry: &GeometryModel, at: Ordinal, model: &Model) {
        let path = || model.path_of(at);
        for fault in geometry.faults() {
            if !self.tally.only_counts(fault.code()) {
                self.push(fault.inside(&path()));
            }
        }
        if let Some(transform) = geometry.transform() {
            self.transform(transform, &|| path().field("transform"));
        }
        if let Some(copies) = geometry.copies() {
            self.places_of_copies(geometry, copies, at, model);
        }
        if let GeometryModel::Mesh(mesh) = geometry {
            self.one_mesh(mesh, path);
        }
    }

    /// Checks that a mesh is in a file or in the scene.
    pub(super) fn one_mesh(&mut self, mesh: &MeshModel, path: impl Fn() -> Path) {
        let given = (
            mesh.file.is_some(),
            mesh.vertices.is_some(),
            mesh.triangles.is_some(),
        );
        let twice = |field| {
            let problem = both(Code::OneOf, &path(), ["file", field]);
            problem.help("a mesh is in a file, or in the scene: leave one of them out")
        };
        let missing = |field| {
            let message = format!("missing field `{field}`");
            Problem::new(Code::MissingField, path(), Focus::Name, message)
                .help("a mesh in the scene has `vertices` and `triangles`")
        };
        let problem = match given {
            (false, true, true) if mesh.color_by.is_some() => {
                let message = "missing field `file`: `color_by` names a property of its vertices";
                Problem::new(Code::MissingField, path(), Focus::Name, message)
                    .help("put the mesh into a .ply file, or give it one `color`")
            }
            (true, false, false) | (false, true, true) => return,
            (true, true, _) => twice("vertices"),
            (true, false, true) => twice("triangles"),
            (false, true, false) => missing("triangles"),
            (false, false, true) => missing("vertices"),
            (false, false, false) => {
                let message = "neither `file` nor `vertices` is given, expected one of them";
                Problem::new(Code::OneOf, path(), Focus::Name, message)
                    .help("name a .ply, .obj or .stl `file`, or give `vertices` and `triangles`")
            }
        };
        self.push(problem);
    }

    pub(super) fn duplicate_geometry(
        &mut self,
        duplicates: Duplicates,
        model: &Model,
        framing: &Framing,
        stand_ins: &[Ordinal],
    ) {
        // A moving geometry separates from its duplicate.
        let stays = |at, geometry: &GeometryModel| {
            !geometry.is_among(at, stand_ins) && !framing.moves(model, at)
        };
        for (first, at) in duplicates.found(model) {
            if self.is_cancelled() {
                return;
            }
            let (Some(hiding), Some(geometry)) = (model.geometry(first), model.geometry(at)) else {
                continue;
            };
            if !stays(first, hiding) || !stays(at, geometry) {
                continue;
            }
            let place = model.path_of(first);
            let named = hiding.name();
            let named = named.map_or_else(String::new, |name| format!(" ({})", quote(name)));
            let message = format!("equal to `{place}`{named}, which hides it");
            // Tracks refer to geometries by index, so a removal would shift them.
            let is_needless = framing.frames.is_none() && geometry.name().is_none();
            let own = model.path_of(at);
            let problem = Problem::new(Code::DuplicateGeometry, own, Focus::Name, message);
            self.push(
                problem
                    .help("remove one of the two; at equal distance the first is visible")
                    .cure(is_needless.then_some(Cure::Remove))
                    .label(place, Focus::Name, "the first of them"),
            );
        }
    }
}
