//! A headless Chromium, driven through the DevTools protocol over a pair of pipes: no port, no
//! driver, no crate.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Names that distributions give the browser.
const NAMES: [&str; 4] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
];
/// A loaded machine is slow; a hanging browser must not hang the tests.
const PATIENCE: Duration = Duration::from_secs(60);

/// One browser serves every test; it starts with the first.
struct Browser {
    child: Child,
    input: ChildStdin,
    messages: Receiver<Value>,
    last_id: u64,
    _profile: tempfile::TempDir,
}

/// One test at a time uses the browser, because it needs more than one core and times are measured.
static BROWSER: Mutex<Option<Browser>> = Mutex::new(None);

/// A page in its own context: no storage or cache of another test.
pub struct Page {
    browser: MutexGuard<'static, Option<Browser>>,
    context: Value,
    session: Option<String>,
    /// Addresses that the page asked for.
    pub requests: Vec<String>,
    /// Uncaught exceptions and console errors.
    pub errors: Vec<String>,
}

/// Opens a page; returns `None` and prints a line without a browser.
pub fn open() -> Option<Page> {
    let mut browser = BROWSER.lock().unwrap_or_else(PoisonError::into_inner);
    if browser.is_none() {
        *browser = Some(start()?);
    }
    let (requests, errors) = (Vec::new(), Vec::new());
    let mut page = Page {
        browser,
        context: Value::Null,
        session: None,
        requests,
        errors,
    };
    page.context = page.call("Target.createBrowserContext", json!({}))["browserContextId"].clone();
    let new = json!({ "url": "about:blank", "browserContextId": page.context });
    let target = page.call("Target.createTarget", new);
    let attach = json!({ "targetId": target["targetId"], "flatten": true });
    page.session = Some(
        page.call("Target.attachToTarget", attach)["sessionId"]
            .as_str()
            .unwrap()
            .to_owned(),
    );
    for domain in ["Page", "Runtime", "Network", "Log"] {
        page.call(&format!("{domain}.enable"), json!({}));
    }
    Some(page)
}

fn start() -> Option<Browser> {
    let found = |name: &&&str| {
        Command::new(name)
            .arg("--version")
            .output()
            .is_ok_and(|output| output.status.success())
    };
    let Some(name) = NAMES.iter().find(found) else {
        eprintln!("skipped: no Chromium; `apt-get install chromium` adds it");
        assert!(
            std::env::var_os("SPLITSUM_REQUIRE_BROWSER").is_none(),
            "SPLITSUM_REQUIRE_BROWSER is set"
        );
        return None;
    };
    let profile = tempfile::tempdir().unwrap();
    // The protocol uses the descriptors 3 (in) and 4 (out). They close when the tests end; then the
    // browser ends and its profile is deleted.
    let mut child = Command::new("sh")
        .args([
            "-c",
            r#"profile=$1; shift; "$@" 3<&0 4>&1 </dev/null >/dev/null 2>&1; rm -rf "$profile""#,
            "sh",
        ])
        .arg(profile.path())
        .arg(name)
        .args([
            "--headless=new",
            "--no-sandbox",
            "--disable-gpu",
            "--enable-unsafe-swiftshader",
            "--no-first-run",
        ])
        .args([
            "--disable-background-networking",
            "--disable-extensions",
            "--remote-debugging-pipe",
        ])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let (input, output) = (child.stdin.take().unwrap(), child.stdout.take().unwrap());
    Some(Browser {
        child,
        input,
        messages: listen(output),
        last_id: 0,
        _profile: profile,
    })
}

fn listen(output: ChildStdout) -> Receiver<Value> {
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        for message in BufReader::new(output).split(0).map_while(Result::ok) {
            if sender
                .send(serde_json::from_slice(&message).unwrap())
                .is_err()
            {
                return;
            }
        }
    });
    receiver
}

impl Drop for Page {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            self.session = None;
            self.call(
                "Target.disposeBrowserContext",
                json!({ "browserContextId": self.context }),
            );
        } else if let Some(mut browser) = self.browser.take() {
            // The browser may have caused the failure, so the next test starts another one. A
            // browser ends when its pipe is closed.
            drop(browser.input);
            let asked = Instant::now();
            while matches!(browser.child.try_wait(), Ok(None))
                && asked.elapsed() < Duration::from_secs(10)
            {
                std::thread::sleep(Duration::from_millis(20));
            }
        }
    }
}

