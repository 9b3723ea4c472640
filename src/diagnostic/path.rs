//! Paths of values in a scene, such as `geometries[3].radius`.

use std::{borrow::Cow, fmt};

/// A step from a value to one inside of it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Step {
    /// A field of a struct.
    Field(Cow<'static, str>),
    /// An element of a list or a tuple, counted from 0.
    Index(usize),
    /// A value of a map, by its key.
    Key(Box<str>),
}

impl Step {
    /// Returns the name of the field or the key, if any.
    pub fn name(&self) -> Option<&str> {
        match self {
            Self::Field(name) => Some(name),
            Self::Key(key) => Some(key),
            Self::Index(_) => None,
        }
    }

    /// Returns true if both lead to the same value: a setting may name a key as if it were a field.
    pub(crate) fn leads_as(&self, other: &Self) -> bool {
        match (self.name(), other.name()) {
            (None, None) => self == other,
            (name, other) => name == other,
        }
    }
}

/// The path from the root of a scene to one of its values. `Display` writes it as in a program; the
/// root is empty.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Path(Vec<Step>);

impl Path {
    /// The path of the root.
    pub const ROOT: Self = Self(Vec::new());

    /// Returns true if this is the path of a value or of one inside of it.
    pub(crate) fn is_in(&self, owner: &Self) -> bool {
        self.0.starts_with(&owner.0)
    }

    /// Returns the path of a value inside of this one.
    #[must_use]
    pub(crate) fn then(&self, step: Step) -> Self {
        self.join(&[step])
    }

    /// Returns the path of a value several steps inside of this one.
    #[must_use]
    pub(crate) fn join(&self, steps: &[Step]) -> Self {
        Self([&self.0, steps].concat())
    }

    /// Returns the path of a field of this struct.
    #[must_use]
    pub fn field(&self, name: impl Into<Cow<'static, str>>) -> Self {
        self.then(Step::Field(name.into()))
    }

    /// Returns the path of an element of this list or tuple.
    #[must_use]
    pub fn index(&self, index: usize) -> Self {
        self.then(Step::Index(index))
    }

    /// Returns the path of a value of this map.
    #[must_use]
    pub fn key(&self, key: &str) -> Self {
        self.then(Step::Key(key.into()))
    }

    /// Returns the path of the value around this one.
    #[must_use]
    pub(crate) fn parent(&self) -> Self {
        let around = self.0.split_last().map_or(&[][..], |(_, around)| around);
        Self(around.to_vec())
    }

    /// Returns the steps from the root.
    pub fn steps(&self) -> &[Step] {
        &self.0
    }
}

impl From<&[Step]> for Path {
    fn from(steps: &[Step]) -> Self {
        Self(steps.to_vec())
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
            }
            separator = ".";
        }
        Ok(())
    }
}

/// A path on the stack, with one step per level, for traversing a whole scene: it is converted to a
/// [`Path`] only where there is a fault.
pub(crate) enum Trail<'p> {
    Root,
    Inside(&'p Self, Step),
}

impl<'p> Trail<'p> {
    pub(crate) const fn field(&'p self, name: &'static str) -> Self {
        Self::Inside(self, Step::Field(Cow::Borrowed(name)))
    }

    pub(crate) fn key(&'p self, key: &str) -> Self {
        Self::Inside(self, Step::Key(key.into()))
    }

    pub(crate) const fn index(&'p self, index: usize) -> Self {
        Self::Inside(self, Step::Index(index))
    }

    /// Returns the name of the field that the path leads to, or to an element of.
    pub(crate) fn last_field(&self) -> Option<&str> {
        match self {
            Self::Inside(around, Step::Index(_)) => around.last_field(),
            Self::Inside(_, Step::Field(name)) => Some(name),
            Self::Inside(_, Step::Key(_)) | Self::Root => None,
        }
    }
}

impl From<&Trail<'_>> for Path {
    fn from(mut trail: &Trail<'_>) -> Self {
        let mut steps = Vec::new();
        while let Trail::Inside(around, step) = trail {
            steps.push(step.clone());
            trail = around;
        }
        steps.reverse();
        Self(steps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_reads_like_code() {
        let path = Path::ROOT.field("geometries").index(3);
        assert_eq!(path.field("radius").to_string(), "geometries[3].radius");
        assert_eq!(path.to_string(), "geometries[3]");
        assert_eq!(Path::ROOT.to_string(), "");
        let eye = Path::ROOT.field("cameras").key("a \"b\"").field("eye");
        assert_eq!(eye.to_string(), r#"cameras["a \"b\""].eye"#);
        let root = Trail::Root;
        let list = root.field("geometries");
        assert_eq!(Path::from(&list.index(3)), path);
    }
}
