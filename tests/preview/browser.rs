//! A browser, without the asynchronous parts.

use std::{
    env, fs,
    path::PathBuf,
    thread,
    time::{Duration, Instant},
};

use fantoccini::{
    Client, ClientBuilder, Locator,
    actions::{
        Actions, InputSource, KeyAction, KeyActions, MOUSE_BUTTON_LEFT, MouseActions,
        PointerAction, TouchActions, WheelAction, WheelActions,
    },
    elements::Element,
    wd::WindowHandle,
};
use hyper_util::client::legacy::connect::HttpConnector;
use serde_json::{Value, json};
use tokio::runtime::{Builder, Runtime};

use super::{driver, http::Request};

/// No step takes this long, even on a slow machine.
pub(crate) const PATIENCE: Duration = Duration::from_secs(60);
/// The time between two looks at a page.
const PAUSE: Duration = Duration::from_millis(15);

/// Keys by their codes in `WebDriver`.
pub(crate) mod key {
    pub(crate) const ENTER: char = '\u{e007}';
    pub(crate) const SHIFT: char = '\u{e008}';
    pub(crate) const CONTROL: char = '\u{e009}';
    pub(crate) const ESCAPE: char = '\u{e00c}';
    pub(crate) const END: char = '\u{e010}';
    pub(crate) const HOME: char = '\u{e011}';
    pub(crate) const LEFT: char = '\u{e012}';
    pub(crate) const UP: char = '\u{e013}';
    pub(crate) const RIGHT: char = '\u{e014}';
    pub(crate) const DOWN: char = '\u{e015}';
    pub(crate) const TAB: char = '\u{e004}';
    pub(crate) const BACKSPACE: char = '\u{e003}';
}

/// A point of the window, in pixels from its top left corner.
pub(crate) type Point = (f64, f64);

pub(crate) struct Browser {
    runtime: Runtime,
    client: Client,
}

impl Browser {
    /// Runs a test with a free browser, or a new one.
    pub(crate) fn with(test: impl FnOnce(&Self)) {
        let free = driver::FREE.lock().unwrap().pop();
        let browser = Unshared(Some(free.unwrap_or_else(Self::new)));
        let inner = browser.0.as_ref().unwrap();
        inner.reset();
        test(inner);
        let errors = inner.console_errors();
        assert!(errors.is_empty(), "the console of the page: {errors:#?}");
    }

