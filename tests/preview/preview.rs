//! The program under test, with a scene of its own.

use std::{
    fs,
    io::{BufRead, BufReader},
    ops::Deref,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    thread,
};

use tempfile::TempDir;

use super::browser::{Browser, Point, key};

const STRAHL: &str = env!("CARGO_BIN_EXE_strahl");

/// A scene with three geometries, comments and a layout of its own.
pub(crate) const SCENE: &str = r##"(
    image: (width: 64, height: 48), // small
    camera: Perspective(
        eye: (0, 0, /* far */ 5.0), // keep me
        look_at: (0, 0,0), fov: 60),
    background: "#102030",
    geometries: [
        Sphere(center: (-1, 0, 0), radius: 0.8, color: "#ff0000"), // left
        Sphere(center: (1, 0, 0), radius: 0.8, color: "#00ff00", name: "right"),
        Plane(point: (0, -1, 0), normal: (0, 1, 0), color: (0.5, 0.5, 0.5)),
    ],
)
"##;

/// `strahl preview`, which ends with this value.
pub(crate) struct Preview {
    process: Child,
    folder: TempDir,
    scene: PathBuf,
    /// The address that it printed.
    pub(crate) url: String,
}

impl Preview {
    pub(crate) fn of(name: &str, text: &str) -> Self {
        Self::with(name, text, &["--port", "0", "--no-open"])
    }

    pub(crate) fn with(name: &str, text: &str, arguments: &[&str]) -> Self {
        let folder = TempDir::new().unwrap();
        let scene = folder.path().join(name);
        fs::write(&scene, text).unwrap();
        Self::start(folder, scene, arguments)
    }

    pub(crate) fn start(folder: TempDir, scene: PathBuf, arguments: &[&str]) -> Self {
        Self::start_with(folder, scene, arguments, |_| {})
    }

    /// Likewise, with changes to the command.
    pub(crate) fn start_with(
        folder: TempDir,
        scene: PathBuf,
        arguments: &[&str],
        change: impl FnOnce(&mut Command),
    ) -> Self {
        let mut command = Command::new(STRAHL);
        command
            .arg("preview")
            .arg(&scene)
            .args(arguments)
            .current_dir(&folder)
            .stdin(Stdio::null())
            .stdout(Stdio::piped());
        change(&mut command);
        let mut process = command.spawn().unwrap();
        let mut url = String::new();
        let output = process.stdout.as_mut().unwrap();
        BufReader::new(output).read_line(&mut url).unwrap();
        Self {
            process,
            folder,
            scene,
            url: url.trim_end().to_owned(),
        }
    }

    pub(crate) fn id(&self) -> u32 {
        self.process.id()
    }

    pub(crate) fn folder(&self) -> &Path {
        self.folder.path()
    }

    pub(crate) fn port(&self) -> u16 {
        let (_, rest) = self.url.split_once("127.0.0.1:").unwrap();
        rest.split_once('/').unwrap().0.parse().unwrap()
    }

    pub(crate) fn token(&self) -> &str {
        self.url.split_once("?token=").unwrap().1
    }

    /// Writes the file, as another program does.
    pub(crate) fn write(&self, text: &str) {
        fs::write(&self.scene, text).unwrap();
    }

    pub(crate) fn on_disk(&self) -> String {
        fs::read_to_string(&self.scene).unwrap()
    }
}

impl Drop for Preview {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// The page of a preview in a browser.
pub(crate) struct Page<'a> {
    browser: &'a Browser,
    pub(crate) preview: Preview,
}

impl Deref for Page<'_> {
    type Target = Browser;

    fn deref(&self) -> &Browser {
        self.browser
    }
}

impl Drop for Page<'_> {
    /// Leaves the page before its server ends: what it asks for meanwhile would be an error in its console.
    fn drop(&mut self) {
        if !thread::panicking() {
            self.browser.open("about:blank");
        }
    }
}

