//! Random scenes in every possible spelling: most scenes are valid, and most of their spellings
//! rare.
use crate::{text::syntax::Syntax, tracer::random::Rng};

/// Numbers that both syntaxes accept, then those that only RON accepts, then those that almost no
/// place accepts.
const NUMBERS: [&[&str]; 3] = [
    &[
        "0",
        "1",
        "-1",
        "0.5",
        "-0",
        "-0.0",
        "1e0",
        "1E2",
        "1.5e-3",
        "2e+1",
        "90",
        "0.1",
        "1e-30",
        "0.30000000000000004",
        "5e-324",
        "2.2250738585072014e-308",
        "1e22",
        "1e23",
        "1e308",
        "9007199254740993",
        "18446744073709551615",
        "18446744073709551616",
        "123456789012345678901234567890",
        "0.000000000000000000000012345678901234567",
        "3.14159265358979323846264338327950288",
        "1.00000000000000011102230246251565404",
        "8.5e-7",
        "0.0048828125000000001",
        "1000000",
        "255",
        "4503599627370497.5",
    ],
    &[
        "+1", ".5", "1.", "1_000", "1_0.5_0", "01", "00.5", "1f64", "0.5f64", "2_e1", "1.e1", "-.5",
    ],
    &[
        "1e999", "-1e999", "1f32", "0x10", "0b1", "inf", "-inf", "NaN", "nan", "1_", "_1", "1__0",
        "1e", "--1", "- 1", "1.5.2", "true", "\"1\"", "b'x'", "1..2", "null", "None", "", "1 2",
    ],
];

const COLORS: &[&str] = &[
    "\"#ff0000\"",
    "\"#FfA07a\"",
    "\"#fff\"",
    "\"red\"",
    "\"\"",
    "\"#ff\\u0030000\"",
    "\"é\"",
    "\"a\tb\"",
    "\"#fff",
    "'c'",
    "r\"#fff\"",
    "\"//\"",
    "\"/*\"",
    "\"},{\"",
    "\"),S(\"",
];

const BLANKS: &[&str] = &[
    "",
    " ",
    "\n",
    "\r\n",
    "\t",
    "    ",
    "\n\n  ",
    "// x\n",
    "/* x */",
    "/* /* , */ ) */",
    "/**/",
    "// }, {\r\n",
    "\u{b}",
    "\u{a0}",
    "\u{85}",
    "/",
    "/*",
    "/*/",
];

/// Writes one scene.
struct Writer {
    rng: Rng,
    syntax: Syntax,
    text: String,
    /// One in this many spellings is rare.
    rarity: usize,
}

/// Writes a scene with a few geometries.
pub(super) fn scene(syntax: Syntax, rng: &mut Rng) -> String {
    let rarity = [50, 200, 2000][rng.below(3)];
    let mut writer = Writer {
        rng: Rng(rng.next() | 1),
        syntax,
        text: String::new(),
        rarity,
    };
    writer.scene();
    writer.text
}

impl Writer {
    fn is_ron(&self) -> bool {
        self.syntax == Syntax::Ron
    }

    fn rarely(&mut self) -> bool {
        self.rng.below(self.rarity) == 0
    }

