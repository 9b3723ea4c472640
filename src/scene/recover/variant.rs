//! A variant of an enum: its name and its content.

use std::ops::Range;

use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, VariantAccess, Visitor, value::StrDeserializer,
};

use crate::{
    diagnostic::{Code, Diagnostic, Fix, path::Trail},
    scene::{
        format::{
            geometry::{inside::FIELD_NAMES, solid::SOLIDS},
            material::NamedModel,
            scene::Model,
        },
        near::near,
        read::reader::{Misfit, Result},
        recover::{
            access::{Elements, Fields, fields, given_fields, stand_ins},
            elsewhere::absent,
            fix, foreign, nameless,
            text::{Text, VariantText},
        },
    },
    text::{
        edit::Edit,
        nearest::{list, one_of, quote},
        syntax::{NodeId, NodeKind, Syntax, string},
    },
};

/// A given variant, or a stand-in for one.
pub(super) struct Variant<'a, 'p> {
    document: Text<'a>,
    path: &'p Trail<'p>,
    name: &'static str,
    given: Option<Given>,
}

/// The given parts of a variant.
struct Given {
    /// The place of the name.
    place: Range<usize>,
    /// The content after the name; in RON the whole value.
    body: Option<NodeId>,
    /// The whole value.
    whole: NodeId,
}

impl<'a, 'p> Variant<'a, 'p> {
    /// Returns any variant, for use as a stand-in.
    pub(super) fn stand_in(
        document: Text<'a>,
        path: &'p Trail<'p>,
        variants: &'static [&'static str],
    ) -> Self {
        Self {
            document,
            path,
            name: variants.first().copied().unwrap_or_default(),
            given: None,
        }
    }

    /// Reads the variant in the node `id`.
    pub(super) fn of(
        document: Text<'a>,
        path: &'p Trail<'p>,
        id: NodeId,
        variants: &'static [&'static str],
    ) -> Self {
        let stand_in = Self::stand_in(document, path, variants);
        let Some(written) = VariantText::of(document.text, document.tree, id) else {
            let variants = fitting(path, variants);
            document.replace(id, no_variant(document, path, id, variants));
            return stand_in;
        };
        let given = Given {
            place: written.place,
            body: written.body,
            whole: id,
        };
        let spelt = written.name;
        let mut all = variants.iter().copied();
        if let Some(name) = all.find(|variant| *variant == spelt) {
            return Self {
                name,
                given: Some(given),
                ..stand_in
            };
        }
        let variants = fitting(path, variants);
        let other = absent(&spelt);
        let meant = near(&spelt, variants).filter(|_| other.is_none());
        let message = format!(
            "unknown variant {}, expected {}",
            quote(&spelt),
            one_of(variants, meant.is_some() || other.is_some())
        );
        let mut diagnostic =
            Diagnostic::new(Code::UnknownVariant, given.place.clone(), message).with_path(path);
        diagnostic.fix = meant.map(|name| fix::renamed(document, given.place.clone(), name));
        diagnostic.help = Some(match meant {
            Some(meant) => format!("did you mean `{meant}`?"),
            None if has_names(variants) && given.body.is_none() => {
                by_name(document.tree.syntax(), document.slice(given.place.clone()))
            }
            None if other.is_some() => other.unwrap_or_default(),
            None => format!(
                "strahl {} has no others; choose one of these, or remove it",
                env!("CARGO_PKG_VERSION")
            ),
        });
        match meant {
            // The content is checked as if the name were right.
            Some(name) => {
                document.note(diagnostic);
                Self {
                    name,
                    given: Some(given),
                    ..stand_in
                }
            }
            None => {
                document.replace(id, diagnostic);
                stand_in
            }
        }
    }
}

impl Given {
    /// Returns true if there is nothing in the brackets after the name.
    fn has_no_content(&self, document: Text<'_>) -> bool {
        let tree = document.tree;
        let is_empty = |body| tree.children(body).next().is_none();
        self.body.is_none_or(is_empty) && tree.comments_in(tree.node(self.whole).range()).is_empty()
    }
}

