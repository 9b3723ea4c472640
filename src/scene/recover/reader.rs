//! A deserializer that does not stop: it reports a value that does not fit, and returns a stand-in.

use std::ops::Range;

use serde::de::{Deserializer, Expected, IntoDeserializer, Visitor};

use crate::{
    diagnostic::{
        Code, Diagnostic,
        path::{Step, Trail},
    },
    scene::{
        format::{
            numbers::ScaleModel,
            thing::{Thing, Type},
            transform::{MatrixModel, RotateModel},
        },
        read::reader::{Misfit, Result},
        recover::{
            access::{Elements, Fields, entries, fields, given_fields, stand_ins},
            fix::{Wants, respelt},
            foreign,
            text::{NO_NUMBER, Text},
            variant::{Variant, has_fields},
        },
    },
    text::{
        nearest::quote,
        syntax::{NodeId, NodeKind, NumberError, Syntax, float, name, string, whole},
    },
};

/// The source of a value.
pub(super) enum Value {
    /// A node of the tree.
    Node(NodeId),
    /// A missing field, with the place to report it if it is required.
    Missing {
        field: &'static str,
        place: Range<usize>,
    },
    /// A stand-in, with nothing to report.
    StandIn,
    /// A given but unusable value, whose faults have all been reported.
    Given,
}

/// Reads one value.
pub(super) struct Reader<'a, 'p> {
    pub(super) document: Text<'a>,
    pub(super) value: Value,
    pub(super) path: Trail<'p>,
}

impl<'a, 'p> Reader<'a, 'p> {
    pub(super) const fn new(document: Text<'a>, value: Value, path: Trail<'p>) -> Self {
        Self {
            document,
            value,
            path,
        }
    }

    /// Returns the node, if there is one; reports a missing field and a broken value.
    fn node(&self) -> Option<NodeId> {
        match &self.value {
            Value::Node(id) if self.kind(*id) == NodeKind::Error => {
                self.document.broken(*id, &self.path);
                None
            }
            Value::Node(id) => Some(*id),
            Value::Missing { .. } if self.document.is_counted(Code::MissingField) => None,
            Value::Missing { field, place } => {
                let message = format!("missing field `{field}`");
                let diagnostic = Diagnostic::new(Code::MissingField, place.clone(), message);
                self.document.note(diagnostic.with_path(&self.path));
                None
            }
            Value::StandIn | Value::Given => None,
        }
    }

    /// Returns the node, if there is one of this kind; reports all else.
    fn node_of(
        &self,
        expected: &str,
        wants: Wants,
        is_it: impl Fn(NodeKind) -> bool,
    ) -> Option<NodeId> {
        let id = self.node()?;
        if is_it(self.kind(id)) {
            return Some(id);
        }
        self.document
            .replace(id, self.wrong_type(id, expected, wants));
        None
    }

    fn kind(&self, id: NodeId) -> NodeKind {
        self.document.tree.node(id).kind()
    }

    fn syntax(&self) -> Syntax {
        self.document.tree.syntax()
    }

    /// Reports a value of the wrong type, with its fix if that is obvious.
    fn wrong_type(&self, id: NodeId, expected: &str, wants: Wants) -> Diagnostic {
        let source = self.document.source(id);
        let node = self.document.tree.node(id);
        let named = node.name().map(|range| self.document.slice(range));
        if let Some((help, fix)) = foreign::advice(self.document, id, wants) {
            let diagnostic = self.document.wrong_type(id, &self.path, expected);
            return diagnostic.with_help(help).with_fix(fix);
        }
        let fix = respelt(self.document, id, wants);
        let help = match (node.kind(), named, wants) {
            (NodeKind::Tuple | NodeKind::Struct | NodeKind::Unit, Some("Some"), _) => {
                Some("write the value itself, without `Some`".to_owned())
            }
            (NodeKind::String, _, Wants::Number) if fix.is_some() => {
                let inside = string(source, self.syntax()).unwrap_or_default();
                Some(format!("write it without quotes: `{}`", inside.trim()))
            }
            (NodeKind::List, _, Wants::Tuple | Wants::Color) if self.syntax() == Syntax::Ron => {
                Some("a tuple is written in round brackets".to_owned())
            }
            (NodeKind::Name, _, Wants::Color) => Some(
                "color names are not supported; write `\"#rrggbb\"` or three numbers".to_owned(),
            ),
            (NodeKind::Struct | NodeKind::Map, None, Wants::Color) => {
                Some("write the three numbers alone, without names".to_owned())
            }
            (NodeKind::Struct | NodeKind::Map, None, Wants::Tuple) => {
                Some("write the values alone, without names".to_owned())
            }
            (_, _, Wants::List) if fix.is_some() => {
                Some("a list is written in square brackets".to_owned())
            }
            _ => None,
        };
        let mut diagnostic = self.document.wrong_type(id, &self.path, expected);
        (diagnostic.help, diagnostic.fix) = (help, fix);
        diagnostic
    }

