//! Operations on the text of a document: formatting, fixes, edits, and conversion between offsets
//! and paths.

use std::{ops::Range, sync::Arc};

use crate::{
    diagnostic::{Code, Diagnostic, error::Error, path::Path},
    parallel::timings::Timings,
    scene::{
        additions::is_of,
        animation::frames::Frames,
        assist::completion::{ColorPlace, Completions, Hover},
        check::check,
        convert::{self, LostComments},
        document::Document,
        format::{camera::CameraModel, scene::Model},
        framing::{Framing, Known, Subject},
        locate::{path_at, range_of},
        look::Look,
        origin::Origin,
        path,
        source::Source,
    },
    text::{
        edit::{self, Edit},
        lines::Lines,
        syntax::{Comment, max_faults},
    },
};

impl Document {
    /// Applies all safe fixes and returns the text and the number of fixed faults; `None` if there
    /// are none. Comments are kept. The syntax tree is dropped meanwhile to save its memory.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Document, Syntax};
    ///
    /// let text = "(camera: Orthographic(eye: (0, 0, 9), gaze: [0, 0, -1], scale: \"2\") geometry: [])";
    /// let mut document = Document::from_text("mine.ron", text, Syntax::Ron);
    /// let (fixed, count) = document.fixed().unwrap();
    /// let expected = "(camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 2), geometries: [])";
    /// assert_eq!((&*fixed, count), (expected, 4));
    /// ```
    pub fn fixed(&mut self) -> Option<(String, usize)> {
        /// One fault may hide another, but not without end.
        const MOST_ROUNDS: usize = 100;
        if let Some(source) = Arc::get_mut(&mut self.source) {
            source.drop_tree();
        }
        let mut text = self.text().to_owned();
        let mut count = 0;
        let (mut fixes, mut before) = safe_fixes(self.checked.diagnostics.iter().cloned());
        let most = max_faults(text.len());
        let options = self.options.clone().without_tables();
        let options = options.max_diagnostics(most);
        for _ in 0..MOST_ROUNDS {
            let (edited, made) = edit::apply(&text, fixes.iter().map(|edits| &**edits));
            if made == 0 {
                break;
            }
            drop(fixes);
            let timings = Timings::new();
            let source = Source::new(edited, self.syntax());
            let checked = check(&source, None, &options, &timings.watch());
            let after;
            (fixes, after) = safe_fixes(checked.diagnostics);
            // With quotes and brackets beyond repair, a fix may make it worse.
            if after > 0 && after >= before && before < most {
                break;
            }
            (text, count, before) = (source.into_text(), count + made, after);
        }
        (count > 0).then_some((text, count))
    }

    /// Returns the text in the canonical format; `None` if it has syntax faults or is not text.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Document, Syntax};
    ///
    /// let text = "(camera:Orthographic(scale:3,), geometries:[]) // mine";
    /// let document = Document::from_text("mine.ron", text, Syntax::Ron);
    /// let formatted = "(\n    camera: Orthographic(scale: 3),\n    geometries: [],\n) // mine\n";
    /// assert_eq!(document.format().as_deref(), Some(formatted));
    /// ```
    pub fn format(&self) -> Option<String> {
        let is_syntax = |fault: &Diagnostic| fault.code == Code::Syntax;
        if !self.is_text || self.checked.diagnostics.iter().any(is_syntax) {
            return None;
        }
        self.source.format()
    }