/// Returns the variants that are valid at a path: inside of a solid only solids.
fn fitting(path: &Trail<'_>, variants: &'static [&'static str]) -> &'static [&'static str] {
    let field = path.last_field();
    match field.is_some_and(|field| field != Model::LONG && FIELD_NAMES.contains(&field)) {
        true => &SOLIDS,
        false => variants,
    }
}

/// Returns true if one of the variants names something that is defined elsewhere.
fn has_names(variants: &[&str]) -> bool {
    variants.contains(&NamedModel::VARIANT)
}

/// The help for someone who wrote the name of a material, maybe in quotes, where one is expected.
fn by_name(syntax: Syntax, name: &str) -> String {
    let (name, variant) = (name.trim_matches('"'), NamedModel::VARIANT);
    let spelt = syntax.holding(variant, &format!("\"{name}\""));
    format!("to name one of `materials`, write `{spelt}`")
}

fn no_variant(
    document: Text<'_>,
    path: &Trail<'_>,
    id: NodeId,
    variants: &'static [&'static str],
) -> Diagnostic {
    let expected = format!("one of the variants {}", list(variants));
    let first = variants.first().copied().unwrap_or_default();
    let diagnostic = document.wrong_type(id, path, expected);
    let kind = document.tree.node(id).kind();
    if let Some((help, fix)) = foreign::tagged(document, id, variants) {
        return diagnostic.with_help(help).with_fix(fix);
    }
    match document.tree.syntax() {
        Syntax::Ron if kind == NodeKind::String => {
            let text = document.source(id);
            let spelt = string(text, Syntax::Ron).unwrap_or_default();
            match variants.iter().find(|variant| **variant == spelt) {
                Some(name) => {
                    diagnostic.with_help(format!("write the name without quotes: `{name}`"))
                }
                None if has_names(variants) => diagnostic.with_help(by_name(Syntax::Ron, text)),
                None => diagnostic,
            }
        }
        Syntax::Ron if matches!(kind, NodeKind::Struct | NodeKind::Tuple | NodeKind::Unit) => {
            let (meant, fix) = match foreign::unnamed(document, id, variants) {
                Some(meant) => {
                    let start = document.tree.node(id).range().start;
                    (meant, Some(Fix::safe([Edit::insert(start, meant)])))
                }
                None => (first, None),
            };
            let help = format!("write its name before the bracket: `{meant}(…)`");
            diagnostic.with_help(help).with_fix(fix)
        }
        Syntax::Json if kind == NodeKind::Map => {
            let keys = document.tree.fields(id);
            let keys: Vec<_> = keys.map(|(key, _)| document.source(key)).collect();
            let is = |key: &str, variant: &str| key.trim_matches('"') == variant;
            let given = variants
                .iter()
                .find(|variant| keys.iter().any(|key| is(key, variant)));
            if let (Some(name), Some(other)) = (
                given,
                keys.iter()
                    .find(|key| !variants.iter().any(|variant| is(key, variant))),
            ) {
                let help = format!("write `{other}` into the object of `{name}`");
                return diagnostic.with_help(help);
            }
            let meant = foreign::unnamed(document, id, variants);
            let name = given.copied().or(meant).unwrap_or(first);
            diagnostic.with_help(format!(
                "a variant is an object with one key, its name: `{{\"{name}\": {{…}}}}`"
            ))
        }
        _ if kind == NodeKind::List => {
            let fix = fix::alone(document, id);
            let help = match (path.last_field(), &fix) {
                (Some("of"), Some(_)) => "`of` is one solid: write it without the square brackets",
                (Some("of"), None) => "`of` is one solid; `Union(of: […])` is one of several",
                (_, Some(_)) => "write it without the square brackets",
                (_, None) => return diagnostic,
            };
            diagnostic.with_help(help).with_fix(fix)
        }
        _ => diagnostic,
    }
}

impl Variant<'_, '_> {
    /// Returns the value in the brackets of a variant, in JSON its value, if it is of this kind;
    /// reports all else.
    fn content(&self, kind: NodeKind, expected: &str, example: &str) -> Option<NodeId> {
        let (document, name) = (self.document, self.name);
        let Given { body, whole, .. } = self.given.as_ref()?;
        let tree = document.tree;
        let inside = match tree.syntax() {
            Syntax::Ron => body.and_then(|body| {
                let mut children = tree.children(body);
                let is_tuple = tree.node(body).kind() == NodeKind::Tuple;
                let first = children.next().filter(|_| is_tuple);
                first.filter(|_| children.next().is_none())
            }),
            Syntax::Json => *body,
        };
        let inside = inside.filter(|inside| tree.node(*inside).kind() == kind);
        if inside.is_none() {
            let expected = format!("`{name}` with {expected}");
            let diagnostic = document.wrong_type(*whole, self.path, expected);
            let spelt = tree.syntax().holding(name, example);
            document.replace(*whole, diagnostic.with_help(format!("write `{spelt}`")));
        }
        inside
    }

    /// Returns the fields in the brackets of a variant, in JSON of its value; reports all else.
    fn fields(self, known: &'static [&'static str]) -> Fields {
        let Self {
            document,
            path,
            name,
            given,
        } = self;
        let Some(Given { place, body, whole }) = given else {
            return stand_ins(known);
        };
        let Some(body) = body.filter(|body| has_fields(document, *body)) else {
            // In JSON the name is right if it has content.
            let whole = match (document.tree.syntax(), body) {
                (Syntax::Json, Some(body)) => body,
                _ => whole,
            };
            let expected = expected(document.tree.syntax(), name, body.is_some(), known);
            let (text, tree) = (document.text, document.tree);
            let syntax = tree.syntax();
            let first = known.first().map(|field| syntax.key(field) + "…");
            let spelt = syntax.variant(name, &first.unwrap_or_default());
            let mut diagnostic = document.wrong_type(whole, path, expected);
            diagnostic.help = Some(format!("write `{spelt}`"));
            // A name alone lacks its brackets.
            let opened = || Fix::safe([Edit::replace(place, syntax.variant(name, ""))]);
            diagnostic.fix = body.is_none().then(opened);
            let values: Vec<_> = match (tree.syntax(), body) {
                (Syntax::Ron, Some(body)) => tree.children(body).collect(),
                (Syntax::Json, body) => body.into_iter().collect(),
                (Syntax::Ron, None) => Vec::new(),
            };
            if let Some(names) = nameless::names(text, tree, name, Some(known), &values) {
                diagnostic =
                    nameless::with_names(diagnostic, text, tree, Some(name), &values, &names);
            }
            document.replace(whole, diagnostic);
            return stand_ins(known);
        };
        given_fields(document, path, body, &place, known)
    }
}

