//! The things of the format: which fields they have, and what is inside of them. Whatever leads from
//! a path to a value, or from a value to a path, asks them.

use std::{ops::ControlFlow, sync::Arc};

use crate::{
    diagnostic::path::Step,
    scene::format::{
        field::{Field, Slot},
        map::Map,
    },
};

/// The type of a thing.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Type {
    /// An object with these fields.
    Object(&'static [Field]),
    /// One of several objects, each with its name.
    OneOf(&'static [Variant]),
    /// A list of things.
    List(fn() -> Type),
    /// Things by their names.
    Map(fn() -> Type),
}

impl Type {
    /// Returns the fields of the object, or those of all variants.
    pub(crate) fn fields(self) -> impl Iterator<Item = &'static Field> {
        let (object, variants): (&[Field], &[Variant]) = match self {
            Self::Object(fields) => (fields, &[]),
            Self::OneOf(variants) => (&[], variants),
            Self::List(_) | Self::Map(_) => (&[], &[]),
        };
        object
            .iter()
            .chain(variants.iter().flat_map(|variant| variant.fields))
    }
}

/// One of several objects.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Variant {
    pub(crate) name: &'static str,
    /// Its names in other programs.
    pub(crate) others: &'static [&'static str],
    pub(crate) fields: &'static [Field],
}

/// What a visitor of the things inside of another one sees; it may end the visit.
pub(crate) type See<'a> = &'a mut dyn FnMut(Step, &dyn Thing) -> ControlFlow<()>;

/// A thing of the format: an object, one of several objects, a list, or a map.
pub(crate) trait Thing {
    /// Returns the type.
    fn of_type() -> Type
    where
        Self: Sized;

    /// Returns the fields; a list and a map have none.
    fn fields(&self) -> &'static [Field] {
        &[]
    }

    /// Returns true if a number, a vector or a color is given, or has a default.
    fn has(&self, _field: &str) -> bool {
        false
    }

    /// Returns the slot of a field's value; an optional field with a default is set to it.
    fn slot(&mut self, _field: &str) -> Option<Slot<'_>> {
        None
    }

    /// Calls `see` with each thing inside of it.
    fn things(&self, see: See) -> ControlFlow<()>;

    /// Returns false for an optional thing that is not given.
    fn is_given(&self) -> bool {
        true
    }
}

impl<T: Thing> Thing for Vec<T> {
    fn of_type() -> Type {
        Type::List(T::of_type)
    }

    fn things(&self, see: See) -> ControlFlow<()> {
        let mut items = self.iter().enumerate();
        items.try_for_each(|(index, item)| see(Step::Index(index), item))
    }
}

impl<T: Thing> Thing for Map<T> {
    fn of_type() -> Type {
        Type::Map(T::of_type)
    }

    fn things(&self, see: See) -> ControlFlow<()> {
        let mut entries = self.0.iter();
        entries.try_for_each(|(name, item)| see(Step::Key((&**name).into()), item))
    }
}

/// Passes everything on to what a pointer leads to.
macro_rules! forward {
    ($pointer:ident, |$self:ident| $writable:expr) => {
        impl<T: Thing + Clone> Thing for $pointer<T> {
            fn of_type() -> Type {
                T::of_type()
            }

            fn fields(&self) -> &'static [Field] {
                (**self).fields()
            }

            fn has(&self, field: &str) -> bool {
                (**self).has(field)
            }

            fn slot(&mut self, field: &str) -> Option<Slot<'_>> {
                let $self = self;
                T::slot($writable, field)
            }

            fn things(&self, see: See) -> ControlFlow<()> {
                (**self).things(see)
            }
        }
    };
}

forward!(Box, |this| &mut **this);
forward!(Arc, |this| Self::make_mut(this));

impl<T: Thing> Thing for Option<T> {
    fn of_type() -> Type {
        T::of_type()
    }

    fn fields(&self) -> &'static [Field] {
        self.as_ref().map_or(&[], T::fields)
    }

    fn has(&self, field: &str) -> bool {
        self.as_ref().is_some_and(|thing| thing.has(field))
    }

    fn slot(&mut self, field: &str) -> Option<Slot<'_>> {
        self.as_mut()?.slot(field)
    }

    fn things(&self, see: See) -> ControlFlow<()> {
        self.as_ref()
            .map_or(ControlFlow::Continue(()), |thing| thing.things(see))
    }

    fn is_given(&self) -> bool {
        self.is_some()
    }
}