    /// Replaces a range of the text, then reads and checks it again with the same options.
    ///
    /// # Errors
    ///
    /// Fails if the range is not in the text or splits a character, or on cancellation
    /// ([`ReadOptions::cancel`](crate::ReadOptions::cancel)).
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Document, Syntax};
    ///
    /// let text = "(camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 0), geometries: [])";
    /// let document = Document::from_text("mine.ron", text, Syntax::Ron);
    /// let scale = document.range_of("camera.scale").unwrap();
    /// assert!(!document.edit(scale, "4")?.has_errors());
    /// # Ok::<(), strahl::Error>(())
    /// ```
    pub fn edit(&self, range: Range<usize>, text: &str) -> Result<Self, Error> {
        if self.text().get(range.clone()).is_none() {
            let (from, to) = (range.start, range.end);
            let message = format!("{from}..{to} is not a range of the text");
            return Err(Error::usage(Diagnostic::new(Code::Syntax, 0..0, message)));
        }
        let edit = Edit::replace(range, text);
        self.edited([&[edit][..]])
    }

    /// Applies edits to the text, then reads and checks it again.
    fn edited<'e>(&self, edits: impl IntoIterator<Item = &'e [Edit]>) -> Result<Self, Error> {
        let (text, _) = edit::apply(self.text(), edits);
        let (name, options) = (self.name.clone(), self.options.clone());
        Self::checked(name, text, self.syntax(), options).unless_cancelled()
    }

    /// Replaces each camera `Fit` in the text by the camera that it becomes in a picture of the
    /// scene's size, then reads and checks it again with the same options. Returns the comments that
    /// are lost, those within a `Fit`.
    ///
    /// # Errors
    ///
    /// Fails if the scene has errors, or if an animation changes a `Fit`.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Document, Syntax};
    ///
    /// let text = "(camera: Fit(from: (0, 0, 3), projection: Orthographic(), margin: 0), /* a ball */
    ///     image: (width: 5, height: 5),
    ///     geometries: [Sphere(center: (0, 0, 0), radius: 5, color: \"#f00\")])";
    /// let document = Document::from_text("mine.ron", text, Syntax::Ron);
    /// let (explicit, lost) = document.with_explicit_cameras()?;
    /// let camera = "Orthographic(eye:(0,0,15),gaze:(0,0,-3),scale:8), /* a ball */";
    /// assert!(explicit.text().contains(camera));
    /// assert_eq!(lost, None);
    /// # Ok::<(), strahl::Error>(())
    /// ```
    pub fn with_explicit_cameras(&self) -> Result<(Self, Option<LostComments>), Error> {
        let (model, tables) = self.model_and_tables()?;
        let frames = Frames::of(&model);
        let known = Known::default();
        let framing = Framing {
            subject: Subject::Scene(&model, &tables),
            frames: frames.as_ref(),
            known: &known,
            cancel: self.options.canceller(),
        };
        let refused = |message: String| Error::refused(message);
        let tree = self.source.tree();
        let mut edits = Vec::new();
        let mut lost: Vec<Range<usize>> = Vec::new();
        for (name, camera) in model.all_cameras() {
            let CameraModel::Fit(fit) = camera else {
                continue;
            };
            let path = Model::path_of_camera(name);
            let changes = frames.iter().flat_map(Frames::targets);
            let mut changes = changes.filter(|(_, target)| target.owner.is_in(&path));
            if let Some((track, _)) = changes.next() {
                return Err(refused(format!(
                    "{}: `{path}` cannot become one camera, because the track `{track}` changes it; \
                     remove the track",
                    self.name()
                )));
            }
            let explicit = framing.explicit(fit, model.sides());
            let explicit =
                explicit.map_err(|error| refused(format!("{}: {error}", self.name())))?;
            // A setting may have given the camera, which the text does not have.
            let range = range_of(self.text(), tree, path.steps());
            let range = range.ok_or_else(|| refused(format!("`{path}` is not in the text")))?;
            lost.extend(tree.comments_in(range.clone()).iter().map(Comment::range));
            edits.push(vec![Edit::replace(
                range,
                convert::short(&explicit, self.syntax()),
            )]);
        }
        let edits = edits.iter().map(|edits| &**edits);
        Ok((self.edited(edits)?, self.lost(&lost)))
    }

    /// Returns what is lost with comments, given their ranges.
    fn lost(&self, comments: &[Range<usize>]) -> Option<LostComments> {
        comments.first().map(|first| LostComments {
            count: comments.len(),
            line: self.lines().position(first.start).line,
        })
    }

    /// Writes a look in place of the lights and of the `lighting` of the text, then reads and checks it again
    /// with the same options. Returns the comments that are lost, those within what is replaced.
    ///
    /// # Errors
    ///
    /// Fails if the scene has errors, or if an animation changes its lights.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Document, Syntax, scene::Look};
    ///
    /// let text = "(camera: Perspective(eye: (0, 0, 9), gaze: (0, 0, -1), fov: 30), lights: [], \
    ///     geometries: [Sphere(center: (0, 0, 0), radius: 1, color: \"#ff0000\")])";
    /// let document = Document::from_text("mine.ron", text, Syntax::Ron);
    /// let (lit, lost) = document.with_look(Look::Studio)?;
    /// assert!(lit.text().contains("lighting: Path(samples:256), geometries: ["));
    /// assert!(lit.diagnostics().is_empty() && lost.is_none());
    /// # Ok::<(), strahl::Error>(())
    /// ```
    pub fn with_look(&self, look: Look) -> Result<(Self, Option<LostComments>), Error> {
        let (model, _) = self.model_and_tables()?;
        let frames = Frames::of(&model);
        let mut tracks = frames
            .iter()
            .flat_map(Frames::targets)
            .map(|(track, _)| track);
        if let Some(track) = tracks.find(|track| is_of(track, &Look::FIELDS)) {
            return Err(Error::refused(format!(
                "{}: the lights cannot be replaced, because the track `{track}` changes them; remove the track",
                self.name()
            )));
        }
        let (syntax, tree) = (self.syntax(), self.source.tree());
        let values = [
            convert::short(&look.lights(&model), syntax),
            convert::short(&look.lighting(), syntax),
        ];
        let range = |name| range_of(self.text(), tree, Path::ROOT.field(name).steps());
        let (mut edits, mut lost, mut added) = (Vec::new(), Vec::new(), String::new());
        for (name, value) in Look::FIELDS.into_iter().zip(values) {
            match range(name) {
                Some(range) => {
                    lost.extend(tree.comments_in(range.clone()).iter().map(Comment::range));
                    edits.push(Edit::replace(range, value));
                }
                None => added += &format!("{}{value}, ", syntax.key(name)),
            }
        }
        let list = range(Model::LONG);
        let mut fields = tree.root().into_iter().flat_map(|root| tree.fields(root));
        if let Some((key, _)) = fields.find(|(_, value)| Some(tree.node(*value).range()) == list) {
            edits.push(Edit::insert(tree.node(key).range().start, added));
        }
        Ok((self.edited([&*edits])?, self.lost(&lost)))
    }

    /// The lines of the text.
    pub fn lines(&self) -> Lines<'_> {
        Lines::new(self.text())
    }

    /// Returns the path of the innermost value at an offset, such as `geometries[3].radius`: for a
    /// key the path of its value, for the scene itself an empty one.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Document, Syntax};
    ///
    /// let text = r#"{"camera": {"Orthographic": {"eye": [0, 0, 9]}}}"#;
    /// let document = Document::from_text("mine.json", text, Syntax::Json);
    /// assert_eq!(document.path_at(text.find('9').unwrap()), "camera.eye[2]");
    /// assert_eq!(document.path_at(text.find("eye").unwrap()), "camera.eye");
    /// ```
    pub fn path_at(&self, offset: usize) -> String {
        path_at(self.text(), self.source.tree(), offset).to_string()
    }

    /// Returns the index of the geometry whose text is at an offset.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Document, Syntax};
    ///
    /// let text = "(geometries: [Plane(), Sphere(radius: 2)])";
    /// let document = Document::from_text("mine.ron", text, Syntax::Ron);
    /// assert_eq!(document.geometry_at(text.find('2').unwrap()), Some("geometries[1]".parse().unwrap()));
    /// assert_eq!(document.geometry_at(3), None);
    /// ```
    pub fn geometry_at(&self, offset: usize) -> Option<Origin> {
        Origin::around(&path_at(self.text(), self.source.tree(), offset))
    }

    /// Returns the range of the value at a path; `None` if the text has none.
    pub fn range_of(&self, path: &str) -> Option<Range<usize>> {
        let parts = path::parts(path).ok()?;
        let steps: Vec<_> = parts.into_iter().map(|part| part.step).collect();
        range_of(self.text(), self.source.tree(), &steps)
    }
}

