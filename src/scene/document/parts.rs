//! The files that a scene depends on: tables, and other scenes as its parts.

use std::{collections::HashMap, iter, path::Path as FilePath};

use crate::{
    data::table::kind::RowKind,
    diagnostic::{Code, Diagnostic, Severity, path::Path},
    scene::{
        document::Document,
        format::geometry::{GeometryModel, kind::TableModel},
        part::PartFindings,
    },
};

/// A file that a scene depends on.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Dependency<'a> {
    /// The path from the current folder.
    pub path: &'a FilePath,
    /// The names of the files that name it: the scene, or parts of it.
    pub used_by: Vec<&'a str>,
}

impl Document {
    /// Returns the tables of geometries that the scene names, as written: those of
    /// [`Scene::containers`](crate::Scene::containers) that hold rows.
    pub fn table_names(&self) -> impl Iterator<Item = &str> {
        let tables = self.tables().filter(|table| table.kind != RowKind::Copy);
        tables.map(|table| table.file)
    }

    /// Returns the tables of copies that the scene names, as written.
    pub fn copy_table_names(&self) -> impl Iterator<Item = &str> {
        let tables = self.tables().filter(|table| table.kind == RowKind::Copy);
        tables.map(|table| table.file)
    }

    fn tables(&self) -> impl Iterator<Item = TableModel<'_>> {
        self.geometries().filter_map(GeometryModel::table)
    }

    /// Returns the mesh files that the scene names, as written.
    pub fn mesh_names(&self) -> impl Iterator<Item = &str> {
        let meshes = self.geometries().filter_map(GeometryModel::mesh_file);
        meshes.map(|file| &*file.path)
    }

    /// Returns the parts that the scene names, as written.
    pub fn part_names(&self) -> impl Iterator<Item = &str> {
        let parts = self.geometries().filter_map(GeometryModel::part);
        parts.map(|part| &*part.file)
    }

    fn geometries(&self) -> impl Iterator<Item = &GeometryModel> {
        let model = self.checked.model.iter();
        model.flat_map(|model| model.walk().map(|(_, geometry)| geometry))
    }

    /// Returns the files that the scene depends on, each once: the tables, meshes and parts that it names,
    /// and those that its parts name.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Document, ReadOptions, scene::Memory};
    ///
    /// let files = Memory::new()
    ///     .with("main.ron", "(camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 4),
    ///         geometries: [Part(file: \"tree.ron\")])")
    ///     .with("tree.ron", "(geometries: [Spheres(file: \"leaves.csv\", radius: 1, color: \"#0f0\")])")
    ///     .with("leaves.csv", "x,y,z\n0,0,0\n");
    /// let document = Document::from_path_with("main.ron", &ReadOptions::new().files(files))?;
    /// let [tree, leaves] = &document.dependencies()[..] else { panic!("there are two") };
    /// assert_eq!((tree.path, &tree.used_by[..]), ("tree.ron".as_ref(), &["main.ron"][..]));
    /// assert_eq!((leaves.path, &leaves.used_by[..]), ("leaves.csv".as_ref(), &["tree.ron"][..]));
    /// # Ok::<(), strahl::Error>(())
    /// ```
    pub fn dependencies(&self) -> Vec<Dependency<'_>> {
        let needs = &self.checked.needs;
        let parts = needs.parts.iter();
        let parts = parts.map(|part| (part.name(), &part.files));
        let mut found: Vec<Dependency> = Vec::new();
        let mut places = HashMap::new();
        for (used_by, files) in iter::once((self.name(), &needs.files)).chain(parts) {
            for path in files {
                let place = *places.entry(path.as_os_str()).or_insert(found.len());
                match found.get_mut(place) {
                    Some(known) => known.used_by.push(used_by),
                    None => found.push(Dependency {
                        path,
                        used_by: vec![used_by],
                    }),
                }
            }
        }
        found
    }

    /// Returns the findings of each part, inner parts included, each once in the order of first
    /// mention. A part with errors has a diagnostic at its place in the scene as well.
    pub fn parts(&self) -> impl Iterator<Item = &PartFindings> {
        self.checked.needs.parts.iter().map(|part| &**part)
    }

    /// Returns true if a scene lacks a camera, and maybe more: if it is a part of another scene, it
    /// needs none.
    pub fn lacks_a_camera(&self) -> bool {
        self.errors().any(is_of_camera)
    }

    /// Returns true if a scene lacks nothing but a camera: it can only be a part of another scene.
    pub fn lacks_only_a_camera(&self) -> bool {
        self.lacks_a_camera() && self.errors().all(is_of_camera)
    }

    fn errors(&self) -> impl Iterator<Item = &Diagnostic> {
        let all = self.checked.diagnostics.iter();
        all.filter(|fault| fault.severity == Severity::Error)
    }
}

/// Returns true if a fault is that a scene has no camera.
fn is_of_camera(fault: &Diagnostic) -> bool {
    fault.code == Code::MissingField && fault.path == Path::ROOT.field("camera")
}