impl<'de, 'a, 'p> EnumAccess<'de> for Variant<'a, 'p> {
    type Error = Misfit;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Self)> {
        let name = seed.deserialize(StrDeserializer::<Misfit>::new(self.name))?;
        Ok((name, self))
    }
}

impl<'de> VariantAccess<'de> for Variant<'_, '_> {
    type Error = Misfit;

    fn unit_variant(self) -> Result<()> {
        if let Some(Given {
            body: Some(_),
            whole,
            ..
        }) = self.given
        {
            let (document, name) = (self.document, self.name);
            let expected = format!("`{name}` alone");
            let mut diagnostic = document.wrong_type(whole, self.path, expected);
            let is_empty = self
                .given
                .is_some_and(|given| given.has_no_content(document));
            diagnostic.fix = is_empty.then(|| {
                let place = document.tree.node(whole).range();
                fix::renamed(document, place, name)
            });
            let alone = document.tree.syntax().word(name);
            document.replace(whole, diagnostic.with_help(format!("write `{alone}`")));
        }
        Ok(())
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value> {
        seed.deserialize(self)
    }

    fn tuple_variant<V: Visitor<'de>>(self, _length: usize, _visitor: V) -> Result<V::Value> {
        Err(Misfit)
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        _fields: &'static [&'static str],
        _visitor: V,
    ) -> Result<V::Value> {
        Err(Misfit)
    }
}

/// The content of a variant: a struct whose fields follow the name of the variant.
impl<'de> Deserializer<'de> for Variant<'_, '_> {
    type Error = Misfit;

    fn deserialize_any<V: Visitor<'de>>(self, _visitor: V) -> Result<V::Value> {
        Err(Misfit)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        known: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value> {
        let (document, path) = (self.document, self.path);
        visitor.visit_map(fields(document, path, self.fields(known)))
    }

    /// Reads the string in the brackets of a variant, in JSON its value.
    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        let text = self
            .content(NodeKind::String, "a string", "\"…\"")
            .map(|inside| {
                let document = self.document;
                string(document.source(inside), document.tree.syntax()).unwrap_or_default()
            });
        visitor.visit_str(&text.unwrap_or_default())
    }

    /// Reads the list in the brackets of a variant, in JSON its value.
    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        let list = self.content(NodeKind::List, "a list", "[…]");
        let Self { document, path, .. } = self;
        let children = list.map(|list| document.tree.children(list));
        visitor.visit_seq(Elements::new(document, path, children, false))
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str bytes byte_buf option
        unit unit_struct newtype_struct tuple tuple_struct map enum identifier ignored_any
    }
}

/// Describes a variant that has these fields; `has_body` is true for one with something after its
/// name.
fn expected(syntax: Syntax, name: &str, has_body: bool, known: &[&str]) -> String {
    match (syntax, has_body, known) {
        (Syntax::Json, true, []) => "an empty object".to_owned(),
        (Syntax::Json, true, _) => "an object with named fields".to_owned(),
        (Syntax::Json, false, []) => format!("`{name}` with an empty object"),
        (Syntax::Ron, _, []) => format!("`{name}` with empty brackets"),
        _ => format!("`{name}` with named fields"),
    }
}

/// Returns true if a node is written as a struct; empty brackets are one without fields.
pub(super) fn has_fields(document: Text<'_>, id: NodeId) -> bool {
    let tree = document.tree;
    match (tree.syntax(), tree.node(id).kind()) {
        (Syntax::Ron, NodeKind::Struct | NodeKind::Unit) | (Syntax::Json, NodeKind::Map) => true,
        (Syntax::Ron, NodeKind::Tuple) => tree.children(id).next().is_none(),
        _ => false,
    }
}