    /// Returns the errors in the console since the last call, and forgets them. Each test ends without any.
    pub(crate) fn console_errors(&self) -> Vec<String> {
        let session = self.runtime.block_on(self.client.session_id()).unwrap();
        let path = format!("/session/{}/se/log", session.unwrap());
        let answer = Request::post(&path).body(r#"{"type": "browser"}"#);
        let answer = answer.send(driver::port());
        let answer: Value = serde_json::from_slice(&answer.body).unwrap();
        let entries = answer["value"].as_array().unwrap().iter();
        let errors = entries.filter(|entry| entry["level"] == "SEVERE");
        let errors = errors.map(|entry| entry["message"].to_string());
        // A test without a `Page` ends its server while the page is open.
        let is_lost = |error: &String| {
            ["ERR_CONNECTION_", "ERR_SOCKET_"]
                .iter()
                .any(|name| error.contains(name))
        };
        errors.filter(|error| !is_lost(error)).collect()
    }

    fn new() -> Self {
        let (chromium, _) = driver::programs().unwrap();
        let runtime = Builder::new_current_thread().enable_all().build().unwrap();
        let capabilities = json!({
            "goog:chromeOptions": {
                "binary": chromium,
                "args": [
                    "--headless=new",
                    // Chromium has no sandbox for root.
                    "--no-sandbox",
                    "--disable-gpu",
                    "--disable-dev-shm-usage",
                    "--force-device-scale-factor=1",
                    "--window-size=1280,860",
                ],
            },
            "goog:loggingPrefs": {"browser": "ALL"},
        });
        let Value::Object(capabilities) = capabilities else {
            unreachable!("an object")
        };
        let client = runtime.block_on(
            ClientBuilder::new(HttpConnector::new())
                .capabilities(capabilities)
                .connect(&format!("http://127.0.0.1:{}", driver::port())),
        );
        Self {
            client: client.unwrap(),
            runtime,
        }
    }

    pub(crate) fn close(self) {
        let _ = self.runtime.block_on(self.client.close());
    }

    /// Forgets the page and the emulations of the test before.
    fn reset(&self) {
        self.open("about:blank");
        self.console_errors();
        self.emulate_width(None);
        self.emulate_dark(false);
        // Which window of several browsers has the focus is up to the system.
        let is_focused = json!({"enabled": true});
        self.dev_tools("Emulation.setFocusEmulationEnabled", &is_focused);
    }

    pub(crate) fn open(&self, url: &str) {
        self.runtime.block_on(self.client.goto(url)).unwrap();
    }

    /// Runs a script before those of each page while `what` is done.
    pub(crate) fn with_script<T>(&self, script: &str, what: impl FnOnce() -> T) -> T {
        let source = json!({"source": script});
        let id = self.dev_tools("Page.addScriptToEvaluateOnNewDocument", &source);
        let result = what();
        self.dev_tools("Page.removeScriptToEvaluateOnNewDocument", &id);
        result
    }

    /// Runs a script with arguments, and returns its result.
    pub(crate) fn call(&self, script: &str, arguments: &[Value]) -> Value {
        let result = self.client.execute(script, arguments.to_vec());
        self.runtime.block_on(result).unwrap()
    }

    /// Returns the value of an expression.
    pub(crate) fn value(&self, expression: &str) -> Value {
        self.call(&format!("return {expression}"), &[])
    }

    pub(crate) fn text(&self, expression: &str) -> String {
        let value = self.value(expression);
        let text = value.as_str();
        text.unwrap_or_else(|| panic!("not a text: {value}")).into()
    }

    pub(crate) fn number(&self, expression: &str) -> f64 {
        let value = self.value(expression);
        let number = value.as_f64();
        number.unwrap_or_else(|| panic!("not a number: {value}"))
    }

    pub(crate) fn is(&self, condition: &str) -> bool {
        self.value(&format!("Boolean({condition})")) == true
    }

    /// Waits until an expression is true.
    pub(crate) fn wait(&self, condition: &str) {
        self.wait_for(condition, || self.is(condition));
    }

    /// Waits until something has happened.
    pub(crate) fn wait_for(&self, what: &str, mut has_happened: impl FnMut() -> bool) {
        let end = Instant::now() + PATIENCE;
        while !has_happened() {
            if Instant::now() > end {
                let page = self.value("document.body.innerText");
                self.shot("failure");
                panic!("waited in vain for {what}; the page: {page:#}");
            }
            thread::sleep(PAUSE);
        }
    }

    /// Runs an asynchronous script, whose last argument is called with the result.
    pub(crate) fn call_async(&self, script: &str, arguments: &[Value]) -> Value {
        let result = self.client.execute_async(script, arguments.to_vec());
        self.runtime.block_on(result).unwrap()
    }

    fn find(&self, css: &str) -> Element {
        let element = self.client.find(Locator::Css(css));
        let element = self.runtime.block_on(element);
        element.unwrap_or_else(|error| panic!("{css}: {error}"))
    }

    pub(crate) fn click(&self, css: &str) {
        let element = self.find(css);
        let clicked = self.runtime.block_on(element.click());
        clicked.unwrap_or_else(|error| panic!("{css}: {error}"));
    }

    /// Chooses an option of a list by its value.
    pub(crate) fn choose(&self, css: &str, value: &str) {
        let chosen = self
            .runtime
            .block_on(self.find(css).select_by_value(value))
            .map(drop);
        chosen.unwrap_or_else(|error| panic!("{css} {value}: {error}"));
    }

    /// Sets the value of a control, as its own user interface does.
    pub(crate) fn set(&self, css: &str, value: &str) {
        let script = "const control = document.querySelector(arguments[0]);
            control.value = arguments[1];
            for (const name of ['input', 'change'])
                control.dispatchEvent(new Event(name, {bubbles: true}));";
        self.call(script, &[css.into(), value.into()]);
    }

    /// Chooses a file in a file input.
    pub(crate) fn upload(&self, css: &str, file: &std::path::Path) {
        let keys = self.find(css);
        let sent = keys.send_keys(file.to_str().unwrap());
        self.runtime.block_on(sent).unwrap();
    }

    fn perform(&self, actions: impl Into<Actions>) {
        let done = self.client.perform_actions(actions);
        self.runtime.block_on(done).unwrap();
    }

    /// Presses keys, one after the other.
    pub(crate) fn keys(&self, keys: &str) {
        let mut actions = KeyActions::new("keys".to_owned());
        for value in keys.chars() {
            actions = actions
                .then(KeyAction::Down { value })
                .then(KeyAction::Up { value });
        }
        self.perform(actions);
    }

    /// Presses keys while others are held.
    pub(crate) fn chord(&self, held: &[char], keys: &str) {
        let mut actions = KeyActions::new("keys".to_owned());
        for &value in held {
            actions = actions.then(KeyAction::Down { value });
        }
        for value in keys.chars() {
            actions = actions
                .then(KeyAction::Down { value })
                .then(KeyAction::Up { value });
        }
        for &value in held {
            actions = actions.then(KeyAction::Up { value });
        }
        self.perform(actions);
    }

    /// Moves the mouse to a point.
    pub(crate) fn point(&self, at: Point) {
        self.perform(MouseActions::new("mouse".to_owned()).then(to(at)));
    }

    pub(crate) fn click_at(&self, at: Point) {
        self.drag(&[at]);
    }

    /// Drags the mouse from the first of these points through the others.
    pub(crate) fn drag(&self, path: &[Point]) {
        let mut mouse = MouseActions::new("mouse".to_owned());
        for action in strokes(path) {
            mouse = mouse.then(action);
        }
        self.perform(mouse);
    }

    /// Moves a finger along each of these paths, all at the same time.
    pub(crate) fn touch(&self, fingers: &[&[Point]]) {
        let mut all: Option<Actions> = None;
        for (index, path) in fingers.iter().enumerate() {
            let mut finger = TouchActions::new(format!("finger {index}"));
            for action in strokes(path) {
                finger = finger.then(action);
            }
            all = Some(match all {
                Some(all) => all.and(finger),
                None => finger.into(),
            });
        }
        self.perform(all.unwrap());
    }

    /// Turns the wheel of the mouse.
    pub(crate) fn wheel(&self, (x, y): Point, down: i64) {
        let wheel = WheelActions::new("wheel".to_owned());
        self.perform(wheel.then(WheelAction::Scroll {
            duration: None,
            x: x as i64,
            y: y as i64,
            delta_x: 0,
            delta_y: down,
        }));
    }

    /// Returns left, top, width and height of an element in the window.
    pub(crate) fn rectangle(&self, css: &str) -> [f64; 4] {
        let script = "const box = document.querySelector(arguments[0]).getBoundingClientRect();
            return [box.left, box.top, box.width, box.height]";
        let value = self.call(script, &[css.into()]);
        serde_json::from_value(value).unwrap()
    }

    /// Returns a style of an element as it is in effect.
    pub(crate) fn style(&self, css: &str, property: &str) -> String {
        let script = "return getComputedStyle(document.querySelector(arguments[0]))[arguments[1]]";
        let style = self.call(script, &[css.into(), property.into()]);
        style.as_str().unwrap().to_owned()
    }

    /// Opens a tab and shows it.
    pub(crate) fn new_tab(&self) -> WindowHandle {
        let new = self.runtime.block_on(self.client.new_window(true)).unwrap();
        self.switch_to(&new.handle);
        new.handle
    }

    pub(crate) fn tab(&self) -> WindowHandle {
        self.runtime.block_on(self.client.window()).unwrap()
    }

    pub(crate) fn switch_to(&self, tab: &WindowHandle) {
        let switched = self.client.switch_to_window(tab.clone());
        self.runtime.block_on(switched).unwrap();
    }

    pub(crate) fn close_tab(&self) {
        self.runtime.block_on(self.client.close_window()).unwrap();
    }

    /// Sends a command of the protocol of the developer tools, which `WebDriver` has no form for.
    pub(crate) fn dev_tools(&self, command: &str, parameters: &Value) -> Value {
        let session = self.runtime.block_on(self.client.session_id()).unwrap();
        let body = json!({"cmd": command, "params": parameters}).to_string();
        let path = format!("/session/{}/goog/cdp/execute", session.unwrap());
        let answer = Request::post(&path).body(&body).send(driver::port());
        assert_eq!(answer.status, 200, "{}", answer.text());
        let answer: Value = serde_json::from_slice(&answer.body).unwrap();
        answer["value"].clone()
    }

    /// Gives the page the width of a telephone, or that of the window.
    pub(crate) fn emulate_width(&self, width: Option<u32>) {
        let parameters = match width {
            Some(width) => json!({
                "width": width, "height": 740, "deviceScaleFactor": 1, "mobile": true,
            }),
            None => json!({}),
        };
        let command = match width {
            Some(_) => "Emulation.setDeviceMetricsOverride",
            None => "Emulation.clearDeviceMetricsOverride",
        };
        self.dev_tools(command, &parameters);
    }

    /// Prefers dark colors, or light ones.
    pub(crate) fn emulate_dark(&self, is_dark: bool) {
        let value = if is_dark { "dark" } else { "light" };
        let features = json!([{"name": "prefers-color-scheme", "value": value}]);
        self.dev_tools("Emulation.setEmulatedMedia", &json!({"features": features}));
    }

    /// Saves a screenshot, if `STRAHL_SHOTS` names a folder for them.
    pub(crate) fn shot(&self, name: &str) {
        let Some(folder) = env::var_os("STRAHL_SHOTS").map(PathBuf::from) else {
            return;
        };
        let picture = self.runtime.block_on(self.client.screenshot()).unwrap();
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join(format!("{name}.png")), picture).unwrap();
    }
}

/// A browser that returns to the free ones, unless its test fails.
struct Unshared(Option<Browser>);

impl Drop for Unshared {
    fn drop(&mut self) {
        let Some(browser) = self.0.take() else {
            return;
        };
        if thread::panicking() {
            browser.close();
        } else {
            driver::FREE.lock().unwrap().push(browser);
        }
    }
}

fn to((x, y): Point) -> PointerAction {
    let duration = Some(Duration::from_millis(15));
    PointerAction::MoveTo { duration, x, y }
}

/// A press at the first point, the way through the others, and the release.
fn strokes(path: &[Point]) -> impl Iterator<Item = PointerAction> {
    let button = MOUSE_BUTTON_LEFT;
    let (first, others) = path.split_first().unwrap();
    let start = [to(*first), PointerAction::Down { button }];
    let way = others.iter().copied().map(to);
    start
        .into_iter()
        .chain(way)
        .chain([PointerAction::Up { button }])
}
