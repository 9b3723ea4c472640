//! Setters of options: each returns them with another value.

/// Declares setters, each with the value that its field gets.
macro_rules! setters {
    ($(
        $(#[$about:meta])*
        $name:ident($($value:ident: $type:ty),*) => $($field:ident).+ = $new:expr;
    )*) => {$(
        $(#[$about])*
        #[must_use]
        pub fn $name(mut self, $($value: $type),*) -> Self {
            self.$($field).+ = $new;
            self
        }
    )*};
}
pub(crate) use setters;
