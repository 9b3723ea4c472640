//! The code of a warning in a scene file.

use std::sync::LazyLock;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::{
    diagnostic::Code,
    scene::format::thing::{OneOf, Type, Variant},
};

/// The code of a warning.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum WarningName {
    /// A code whose own severity is a warning.
    Known(Code),
    /// Any other string; validation reports it at its place.
    Unknown(Box<str>),
}

impl Serialize for WarningName {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(match self {
            Self::Known(code) => code.name(),
            Self::Unknown(name) => name,
        })
    }
}

impl<'de> Deserialize<'de> for WarningName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = Box::<str>::deserialize(deserializer)?;
        let mut warnings = Code::WARNINGS.iter().copied();
        let known = warnings.find(|code| code.name() == &*name);
        Ok(known.map_or(Self::Unknown(name), Self::Known))
    }
}

impl WarningName {
    /// Returns the type.
    pub(crate) fn of_type() -> Type {
        static ONE_OF: LazyLock<OneOf> = LazyLock::new(|| {
            let warnings = Code::WARNINGS.iter().map(|code| Variant {
                name: code.name(),
                docs: "",
                others: &[],
                content: None,
            });
            OneOf {
                name: "Warning",
                docs: "The code of a warning.",
                variants: warnings.collect::<Vec<_>>().leak(),
                are_operands: false,
            }
        });
        Type::OneOf(&ONE_OF)
    }
}
