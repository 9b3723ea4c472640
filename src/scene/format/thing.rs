//! The things of the format: their types, which fields they have, and what is inside of them. The schema,
//! completion, and whatever leads from a path to a value, or from a value to a path, ask them.

use std::{ops::ControlFlow, ptr, sync::Arc};

use serde::{Serialize, de::DeserializeOwned};

use crate::{
    diagnostic::path::Step,
    scene::format::{
        field::{Field, FieldKind, Slot, Value},
        map::{Entry, Map},
    },
};

/// The type of a value.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Type {
    /// True or false.
    Flag,
    /// A number, a vector or a color.
    Value(FieldKind),
    /// A whole number from 0; one of these, if there are any.
    Whole(fn() -> Vec<u32>),
    /// A string.
    Text,
    /// A string with at least one letter.
    Name,
    /// The name of one of the scene's geometries.
    NameOfGeometry,
    /// The name of one of the scene's materials.
    NameOfMaterial,
    /// The path of a file with one of these endings.
    File(&'static [&'static str]),
    /// Three rows of four numbers.
    Matrix,
    /// This many values of a type.
    Tuple(fn() -> Type, usize),
    /// A list of at least this many values of a type.
    List(fn() -> Type, usize),
    /// Values of a type by their names, which match a pattern if there is one.
    Map(fn() -> Type, Option<&'static str>),
    /// The tracks of an animation.
    Tracks,
    /// An object; true for one inside of a solid, which may take the color and the material of that.
    Object(&'static Object, bool),
    /// One of several objects or words.
    OneOf(&'static OneOf),
}

impl Type {
    /// Returns the type of what lists and maps hold in the end; itself for any other.
    pub(crate) fn innermost(self) -> Self {
        match self {
            Self::List(inside, _) | Self::Map(inside, _) => inside().innermost(),
            other => other,
        }
    }

    /// Returns the fields of the object, or those of all variants.
    pub(crate) fn fields(self) -> impl Iterator<Item = &'static Field> {
        let object = self.object().map_or(&[][..], |object| object.fields);
        let variants = self.variants().iter();
        object
            .iter()
            .chain(variants.flat_map(|variant| variant.fields()))
    }
}

impl Type {
    /// Returns the fields of the object, or those of all variants, each followed by those of its own
    /// type; each once.
    pub(crate) fn all_fields(self) -> Vec<&'static Field> {
        let mut found = Vec::new();
        self.add_fields(&mut found);
        found
    }

    fn add_fields(self, found: &mut Vec<&'static Field>) {
        for field in self.innermost().fields() {
            if !found.iter().any(|other| ptr::eq(*other, field)) {
                found.push(field);
                (field.of_type)().add_fields(found);
            }
        }
    }

    /// Returns a field of an object.
    pub(crate) fn field(self, name: &str) -> Option<&'static Field> {
        let mut fields = self.object()?.fields.iter();
        fields.find(|field| field.name == name)
    }

    /// Returns the object of which it is the type.
    pub(crate) const fn object(self) -> Option<&'static Object> {
        match self {
            Self::Object(object, _) => Some(object),
            _ => None,
        }
    }

    /// Returns the several of which a value is one.
    pub(crate) const fn one_of(self) -> Option<&'static OneOf> {
        match self {
            Self::OneOf(one_of) => Some(one_of),
            _ => None,
        }
    }

    /// Returns the objects or words of which a value is one.
    pub(crate) fn variants(self) -> &'static [Variant] {
        self.one_of().map_or(&[], |one_of| one_of.variants)
    }

    /// Returns one of them by its name.
    pub(crate) fn variant(self, name: &str) -> Option<Variant> {
        let mut all = self.variants().iter().copied();
        all.find(|one| one.name == name)
    }

    /// Returns the type of the content of a variant; `None` for a word.
    pub(crate) fn content(self, variant: &Variant) -> Option<Self> {
        Some(match (variant.content?(), self) {
            (Self::Object(object, _), Self::OneOf(one_of)) => {
                Self::Object(object, one_of.are_operands)
            }
            (content, _) => content,
        })
    }

    /// Returns the type of what an object, a map or one of several has under a name.
    pub(crate) fn value(self, name: &str) -> Option<Self> {
        match self {
            Self::Object(..) => self.field(name).map(|field| (field.of_type)()),
            Self::Map(value, _) => Some(value()),
            _ => self.content(&self.variant(name)?),
        }
    }

    /// Returns the type of an element of a list or of several numbers.
    pub(crate) fn element(self) -> Option<Self> {
        match self {
            Self::List(element, _) | Self::Tuple(element, _) => Some(element()),
            Self::Matrix => Some(Self::Tuple(|| Self::Value(FieldKind::Number), 4)),
            Self::Value(kind) if kind.has_elements() => Some(Self::Value(FieldKind::Number)),
            _ => None,
        }
    }

    /// Returns true for any string that is neither a color nor one of several words.
    pub(crate) const fn is_text(self) -> bool {
        matches!(
            self,
            Self::Text | Self::Name | Self::NameOfGeometry | Self::NameOfMaterial | Self::File(_)
        )
    }

    /// Returns what each value is that it holds in the end, such as `light`, if that is one of several.
    pub(crate) fn noun(self) -> String {
        match self.innermost() {
            Self::OneOf(one_of) => one_of.name.to_ascii_lowercase(),
            _ => String::new(),
        }
    }

    /// Returns the docs.
    pub(crate) const fn docs(self) -> &'static str {
        match self {
            Self::Object(object, _) => object.docs,
            Self::OneOf(one_of) => one_of.docs,
            _ => "",
        }
    }
}