impl<'a> Page<'a> {
    /// Opens the page of a scene in RON, and waits until it is drawn.
    pub(crate) fn of(browser: &'a Browser, text: &str) -> Self {
        Self::open(browser, Preview::of("scene.ron", text))
    }

    pub(crate) fn open(browser: &'a Browser, preview: Preview) -> Self {
        browser.open(&preview.url);
        let page = Self { browser, preview };
        page.wait("['drawn', 'broken'].includes(document.body.dataset.state)");
        page.wait("document.querySelector('#source .cm-line')");
        page
    }

    pub(crate) fn state(&self) -> String {
        self.text("document.body.dataset.state")
    }

    pub(crate) fn revision(&self) -> u64 {
        let revision = self.text("document.body.dataset.revision");
        revision.parse().unwrap()
    }

    /// Does something, and waits until its result is drawn.
    pub(crate) fn and_draw(&self, what: impl FnOnce()) {
        self.and_reach("drawn", what);
    }

    /// Does something, and waits until the page has a later revision, in this state.
    pub(crate) fn and_reach(&self, state: &str, what: impl FnOnce()) {
        let before = self.revision();
        what();
        self.wait(&format!(
            "Number(document.body.dataset.revision) > {before} && \
             document.body.dataset.state === '{state}'"
        ));
    }

    /// Returns the text in the editor.
    pub(crate) fn source(&self) -> String {
        let lines = "[...document.querySelectorAll('#source .cm-line')]";
        self.text(&format!(
            "{lines}.map(line => line.textContent).join('\\n')"
        ))
    }

    /// Returns the color of a pixel of a picture.
    pub(crate) fn color(&self, id: &str, (x, y): (u32, u32)) -> [u8; 4] {
        let script = "const image = document.getElementById(arguments[0]);
            const canvas = document.createElement('canvas');
            [canvas.width, canvas.height] = [image.naturalWidth, image.naturalHeight];
            const context = canvas.getContext('2d');
            context.drawImage(image, 0, 0);
            return [...context.getImageData(arguments[1], arguments[2], 1, 1).data]";
        let color = self.call(script, &[id.into(), x.into(), y.into()]);
        serde_json::from_value(color).unwrap()
    }

    /// Returns the point of the window in the middle of a pixel of the picture.
    pub(crate) fn at(&self, (x, y): (u32, u32)) -> Point {
        let [left, top, width, height] = self.rectangle("#picture");
        let columns = self.number("document.getElementById('picture').naturalWidth");
        let rows = self.number("document.getElementById('picture').naturalHeight");
        (
            left + (f64::from(x) + 0.5) * width / columns,
            top + (f64::from(y) + 0.5) * height / rows,
        )
    }

    /// Puts the cursor in front of the first occurrence of a text.
    pub(crate) fn cursor_before(&self, text: &str) {
        let source = self.source();
        let at = source.find(text);
        let at = at.unwrap_or_else(|| panic!("{text} is not in {source}"));
        let before = &source[..at];
        let lines = before.matches('\n').count();
        let column = before.rsplit('\n').next().unwrap().chars().count();
        self.focus_editor();
        self.chord(&[key::CONTROL], &key::HOME.to_string());
        self.keys(&key::DOWN.to_string().repeat(lines));
        self.keys(&key::RIGHT.to_string().repeat(column));
    }

    /// Replaces the first occurrence of a text by typing.
    pub(crate) fn retype(&self, old: &str, new: &str) {
        self.cursor_before(old);
        let right = key::RIGHT.to_string().repeat(old.chars().count());
        self.chord(&[key::SHIFT], &right);
        self.keys(new);
    }

    pub(crate) fn focus_editor(&self) {
        self.call("document.querySelector('#source .cm-content').focus()", &[]);
        self.wait("document.querySelector('#source .cm-focused')");
    }

    /// Returns the number of the line that the cursor is in.
    pub(crate) fn cursor_line(&self) -> u64 {
        let number = "document.querySelector('.cm-lineNumbers .cm-activeLineGutter')";
        let number = self.text(&format!("{number}.textContent"));
        number.parse().unwrap()
    }
}
