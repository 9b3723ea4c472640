//! The instances of a scene file: copies of another geometry.

use crate::{
    data::table::kind::RowKind,
    diagnostic::Code,
    scene::{
        format::{
            geometry::kind::{CopiesModel, GeometryKind, SeveralWords, TableModel, geometry},
            thing::Type,
            transform::TransformModel,
        },
        problem::Problem,
    },
};

geometry! {
    /// Copies of another geometry of the scene, with its materials: one for each transform, or for each row
    /// of a table. However large it is, all of them share its memory.
    pub struct InstancesModel = "Instances" {
        /// The name of the geometry, anywhere in the scene, which is also seen where it stands. The
        /// transforms of groups around it do not count.
        of: Other { Type::NameOfGeometry }(Box<str>),
        /// The place, direction and size of each copy. Give this or `file`.
        transforms: Thing(Vec<TransformModel>)?,
        /// The table in place of `transforms`: a path from the folder of the scene to a file .csv, .npy or
        /// .npz, with `/` between its parts. Its columns `x`, `y` and `z` are the shift of each copy;
        /// optional are `scale`, above 0, and `angle` in degrees about the axis `axis_x`, `axis_y`,
        /// `axis_z`, which is (0, 1, 0) where the table has none.
        file | csv | table | path: File { &["csv", "npy", "npz"] }(Box<str>)?,
        /// The names of the columns of a table without names: an array of numbers, or a CSV file whose
        /// first line is a row. A name that begins with `_` stands for a column to skip.
        columns: Other { Type::List(|| Type::Text, 0) }(Vec<Box<str>>)?,
        /// The array of an .npz file whose rows are read; required where several have rows of columns.
        array: Text(Box<str>)?,
    } one of transforms, file not solid
}

impl GeometryKind for InstancesModel {
    fn faults(&self) -> Vec<Problem> {
        let Some(transforms) = self.transforms.as_ref().filter(|_| self.file.is_none()) else {
            return Vec::new();
        };
        let (without_file, without_places) = (
            "this has no effect: there is no `file`",
            "this has no effect: there are no transforms",
        );
        let add = "add a transform for each copy, or remove it";
        let faults = [
            (self.columns.is_some(), "columns", without_file, "remove it"),
            (self.array.is_some(), "array", without_file, "remove it"),
            (transforms.is_empty(), "transforms", without_places, add),
        ];
        let faults = faults.into_iter().filter(|(is_fault, ..)| *is_fault);
        let faults = faults.map(|(_, field, message, help)| {
            Problem::of_field(Code::NoEffect, field, message).help(help)
        });
        faults.collect()
    }

    fn copies(&self) -> Option<CopiesModel<'_>> {
        Some(CopiesModel {
            of: &self.of,
            transforms: self.transforms.as_deref(),
        })
    }

    fn words(&self) -> Option<SeveralWords> {
        Some(SeveralWords {
            whole: "a list of instances",
            all: match self.file {
                Some(_) => "copies of this table",
                None => "these instances",
            },
            one: "one of these",
        })
    }

    fn table(&self) -> Option<TableModel<'_>> {
        Some(TableModel {
            kind: RowKind::Copy,
            file: self.file.as_deref()?,
            columns: self.columns.as_deref(),
            array: self.array.as_deref(),
            radius: None,
            color: None,
            color_by: None,
            texture: None,
            material: None,
        })
    }

    fn more_numbers(&self, see: &mut dyn FnMut(f64)) {
        self.of.bytes().for_each(|byte| see(byte.into()));
        for transform in self.transforms.iter().flatten() {
            // One that is invalid equals no other.
            let rows = transform
                .build()
                .map_or([[f64::NAN; 4]; 3], |built| built.rows());
            rows.as_flattened().iter().for_each(|number| see(*number));
        }
    }
}