/// An object.
#[derive(Debug)]
pub(crate) struct Object {
    pub(crate) name: &'static str,
    pub(crate) docs: &'static str,
    pub(crate) fields: &'static [Field],
    pub(crate) sets: &'static [Set],
    /// False for a geometry that is not a solid.
    pub(crate) is_solid: bool,
}

/// Fields that are given in place of each other.
#[derive(Debug)]
pub(crate) struct Set {
    /// The fields; those in one list may be given together.
    pub(crate) fields: &'static [&'static [&'static str]],
    pub(crate) needs: Needs,
}

/// The first field that is given of each list of a set.
pub(crate) type GivenFields = Vec<Option<&'static str>>;

impl Set {
    /// Returns the field that is given in place of another one, unless that could be given beside it.
    pub(crate) fn instead_of(&self, field: &str, given: &GivenFields) -> Option<&'static str> {
        let own = self.fields.iter().position(|list| list.contains(&field));
        let own = own.filter(|own| self.needs != Needs::Any && given.get(*own) == Some(&None))?;
        let mut others = given.iter().enumerate().filter(|(at, _)| *at != own);
        others.find_map(|(_, given)| *given)
    }

    /// Returns the first field.
    pub(crate) fn first(&self) -> Option<&'static str> {
        self.fields.first()?.first().copied()
    }
}

/// The number of fields of a set that are given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Needs {
    One,
    AtMostOne,
    /// One or both.
    Any,
}

/// One of several objects or words.
#[derive(Debug)]
pub(crate) struct OneOf {
    pub(crate) name: &'static str,
    pub(crate) docs: &'static str,
    pub(crate) variants: &'static [Variant],
    /// True if they are inside of a solid.
    pub(crate) are_operands: bool,
}

/// One of several objects or words.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Variant {
    pub(crate) name: &'static str,
    pub(crate) docs: &'static str,
    /// Its names in other programs.
    pub(crate) others: &'static [&'static str],
    /// The type of its content; `None` for a word.
    pub(crate) content: Option<fn() -> Type>,
}

impl Variant {
    /// Returns the object, if it is one.
    pub(crate) fn object(self) -> Option<&'static Object> {
        self.content?().object()
    }

    /// Returns the fields of the object.
    pub(crate) fn fields(self) -> &'static [Field] {
        self.object().map_or(&[], |object| object.fields)
    }
}

/// What a visitor of the things inside of another one sees; it may end the visit.
pub(crate) type See<'a, 'm> = &'a mut dyn FnMut(Step, &'m dyn Thing) -> ControlFlow<()>;

/// A thing that can be read and written.
pub(crate) trait Record: Thing + Serialize + DeserializeOwned {}

impl<T: Thing + Serialize + DeserializeOwned> Record for T {}

/// What follows the steps of a path into a thing.
pub(crate) trait Follow: Sized {
    type Out;

    /// Goes on in a thing, which may be an optional one that is not given.
    fn thing<T: Record>(self, thing: &mut T) -> Self::Out;

    /// Ends at a value, which has no fields.
    fn value<T: Serialize + DeserializeOwned>(self, value: &mut T) -> Self::Out;
}

/// A thing of the format: an object, one of several objects, a list, or a map.
pub(crate) trait Thing {
    /// Returns the type.
    fn of_type() -> Type
    where
        Self: Sized;

    /// Returns what it passes everything on to: the object that it is one of, or what is in a pointer.
    fn inner(&self) -> Option<&dyn Thing> {
        None
    }

    /// The same, writable.
    fn inner_mut(&mut self) -> Option<&mut dyn Thing> {
        None
    }

