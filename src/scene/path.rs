//! Names of places in a scene, such as `geometries[3].radius`.

use std::{borrow::Cow, fmt};

/// One step from a value to one inside of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    /// A field of a struct.
    Field(Cow<'static, str>),
    /// Into the struct of a variant; a path does not show it.
    Variant(&'static str),
    /// An element of a list or a tuple, from 0.
    Index(usize),
    /// A value of a map, by its key.
    Key(Box<str>),
}

/// The way from the root of a scene to one of its values.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Path(Vec<Step>);

impl Path {
    /// The root itself.
    pub(crate) const ROOT: Self = Self(Vec::new());

    /// The path of a value inside of this one.
    #[must_use]
    pub(crate) fn then(&self, step: Step) -> Self {
        let mut steps = self.0.clone();
        steps.push(step);
        Self(steps)
    }

    /// The path of a field of this struct.
    #[must_use]
    pub(crate) fn field(&self, name: &'static str) -> Self {
        self.then(Step::Field(name.into()))
    }

    /// The path of an element of this list or tuple.
    #[must_use]
    pub(crate) fn index(&self, index: usize) -> Self {
        self.then(Step::Index(index))
    }

    /// The path of a value of this map.
    #[must_use]
    pub(crate) fn key(&self, key: &str) -> Self {
        self.then(Step::Key(key.into()))
    }

    /// The path of what is around this value.
    #[must_use]
    pub(crate) fn parent(&self) -> Self {
        let around = self.0.split_last().map_or(&[][..], |(_, around)| around);
        Self(around.to_vec())
    }

    /// The steps from the root.
    pub(crate) fn steps(&self) -> &[Step] {
        &self.0
    }
}

impl fmt::Display for Path {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut separator = "";
        for step in &self.0 {
            match step {
                Step::Field(name) => write!(f, "{separator}{name}")?,
                Step::Index(index) => write!(f, "[{index}]")?,
                Step::Key(key) => write!(f, "[{key:?}]")?,
                Step::Variant(_) => continue,
            }
            separator = ".";
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_reads_like_a_program() {
        let path = Path::ROOT.field("geometries").index(3);
        let radius = path.then(Step::Variant("Sphere")).field("radius");
        assert_eq!(radius.to_string(), "geometries[3].radius");
        assert_eq!(path.to_string(), "geometries[3]");
        assert_eq!(Path::ROOT.to_string(), "");
        let eye = Path::ROOT.field("cameras").key("a \"b\"").field("eye");
        assert_eq!(eye.to_string(), r#"cameras["a \"b\""].eye"#);
    }
}