impl Page {
    fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.request(method, parameters)
            .unwrap_or_else(|error| panic!("{method}: {error}"))
    }

    /// Calls a method of the protocol; its error is the browser's.
    fn request(&mut self, method: &str, parameters: Value) -> Result<Value, Value> {
        let browser = self.browser.as_mut().unwrap();
        browser.last_id += 1;
        let mut message = json!({ "id": browser.last_id, "method": method, "params": parameters });
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        browser
            .input
            .write_all(format!("{message}\0").as_bytes())
            .unwrap();
        let started = Instant::now();
        loop {
            let browser = self.browser.as_mut().unwrap();
            let left = PATIENCE.saturating_sub(started.elapsed());
            let answer = browser
                .messages
                .recv_timeout(left)
                .unwrap_or_else(|_| panic!("no answer to {method}"));
            if answer["id"] == browser.last_id {
                return match &answer["error"] {
                    Value::Null => Ok(answer["result"].clone()),
                    error => Err(error.clone()),
                };
            }
            // Messages of another test's page may still arrive.
            if answer["sessionId"].as_str() == self.session.as_deref() {
                self.note(&answer);
            }
        }
    }

    fn note(&mut self, event: &Value) {
        let parameters = &event["params"];
        match event["method"].as_str() {
            Some("Network.requestWillBeSent") => {
                self.requests.push(
                    parameters["request"]["url"]
                        .as_str()
                        .unwrap_or_default()
                        .to_owned(),
                );
            }
            Some("Runtime.exceptionThrown") => {
                self.errors.push(parameters["exceptionDetails"].to_string())
            }
            Some("Log.entryAdded") if parameters["entry"]["level"] == "error" => {
                self.errors.push(parameters["entry"].to_string());
            }
            _ => {}
        }
    }

    /// Sets the window's size and the colour scheme.
    pub fn resize(&mut self, width: u32, height: u32, scheme: &str) {
        let size =
            json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.call("Emulation.setDeviceMetricsOverride", size);
        let features = json!({ "features": [{ "name": "prefers-color-scheme", "value": scheme }] });
        self.call("Emulation.setEmulatedMedia", features);
    }

    /// Opens a file with a hash and waits until it is interactive. Returns the milliseconds from
    /// navigation until then.
    pub fn go(&mut self, path: &Path, hash: &str) -> f64 {
        self.visit(path, hash, "document.body?.dataset.ready !== undefined");
        self.eval("Number(document.body.dataset.ready)")
            .as_f64()
            .unwrap()
    }

    /// Changes the hash of the open page, as its own links do, and waits for the view.
    pub fn follow(&mut self, hash: &str) {
        let view = hash[1..].split('?').next().unwrap();
        self.eval(&format!("location.hash = {}", json!(hash)));
        self.wait(&format!("document.body.dataset.view === {}", json!(view)));
    }

    /// Opens a file and waits until an expression is true.
    pub fn visit(&mut self, path: &Path, hash: &str, until: &str) {
        self.call("Page.navigate", json!({ "url": "about:blank" }));
        self.requests.clear();
        self.call(
            "Page.navigate",
            json!({ "url": format!("file://{}{hash}", path.display()) }),
        );
        self.wait(until);
    }

    /// Runs a script before the scripts of every page opened from now on.
    pub fn before_load(&mut self, script: &str) {
        self.call(
            "Page.addScriptToEvaluateOnNewDocument",
            json!({ "source": script }),
        );
    }

    pub fn eval(&mut self, expression: &str) -> Value {
        self.evaluate(expression)
            .unwrap_or_else(|error| panic!("{expression}: {error}"))
    }

    /// The value of an expression, or the error of a page that navigates meanwhile.
    fn evaluate(&mut self, expression: &str) -> Result<Value, Value> {
        let parameters =
            json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        let answer = self.request("Runtime.evaluate", parameters)?;
        assert!(
            answer["exceptionDetails"].is_null(),
            "{expression}: {}",
            answer["exceptionDetails"]
        );
        Ok(answer["result"]["value"].clone())
    }

    /// Waits until an expression is true, in the open page or in the one that follows it.
    pub fn wait(&mut self, expression: &str) {
        let started = Instant::now();
        while self.evaluate(expression) != Ok(json!(true)) {
            assert!(
                started.elapsed() < PATIENCE,
                "never true: {expression}; errors: {:?}",
                self.errors
            );
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    pub fn text(&mut self, selector: &str) -> String {
        let value = self.eval(&format!(
            "document.querySelector({}).textContent",
            json!(selector)
        ));
        value.as_str().unwrap().to_owned()
    }

    /// Presses a key; [`Page::release`] releases it.
    pub fn press(&mut self, key: &str) {
        let text = if key.chars().count() == 1 { key } else { "" };
        self.call(
            "Input.dispatchKeyEvent",
            json!({ "type": "keyDown", "key": key, "text": text }),
        );
    }

    pub fn release(&mut self, key: &str) {
        self.call(
            "Input.dispatchKeyEvent",
            json!({ "type": "keyUp", "key": key }),
        );
    }

    pub fn key(&mut self, key: &str) {
        self.press(key);
        self.release(key);
    }

    pub fn click(&mut self, selector: &str) {
        let script = format!(
            "(() => {{ const e = document.querySelector({}); e.scrollIntoView({{ block: 'center' \
             }}); \
             const b = e.getBoundingClientRect(); return [b.left + b.width / 2, b.top + b.height / \
             2]; }})()",
            json!(selector)
        );
        let place = self.eval(&script);
        for kind in ["mouseMoved", "mousePressed", "mouseReleased"] {
            let button = if kind == "mouseMoved" { "none" } else { "left" };
            let event = json!({ "type": kind, "x": place[0], "y": place[1], "button": button, "clickCount": 1 });
            self.call("Input.dispatchMouseEvent", event);
        }
    }
}
