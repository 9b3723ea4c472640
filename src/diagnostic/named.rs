//! Enums whose values have names: each value stands in one place.

/// Declares an enum with the name of each value, the list of all and the way back from a name.
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
            /// Every value, in the order of the documentation.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// The name, as options and reports write it.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)*
                }
            }

            /// The value with a name.
            pub fn of_name(name: &str) -> Option<Self> {
                let mut all = Self::ALL.iter().copied();
                all.find(|one| one.name() == name)
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