    /// Returns a number as `read` reads it, and `most` for one beyond its range; reports all else.
    fn number<T>(
        &self,
        expected: &str,
        most: T,
        read: impl Fn(&str, Syntax) -> std::result::Result<T, NumberError>,
    ) -> Option<T> {
        let id = self.node_of(expected, Wants::Number, |kind| kind == NodeKind::Number)?;
        match read(self.document.source(id), self.syntax()) {
            Ok(number) => Some(number),
            Err(NumberError::OutOfRange) => Some(most),
            Err(NumberError::OtherType | NumberError::Malformed) => {
                let diagnostic = self.document.wrong_type(id, &self.path, expected);
                self.document.replace(id, diagnostic);
                None
            }
        }
    }

    /// Returns an integer; the largest u32 for one that is negative or larger, which is in the range of
    /// none and which validation reports. The stand-in is 1, which is in the range of all fields. A
    /// corner of a mesh becomes one that no vertex has, so that the area of its triangle is not checked.
    fn integer(&self) -> u32 {
        let read = |source: &str, syntax| {
            let number = whole(source, syntax)?;
            let value = number.value.try_into().ok();
            Ok(value
                .filter(|_| number.fits_its_suffix())
                .unwrap_or(u32::MAX))
        };
        let stand_in = match self.path {
            Trail::Inside(_, Step::Index(_)) => u32::MAX,
            Trail::Inside(..) | Trail::Root => 1,
        };
        self.number("a whole number", u32::MAX, read)
            .unwrap_or(stand_in)
    }

    /// Returns a float; infinite if it is too large, which validation reports.
    fn float(&self) -> f64 {
        self.number("a number", f64::INFINITY, float)
            .unwrap_or(NO_NUMBER)
    }

    /// Returns the elements of a tuple or a list, with the expected `length` if known.
    fn elements<'q>(
        &'q self,
        id: NodeId,
        length: Option<usize>,
        expected: &str,
        wants: Wants,
    ) -> Elements<'a, 'q> {
        let children = self.document.tree.children(id);
        if let Some(length) = length
            && children.clone().count() != length
        {
            let mut diagnostic = self.document.wrong_type(id, &self.path, expected);
            if wants == Wants::Color && children.clone().count() == length + 1 {
                diagnostic.help = Some("a color has no alpha: write three numbers".to_owned());
            }
            self.document.replace(id, diagnostic);
        }
        Elements::new(self.document, &self.path, Some(children), length.is_some())
    }

    /// The elements of a tuple, or stand-ins.
    fn tuple<'q>(&'q self, length: usize, expected: &str, wants: Wants) -> Elements<'a, 'q> {
        match self.node() {
            Some(id) if self.is_tuple(id) => self.elements(id, Some(length), expected, wants),
            other => self.no_tuple(other, expected, wants),
        }
    }

    /// Returns the elements of a key: a time, a value, and optionally a step; or stand-ins.
    fn key<'q>(&'q self, expected: &str) -> Elements<'a, 'q> {
        let count = |id| self.document.tree.children(id).count();
        match self.node() {
            Some(id) if self.is_tuple(id) && matches!(count(id), 2 | 3) => {
                self.elements(id, None, expected, Wants::Tuple)
            }
            other => self.no_tuple(other, expected, Wants::Tuple),
        }
    }

    /// Returns stand-ins for the elements of a value that is not a tuple.
    fn no_tuple<'q>(
        &'q self,
        id: Option<NodeId>,
        expected: &str,
        wants: Wants,
    ) -> Elements<'a, 'q> {
        if let Some(id) = id {
            self.document
                .replace(id, self.wrong_type(id, expected, wants));
        }
        self.no_elements(true)
    }

    fn no_elements(&self, endless: bool) -> Elements<'a, '_> {
        Elements::new(self.document, &self.path, None, endless)
    }

    /// Returns the fields of a struct; reports all else.
    fn fields(&self, struct_name: &str, known: &'static [&'static str]) -> Fields {
        let (document, path) = (self.document, &self.path);
        let Some(id) = self.node() else {
            return stand_ins(known);
        };
        let node = document.tree.node(id);
        if !has_fields(document, id) {
            let expected = match self.syntax() {
                Syntax::Ron => "named fields in round brackets",
                Syntax::Json => "an object with named fields",
            };
            let mut diagnostic = self.wrong_type(id, expected, Wants::Other);
            if (node.kind(), self.syntax()) == (NodeKind::Map, Syntax::Ron)
                && matches!(path, Trail::Root)
            {
                let json = "this looks like JSON: give the file the extension `.json`, or \
                            convert it";
                diagnostic.help = Some(json.to_owned());
            }
            if matches!(RotateModel::of_type(), Type::Object(object, _) if object.name == struct_name)
                && let Some((help, fix)) = foreign::rotation(document, id)
            {
                diagnostic = diagnostic.with_help(help).with_fix(fix);
            }
            document.replace(id, diagnostic);
            return stand_ins(known);
        }
        let mut bracket = node.range().start;
        if let Some(range) = node.name() {
            bracket = document
                .tree
                .bracket_after(document.text, range.end, node.range().end);
            let spelt = document.slice(range.clone());
            if name(spelt) != struct_name {
                let message = format!(
                    "unexpected name {}, expected `{struct_name}` or none",
                    quote(spelt)
                );
                let help = self.wrong_type(id, struct_name, Wants::Other).help;
                let mut diagnostic = Diagnostic::new(Code::WrongType, range, message);
                diagnostic.help = help;
                document.note(diagnostic.with_path(path));
            }
        }
        let place = bracket..bracket + 1;
        given_fields(document, path, id, &place, known)
    }

    /// Returns true if a node is written as a tuple.
    fn is_tuple(&self, id: NodeId) -> bool {
        match (self.syntax(), self.kind(id)) {
            (Syntax::Ron, NodeKind::Tuple | NodeKind::Unit) => {
                self.document.tree.node(id).name().is_none()
            }
            (Syntax::Json, NodeKind::List) => true,
            _ => false,
        }
    }
}

