//! Help with writing the text of a document.

use std::ops::Range;

use crate::scene::{
    assist::{ColorPlace, Completions, Hover},
    document::Document,
};

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