/// Returns the edits of the safe fixes, and the number of syntax faults.
fn safe_fixes(faults: impl IntoIterator<Item = Diagnostic>) -> (Vec<Vec<Edit>>, usize) {
    let mut of_syntax = 0;
    let mut fixes = Vec::new();
    for fault in faults {
        of_syntax += usize::from(fault.code == Code::Syntax);
        fixes.extend(fault.fix.filter(|fix| fix.is_safe).map(|fix| fix.edits));
    }
    (fixes, of_syntax)
}

impl Document {
    /// Returns the texts that fit at an offset, which may be in a broken part.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Document, Syntax};
    ///
    /// let text = "(camera: Perspective(eye: (0, 0, 9), ga";
    /// let document = Document::from_text("mine.ron", text, Syntax::Ron);
    /// let found = document.completions(text.len());
    /// assert_eq!(&text[found.range], "ga");
    /// assert!(found.items.iter().any(|item| item.insert == "gaze: "));
    /// ```
    pub fn completions(&self, offset: usize) -> Completions {
        self.source().completions(offset, &self.options)
    }

    /// Returns the meaning of the name or value at an offset.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Document, Syntax};
    ///
    /// let text = "(camera: Perspective(fov: 60))";
    /// let document = Document::from_text("mine.ron", text, Syntax::Ron);
    /// let hover = document.hover(text.find("fov").unwrap()).unwrap();
    /// assert_eq!(hover.title, "fov: number, above 0, below 180, required");
    /// ```
    pub fn hover(&self, offset: usize) -> Option<Hover> {
        self.source().hover(offset)
    }

    /// Returns the colors in a range of the text, in its order.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Document, Syntax};
    ///
    /// let text = r##"(background: "#fff", geometries: [Sphere(color: (1, 0.5, 0))])"##;
    /// let document = Document::from_text("mine.ron", text, Syntax::Ron);
    /// let colors = document.colors(0..text.len());
    /// assert_eq!(colors[1].color.to_rgb8(), [255, 128, 0]);
    /// ```
    pub fn colors(&self, within: Range<usize>) -> Vec<ColorPlace> {
        self.source().colors(within, usize::MAX)
    }
}