impl<'de> IntoDeserializer<'de, Misfit> for Reader<'_, '_> {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

impl<'de> Deserializer<'de> for Reader<'_, '_> {
    type Error = Misfit;

    fn deserialize_u32<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        visitor.visit_u32(self.integer())
    }

    /// A color: a string or three numbers. A scale: a number or three numbers.
    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        /// Number of channels in a color, and of axes.
        const LENGTH: usize = 3;
        let expected = (&visitor as &dyn Expected).to_string();
        if expected == ScaleModel::EXPECTED {
            return match self.value {
                Value::Node(id) if self.kind(id) == NodeKind::Number => {
                    visitor.visit_f64(self.float())
                }
                _ => visitor.visit_seq(self.tuple(LENGTH, &expected, Wants::Tuple)),
            };
        }
        if let Value::Node(id) = self.value
            && self.kind(id) == NodeKind::String
        {
            let source = self.document.source(id);
            return visitor.visit_str(&string(source, self.syntax()).unwrap_or_default());
        }
        visitor.visit_seq(self.tuple(LENGTH, &expected, Wants::Color))
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        let expected = "`true` or `false`";
        let id = self.node_of(expected, Wants::Other, |kind| {
            matches!(kind, NodeKind::Bool(_))
        });
        visitor.visit_bool(id.is_some_and(|id| self.kind(id) == NodeKind::Bool(true)))
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        visitor.visit_f64(self.float())
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        let id = self.node_of("a string", Wants::Other, |kind| kind == NodeKind::String);
        let text = id.and_then(|id| string(self.document.source(id), self.syntax()));
        visitor.visit_str(&text.unwrap_or_default())
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        self.deserialize_str(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        match &self.value {
            Value::Missing { .. } | Value::StandIn => visitor.visit_none(),
            Value::Node(id) if self.kind(*id) == NodeKind::Null => visitor.visit_none(),
            Value::Node(_) | Value::Given => visitor.visit_some(self),
        }
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        let expected = match self.syntax() {
            Syntax::Ron => "a list `[…]`",
            Syntax::Json => "an array `[…]`",
        };
        match self.node_of(expected, Wants::List, |kind| kind == NodeKind::List) {
            Some(id) => visitor.visit_seq(self.elements(id, None, expected, Wants::List)),
            None => visitor.visit_seq(self.no_elements(false)),
        }
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value> {
        let own = (&visitor as &dyn Expected).to_string();
        let expected = match self.syntax() {
            _ if own == MatrixModel::EXPECTED => own,
            Syntax::Ron => format!("{length} numbers in round brackets"),
            Syntax::Json => format!("an array of {length} numbers"),
        };
        visitor.visit_seq(self.tuple(length, &expected, Wants::Tuple))
    }

    /// Reads a key, the only tuple struct of the format.
    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _length: usize,
        visitor: V,
    ) -> Result<V::Value> {
        let expected = (&visitor as &dyn Expected).to_string();
        visitor.visit_seq(self.key(&expected))
    }

    /// Skips a value that validation will report.
    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        visitor.visit_unit()
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        let expected = match self.syntax() {
            Syntax::Ron => "a map `{\"name\": …}`",
            Syntax::Json => "an object `{\"name\": …}`",
        };
        let id = self.node_of(expected, Wants::Other, |kind| kind == NodeKind::Map);
        visitor.visit_map(entries(self.document, &self.path, id))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        known: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value> {
        let given = self.fields(name, known);
        visitor.visit_map(fields(self.document, &self.path, given))
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value> {
        let (document, path) = (self.document, &self.path);
        visitor.visit_enum(match self.node() {
            Some(id) => Variant::of(document, path, id, variants),
            None => Variant::stand_in(document, path, variants),
        })
    }

    serde::forward_to_deserialize_any! {
        i8 i16 i32 i64 i128 u8 u16 u64 u128 f32 char bytes byte_buf unit unit_struct newtype_struct
        identifier
    }
}
