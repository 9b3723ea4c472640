//! Enums with named values, each declared in one place.

use std::fmt;

/// The error for a name that an enum does not have.
#[derive(Clone, PartialEq, Eq)]
pub struct UnknownName {
    pub(crate) name: String,
    pub(crate) known: Vec<&'static str>,
}

impl fmt::Display for UnknownName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (name, known) = (&self.name, self.known.join(", "));
        write!(f, "unknown name `{name}`, expected one of {known}")
    }
}

/// Writes the same text as `Display`, because `main` prints a returned error with `Debug`.
impl fmt::Debug for UnknownName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl std::error::Error for UnknownName {}

/// Declares an enum with the name of each value, the list of all values and the conversion from a
/// name.
macro_rules! named {
    (
        $(#[$of_all:meta])*
        pub enum $type:ident {
            $($(#[$of_one:meta])* $variant:ident = $name:literal,)*
        }
    ) => {
        $(#[$of_all])*
        pub enum $type {
            $($(#[$of_one])* $variant,)*
        }

        impl $type {
            /// All values, in the order of the documentation.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// Returns the name, as in options and reports.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)*
                }
            }

            /// Returns the value with a name, if there is one.
            pub fn of_name(name: &str) -> Option<Self> {
                let mut all = Self::ALL.iter().copied();
                all.find(|one| one.name() == name)
            }
        }

        impl std::str::FromStr for $type {
            type Err = $crate::diagnostic::named::UnknownName;

            fn from_str(name: &str) -> Result<Self, Self::Err> {
                Self::of_name(name).ok_or_else(|| Self::Err {
                    name: name.to_owned(),
                    known: Self::ALL.iter().map(|one| one.name()).collect(),
                })
            }
        }

        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(self.name())
            }
        }
    };
}

pub(crate) use named;