    fn one_of(&mut self, of: &[&'static str]) -> &'static str {
        of[self.rng.below(of.len())]
    }

    fn blank(&mut self) {
        let plain = if self.is_ron() { 12 } else { 7 };
        let count = if self.rarely() { BLANKS.len() } else { plain };
        if self.rng.below(2) == 0 {
            let blank = self.one_of(&BLANKS[..count]);
            self.text.push_str(blank);
        }
    }

    fn token(&mut self, token: &str) {
        self.blank();
        self.text.push_str(token);
        self.blank();
    }

    fn number(&mut self) {
        let any = f64::from_bits(self.rng.next());
        let kind = if self.rarely() {
            self.rng.below(3)
        } else if self.is_ron() && self.rng.below(40) == 0 {
            1
        } else {
            0
        };
        let token = match self.rng.below(8) {
            0 | 1 if any.is_finite() => format!("{any:e}"),
            2 => format!(
                "{:?}",
                (self.rng.next() >> 11) as f64 / (1_u64 << 53) as f64
            ),
            3 => format!("{}.{}", self.rng.below(1000), self.rng.next()),
            _ => self.one_of(NUMBERS[kind]).to_owned(),
        };
        self.token(&token);
    }

    /// Writes items between brackets, separated by commas.
    fn items(&mut self, brackets: [&str; 2], items: &mut [&mut dyn FnMut(&mut Self)]) {
        self.token(brackets[0]);
        let count = items.len();
        for (index, item) in items.iter_mut().enumerate() {
            item(self);
            let trailing = self.is_ron() && self.rng.below(3) == 0;
            if (index + 1 < count || trailing) != self.rarely() {
                self.token(",");
            }
        }
        self.token(brackets[1]);
    }

    fn triple(&mut self) {
        let brackets = if self.is_ron() != self.rarely() {
            ["(", ")"]
        } else {
            ["[", "]"]
        };
        let number = &mut |this: &mut Self| this.number();
        let (mut second, mut third) = (*number, *number);
        self.items(brackets, &mut [number, &mut second, &mut third]);
    }

    /// Writes a list of vertices.
    fn vertices(&mut self) {
        let vertex = &mut |this: &mut Self| this.triple();
        let mut second = *vertex;
        self.items(["[", "]"], &mut [vertex, &mut second]);
    }

    /// Writes a list of triangles.
    fn triangles(&mut self) {
        let corner = &mut |this: &mut Self| this.integer();
        let (mut second, mut third) = (*corner, *corner);
        let brackets = if self.is_ron() {
            ["(", ")"]
        } else {
            ["[", "]"]
        };
        let triangle =
            &mut |this: &mut Self| this.items(brackets, &mut [corner, &mut second, &mut third]);
        self.items(["[", "]"], &mut [triangle]);
    }

    fn color(&mut self) {
        if self.rng.below(3) == 0 {
            let count = if self.rarely() { COLORS.len() } else { 5 };
            let color = self.one_of(&COLORS[..count]);
            self.token(color);
        } else {
            self.triple();
        }
    }

    fn name(&mut self, name: &str) {
        let name = if self.rarely() {
            self.one_of(&["radius", "eye", "x", "r#up", "Sphere", "é", "geometries"])
        } else {
            name
        };
        if self.is_ron() != self.rarely() {
            self.token(name);
        } else {
            self.token(&format!("\"{name}\""));
        }
    }

    /// Writes the value of an optional field.
    fn nothing_or(&mut self, value: fn(&mut Self)) {
        match self.rng.below(6) {
            0 if self.is_ron() => self.token("None"),
            0 => self.token("null"),
            1 if self.rarely() => {
                self.token("Some(");
                value(self);
                self.token(")");
            }
            _ => value(self),
        }
    }

    /// Writes a struct: required fields, then optional ones, in any order.
    fn fields(&mut self, needed: &[Field], optional: &[Field]) {
        let mut fields = needed.to_vec();
        for field in optional {
            if self.rng.below(2) == 0 {
                fields.push(*field);
            }
        }
        for index in (1..fields.len()).rev() {
            if self.rng.below(2) == 0 {
                fields.swap(index, self.rng.below(index + 1));
            }
        }
        if !fields.is_empty() && self.rarely() {
            let field = fields[self.rng.below(fields.len())];
            fields.push(field);
        }
        let mut items: Vec<_> = fields
            .into_iter()
            .map(|(name, value)| {
                move |this: &mut Self| {
                    this.name(name);
                    this.token(":");
                    value(this);
                }
            })
            .collect();
        let mut items: Vec<_> = items.iter_mut().map(|item| item as _).collect();
        let brackets = if self.is_ron() {
            ["(", ")"]
        } else {
            ["{", "}"]
        };
        self.items(brackets, &mut items);
    }

    fn variant(&mut self, name: &str, needed: &[Field], optional: &[Field]) {
        if self.is_ron() {
            self.name(name);
            self.fields(needed, optional);
        } else {
            self.token("{");
            self.name(name);
            self.token(":");
            self.fields(needed, optional);
            self.token("}");
        }
    }

    fn camera(&mut self) {
        let sight: [Field; 3] = [
            ("gaze", |this| this.nothing_or(Self::triple)),
            ("look_at", |this| this.nothing_or(Self::triple)),
            ("up", |this| this.nothing_or(Self::triple)),
        ];
        if self.rng.below(4) == 0 {
            let all: [Field; 4] = [
                ("from", |this| this.nothing_or(Self::triple)),
                ("up", |this| this.nothing_or(Self::triple)),
                ("projection", |this| this.nothing_or(Self::projection)),
                ("margin", |this| this.nothing_or(Self::number)),
            ];
            self.variant("Fit", &[], &all);
        } else if self.rng.below(2) == 0 {
            self.variant(
                "Perspective",
                &[("eye", Self::triple), ("fov", Self::number)],
                &sight,
            );
        } else {
            let stretch: Field = ("stretch", |this| this.nothing_or(Self::truth));
            let optional: Vec<_> = sight.into_iter().chain([stretch]).collect();
            self.variant(
                "Orthographic",
                &[("eye", Self::triple), ("scale", Self::number)],
                &optional,
            );
        }
    }

    fn projection(&mut self) {
        if self.rng.below(2) == 0 {
            self.variant("Perspective", &[("fov", Self::number)], &[]);
        } else {
            self.variant("Orthographic", &[], &[]);
        }
    }

    fn truth(&mut self) {
        let count = if self.rarely() { 6 } else { 2 };
        let token = self.one_of(&["true", "false", "True", "truex", "true1", "1"][..count]);
        self.token(token);
    }

    fn integer(&mut self) {
        let count = if self.rarely() { 16 } else { 4 };
        let token = self.one_of(
            &[
                "1",
                "640",
                "480",
                "1000000",
                "0",
                "4294967295",
                "4294967296",
                "-1",
                "-0",
                "+1",
                "007",
                "1.0",
                "1e2",
                "0x10",
                "1_0",
                "5u32",
            ][..count],
        );
        self.token(token);
    }

    fn geometry(&mut self) {
        let (point, normal): (Field, Field) = (("point", Self::triple), ("normal", Self::triple));
        let center: Field = ("center", Self::triple);
        let radius: Field = ("radius", Self::number);
        let colors: [Field; 2] = [("color", Self::color), ("material", Self::material)];
        let color = self.rng.one(&colors);
        let at = |name: &'static str| -> Field { (name, Self::triple) };
        let ends = [at("from"), at("to")];
        match self.rng.below(16) {
            0 => self.variant("Plane", &[point, normal, color], &[]),
            1 => self.variant("Disc", &[center, normal, radius, color], &[]),
            2 => self.variant(
                "Rectangle",
                &[at("corner"), at("edge_u"), at("edge_v"), color],
                &[],
            ),
            3 => self.variant("Triangle", &[at("a"), at("b"), at("c"), color], &[]),
            4 => self.variant("Box", &[at("min"), at("max"), color], &[]),
            5 => self.variant("Capsule", &[ends[0], ends[1], radius, color], &[]),
            6 => {
                let top: Field = ("top_radius", |this| this.nothing_or(Self::number));
                self.variant("Cone", &[ends[0], ends[1], radius, color, top], &[]);
            }
            8 => {
                let vertices: Field = ("vertices", Self::vertices);
                self.variant(
                    "Mesh",
                    &[vertices, ("triangles", Self::triangles), color],
                    &[],
                );
            }
            7 => self.variant("Cylinder", &[ends[0], ends[1], radius, color], &[]),
            9 => self.variant("Group", &[("geometries", Self::geometries)], &[]),
            10 => self.variant("Union", &[("of", Self::geometries), color], &[]),
            11 => {
                let of: Field = ("of", |this| this.geometry());
                self.variant("Difference", &[of, ("minus", Self::geometries)], &[color]);
            }
            _ => self.variant("Sphere", &[center, radius, color], &[]),
        }
    }

    fn material(&mut self) {
        let color: Field = ("color", |this| this.nothing_or(Self::color));
        let reflection: Field = ("reflection", |this| this.nothing_or(Self::color));
        match self.rng.below(7) {
            0 => self.variant("Matte", &[("color", Self::color)], &[]),
            1 => {
                let exponent: Field = ("exponent", |this| this.nothing_or(Self::number));
                self.variant(
                    "Phong",
                    &[("diffuse", Self::color)],
                    &[exponent, reflection],
                );
            }
            2 => self.variant("Mirror", &[], &[color]),
            3 => self.variant("Glass", &[], &[color, ("ior", Self::number)]),
            4 => self.variant(
                "Plastic",
                &[("color", Self::color)],
                &[("roughness", Self::number), ("ior", Self::number)],
            ),
            _ => self.named(),
        }
    }

    /// Writes the name of a material: `Named("gold")`, `{"Named": "gold"}`.
    fn named(&mut self) {
        let [before, after] = if self.is_ron() {
            ["(", ")"]
        } else {
            [":", "}"]
        };
        if !self.is_ron() {
            self.token("{");
        }
        self.name("Named");
        self.token(before);
        self.schema();
        if self.is_ron() && self.rng.below(4) == 0 {
            self.token(",");
        }
        self.token(after);
    }

    fn materials(&mut self) {
        self.token("{");
        self.token("\"gold\"");
        self.token(":");
        self.material();
        self.token("}");
    }

    fn light(&mut self) {
        let color: Field = ("color", |this| this.nothing_or(Self::color));
        let shadows: Field = ("shadows", |this| this.nothing_or(Self::truth));
        let falloff: Field = ("falloff", |this| {
            let name = this.rng.one(&["InverseSquare", "Constant"]);
            this.nameless(name);
        });
        match self.rng.below(3) {
            0 => self.variant("Ambient", &[], &[color, ("intensity", Self::number)]),
            1 => self.variant("Directional", &[("direction", Self::triple)], &[shadows]),
            _ => self.variant(
                "Point",
                &[("position", Self::triple)],
                &[color, falloff, shadows],
            ),
        }
    }

    /// Writes a variant without fields, rarely with brackets.
    fn nameless(&mut self, name: &str) {
        let with_brackets = self.rarely();
        match (self.is_ron(), with_brackets) {
            (true, false) => self.token(name),
            (true, true) => self.token(&format!("{name}()")),
            (false, false) => self.token(&format!("\"{name}\"")),
            (false, true) => self.token(&format!("{{\"{name}\": {{}}}}")),
        }
    }

    fn lights(&mut self) {
        let mut items = vec![Self::light; self.rng.below(4)];
        let mut items: Vec<_> = items.iter_mut().map(|item| item as _).collect();
        self.items(["[", "]"], &mut items);
    }

    fn lighting(&mut self) {
        let max_depth: Field = ("max_depth", Self::integer);
        match self.rng.below(2) {
            0 => self.variant("Direct", &[], &[max_depth]),
            _ => self.variant(
                "Path",
                &[],
                &[
                    max_depth,
                    ("samples", Self::integer),
                    ("diffuse_depth", |this| this.nothing_or(Self::integer)),
                    ("caustics", Self::truth),
                    ("clamp", |this| this.nothing_or(Self::number)),
                    ("seed", Self::integer),
                ],
            ),
        }
    }

    fn outlines(&mut self) {
        let width: Field = ("width", |this| this.nothing_or(Self::number));
        self.fields(&[], &[width, ("color", Self::color)]);
    }

    fn geometries(&mut self) {
        let mut items = vec![Self::geometry; self.rng.below(4)];
        let mut items: Vec<_> = items.iter_mut().map(|item| item as _).collect();
        self.items(["[", "]"], &mut items);
    }

    fn animation(&mut self) {
        self.fields(
            &[("frames", Self::integer)],
            &[
                ("fps", |this| this.nothing_or(Self::number)),
                ("tracks", |this| this.nothing_or(Self::tracks)),
                ("orbit", |this| this.nothing_or(Self::orbit)),
            ],
        );
    }

    fn orbit(&mut self) {
        self.fields(
            &[("around", Self::triple)],
            &[
                ("axis", |this| this.nothing_or(Self::triple)),
                ("turns", |this| this.nothing_or(Self::number)),
            ],
        );
    }

    /// A track of any kind, or of none.
    fn tracks(&mut self) {
        let tracks: [Field; 5] = [
            ("camera.fov", Self::number),
            ("camera.eye", Self::triple),
            ("camera.up[1]", Self::number),
            ("background", Self::color),
            ("camera.é", Self::triple),
        ];
        let count = if self.rarely() { tracks.len() } else { 4 };
        let (path, value) = self.rng.one(&tracks[..count]);
        self.token("{");
        self.token(&format!("\"{path}\""));
        self.token(":");
        let mut keys = vec![|this: &mut Self| this.key(value); self.rng.below(3)];
        let mut keys: Vec<_> = keys.iter_mut().map(|key| key as _).collect();
        self.items(["[", "]"], &mut keys);
        self.token("}");
    }

    fn key(&mut self, value: fn(&mut Self)) {
        let brackets = if self.is_ron() != self.rarely() {
            ["(", ")"]
        } else {
            ["[", "]"]
        };
        let (mut time, mut value) = (Self::number, value);
        let mut step = |this: &mut Self| {
            let step = this.rng.one(&["Step", "Linear", "Smooth"]);
            this.name(step);
        };
        let mut items: Vec<&mut dyn FnMut(&mut Self)> = vec![&mut time, &mut value, &mut step];
        items.truncate(if self.rarely() {
            1
        } else {
            2 + self.rng.below(2)
        });
        self.items(brackets, &mut items);
    }

    fn image(&mut self) {
        if self.is_ron() && self.rng.below(4) == 0 {
            self.name("Image");
        }
        let side: fn(&mut Self) = |this| this.nothing_or(Self::integer);
        self.fields(&[], &[("width", side), ("height", side)]);
    }

    fn allow(&mut self) {
        let names = [
            "\"eye-inside\"",
            "\"empty-scene\"",
            "\"x\"",
            "eye",
            "\"a\\n\"",
        ];
        let count = if self.rarely() { names.len() } else { 3 };
        let name = self.one_of(&names[..count]);
        let mut items = vec![|this: &mut Self| this.token(name); self.rng.below(3)];
        let mut items: Vec<_> = items.iter_mut().map(|item| item as _).collect();
        self.items(["[", "]"], &mut items);
    }

    fn schema(&mut self) {
        let count = if self.rarely() { COLORS.len() } else { 5 };
        let token = self.one_of(&COLORS[..count]);
        self.token(token);
    }

    fn scene(&mut self) {
        if self.rng.below(8) == 0 {
            self.text.push('\u{feff}');
        }
        if self.rarely() {
            self.token("#![enable(implicit_some)]");
        }
        if self.is_ron() && self.rng.below(4) == 0 {
            self.name("Scene");
        }
        let mut optional: Vec<Field> = vec![
            ("version", |this| this.nothing_or(Self::integer)),
            ("image", |this| this.nothing_or(Self::image)),
            ("background", |this| this.nothing_or(Self::color)),
            ("allow", |this| this.nothing_or(Self::allow)),
            ("animation", |this| this.nothing_or(Self::animation)),
            ("lights", |this| this.nothing_or(Self::lights)),
            ("materials", |this| this.nothing_or(Self::materials)),
            ("lighting", |this| this.nothing_or(Self::lighting)),
            ("outlines", |this| this.nothing_or(Self::outlines)),
        ];
        if !self.is_ron() {
            optional.push(("$schema", |this| this.nothing_or(Self::schema)));
        }
        let needed: [Field; 2] = [("camera", Self::camera), ("geometries", Self::geometries)];
        self.fields(&needed, &optional);
        if self.rarely() {
            let more = self.one_of(&["x", ",", "(", "\"", "//", "1"]);
            self.token(more);
        }
        if self.rng.below(4) == 0 {
            self.text = self.text.replace('\n', "\r\n");
        }
    }
}

/// The name of a field and the function that writes its value.
type Field = (&'static str, fn(&mut Writer));