    /// Returns the fields; a list and a map have none.
    fn fields(&self) -> &'static [Field] {
        self.inner().map_or(&[], |inner| inner.fields())
    }

    /// Returns the fields that are given in place of each other, and which of them are given.
    fn sets(&self) -> Vec<(&'static Set, GivenFields)> {
        self.inner().map_or_else(Vec::new, |inner| inner.sets())
    }

    /// Calls `see` for every field that is given and has a value.
    fn each<'m>(&'m self, _see: impl FnMut(&'static Field, Value<'m>))
    where
        Self: Sized,
    {
    }

    /// Returns true if a number, a vector or a color is given, or has a default.
    fn has(&self, field: &str) -> bool {
        self.inner().is_some_and(|inner| inner.has(field))
    }

    /// Returns the slot of a field's value; an optional field with a default is set to it.
    fn slot(&mut self, field: &str) -> Option<Slot<'_>> {
        self.inner_mut()?.slot(field)
    }

    /// Calls `see` with each thing inside of it.
    fn things<'m>(&'m self, see: See<'_, 'm>) -> ControlFlow<()> {
        let inner = self.inner();
        inner.map_or(ControlFlow::Continue(()), |inner| inner.things(see))
    }

    /// Returns the steps to the things inside of it.
    fn steps(&self) -> Vec<Step> {
        let mut steps = Vec::new();
        let _ = self.things(&mut |step, _| {
            steps.push(step);
            ControlFlow::Continue(())
        });
        steps
    }

    /// Returns the thing inside of it that a step leads to, and the step.
    fn at<'m>(&'m self, step: &Step) -> Option<(Step, &'m dyn Thing)> {
        if let Some(inner) = self.inner() {
            return inner.at(step);
        }
        let mut found = None;
        let _ = self.things(&mut |other, thing| {
            if !other.leads_as(step) {
                return ControlFlow::Continue(());
            }
            found = Some((other, thing));
            ControlFlow::Break(())
        });
        found
    }

    /// Returns false for an optional thing that is not given.
    fn is_given(&self) -> bool {
        true
    }

    /// Returns the name of the variant that it is.
    fn variant(&self) -> Option<&'static str> {
        self.inner()?.variant()
    }

    /// Leads to what is at a step, or returns `follow` if the step leads nowhere.
    fn enter<F: Follow>(&mut self, _step: &Step, follow: F) -> Result<F::Out, F>
    where
        Self: Sized,
    {
        Err(follow)
    }

    /// Removes an entry of a map; returns false if there is no such entry.
    fn remove(&mut self, step: &Step) -> bool {
        self.inner_mut().is_some_and(|inner| inner.remove(step))
    }
}

impl<T: Record> Thing for Vec<T> {
    fn of_type() -> Type {
        Type::List(T::of_type, 0)
    }

    fn enter<F: Follow>(&mut self, step: &Step, follow: F) -> Result<F::Out, F> {
        let Step::Index(index) = step else {
            return Err(follow);
        };
        match self.get_mut(*index) {
            Some(item) => Ok(follow.thing(item)),
            None => Err(follow),
        }
    }

    fn things<'m>(&'m self, see: See<'_, 'm>) -> ControlFlow<()> {
        let mut items = self.iter().enumerate();
        items.try_for_each(|(index, item)| see(Step::Index(index), item))
    }

    fn at<'m>(&'m self, step: &Step) -> Option<(Step, &'m dyn Thing)> {
        match step {
            Step::Index(index) => Some((step.clone(), self.get(*index)?)),
            _ => None,
        }
    }
}

impl<T: Record + for<'de> Entry<'de>> Thing for Map<T> {
    fn of_type() -> Type {
        Type::Map(T::of_type, None)
    }

    fn enter<F: Follow>(&mut self, step: &Step, follow: F) -> Result<F::Out, F> {
        let mut entries = self.0.iter_mut();
        match entries.find(|(name, _)| step.name() == Some(&**name)) {
            Some((_, item)) => Ok(follow.thing(item)),
            None => Err(follow),
        }
    }

    fn remove(&mut self, step: &Step) -> bool {
        let count = self.0.len();
        self.0.retain(|(name, _)| step.name() != Some(&**name));
        self.0.len() < count
    }

    fn things<'m>(&'m self, see: See<'_, 'm>) -> ControlFlow<()> {
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

            fn inner(&self) -> Option<&dyn Thing> {
                Some(&**self)
            }

            fn inner_mut(&mut self) -> Option<&mut dyn Thing> {
                let $self = self;
                Some($writable)
            }

            #[inline]
            fn each<'m>(&'m self, see: impl FnMut(&'static Field, Value<'m>)) {
                (**self).each(see);
            }

            fn enter<F: Follow>(&mut self, step: &Step, follow: F) -> Result<F::Out, F> {
                let $self = self;
                T::enter($writable, step, follow)
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

    fn inner(&self) -> Option<&dyn Thing> {
        self.as_ref().map(|thing| thing as &dyn Thing)
    }

    fn inner_mut(&mut self) -> Option<&mut dyn Thing> {
        self.as_mut().map(|thing| thing as &mut dyn Thing)
    }

    fn each<'m>(&'m self, see: impl FnMut(&'static Field, Value<'m>)) {
        if let Some(thing) = self {
            thing.each(see);
        }
    }

    fn is_given(&self) -> bool {
        self.is_some()
    }

    fn enter<F: Follow>(&mut self, step: &Step, follow: F) -> Result<F::Out, F> {
        match self {
            Some(thing) => thing.enter(step, follow),
            None => Err(follow),
        }
    }
}
