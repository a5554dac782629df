//! A virtual display with a window manager, and a window on it.

use serde_json::Value;
use splitsum::base::pixels::Rgb8Image;
use std::cell::Cell;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tempfile::TempDir;

const SIZE: [u32; 2] = [1280, 2600];
/// A window without a report for so long hangs. Everything else waits for events.
const PATIENCE: Duration = Duration::from_secs(300);

/// One window at a time: each takes all processors.
static TURN: Mutex<()> = Mutex::new(());

pub struct Screen {
    server: Child,
    manager: Child,
    display: String,
    frames: TempDir,
    _turn: MutexGuard<'static, ()>,
}

impl Screen {
    /// Returns `None` and prints a line if a program is missing.
    pub fn open() -> Option<Self> {
        let turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        let frames = tempfile::tempdir().unwrap();
        let screen = format!("{}x{}x24", SIZE[0], SIZE[1]);
        let folder = frames.path().to_str().unwrap();
        // Without `-noreset` the server resets when its last client leaves, and refuses a window
        // manager that connects just then. Without `-r` it repeats a key whose release comes late.
        let server = Command::new("Xvfb")
            .args([
                "-displayfd",
                "1",
                "-noreset",
                "-r",
                "-screen",
                "0",
                &screen,
                "-fbdir",
                folder,
                "-nolisten",
                "tcp",
            ])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let is_there = |name: &str| Command::new(name).arg("--version").output().is_ok();
        let (Ok(mut server), true, true) = (server, is_there("xdotool"), is_there("openbox"))
        else {
            let required = std::env::var_os("SPLITSUM_REQUIRE_WINDOW").is_some();
            assert!(!required, "Xvfb, xdotool or openbox is missing");
            eprintln!(
                "skipped: Xvfb, xdotool or openbox is missing (Debian: apt-get install xvfb \
                 xdotool openbox)"
            );
            return None;
        };
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap())
            .read_line(&mut number)
            .unwrap();
        let display = format!(":{}", number.trim());
        let silent = |name: &str| {
            let mut command = Command::new(name);
            command
                .env("DISPLAY", &display)
                .stdout(Stdio::null())
                .stderr(Stdio::null());
            command
        };
        let mut manager = silent("openbox").spawn().unwrap();
        // The window manager announces desktops once it manages them.
        let begun = Instant::now();
        while !silent("xdotool")
            .arg("get_desktop")
            .status()
            .unwrap()
            .success()
        {
            let ended = manager.try_wait().unwrap();
            assert!(
                ended.is_none() && begun.elapsed() < PATIENCE,
                "the window manager is not there: {ended:?}"
            );
            std::thread::sleep(Duration::from_millis(50));
        }
        Some(Self {
            server,
            manager,
            display,
            frames,
            _turn: turn,
        })
    }

    pub fn window(&self, arguments: &[&str]) -> Win<'_> {
        self.window_with(arguments, &[])
    }

    /// Opens a window and waits until it shows a picture.
    pub fn window_with(&self, arguments: &[&str], variables: &[(&str, &str)]) -> Win<'_> {
        let mut win = self.started(arguments, variables);
        win.wait("a first picture", |report| report["scales"][0].is_u64());
        // A window manager takes a moment to show it.
        let begun = Instant::now();
        while win.id.is_empty() {
            assert!(
                begun.elapsed() < PATIENCE,
                "the window manager shows no window"
            );
            std::thread::sleep(Duration::from_millis(50));
            let words = ["search", "--onlyvisible", "--name", "^splitsum view$"];
            let output = Command::new("xdotool")
                .args(words)
                .env("DISPLAY", &self.display)
                .output()
                .unwrap();
            win.id = String::from_utf8(output.stdout).unwrap().trim().to_owned();
        }
        win
    }

    /// Starts a window that may end by itself. SPLITSUM_WINDOW_PAINT chooses how all windows are
    /// painted that do not say it.
    pub fn started(&self, arguments: &[&str], variables: &[(&str, &str)]) -> Win<'_> {
        let mut paint = Vec::new();
        if let Ok(how) = std::env::var("SPLITSUM_WINDOW_PAINT")
            && !arguments.contains(&"--paint")
        {
            paint = vec!["--paint".to_owned(), how];
        }
        let dir = tempfile::tempdir().unwrap();
        let child = Command::new(env!("CARGO_BIN_EXE_splitsum"))
            .arg("view")
            .args(arguments)
            .args(paint)
            .current_dir(dir.path())
            .env("DISPLAY", &self.display)
            .env("SPLITSUM_TEST_WINDOW", dir.path().join("report.json"))
            .env_remove("WAYLAND_DISPLAY")
            .envs(variables.iter().copied())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        Win {
            screen: self,
            child: Mutex::new(child),
            dir,
            id: String::new(),
            sent: Cell::new(0),
        }
    }

    fn act(&self, line: &str) -> String {
        let output = Command::new("xdotool")
            .args(line.split(' '))
            .env("DISPLAY", &self.display)
            .output()
            .unwrap();
        assert!(
            output.status.success(),
            "xdotool {line}: {}",
            String::from_utf8_lossy(&output.stderr)
        );
        String::from_utf8(output.stdout).unwrap()
    }

    /// Pixels of the display: the file in which Xvfb keeps them, in the format of xwd.
    fn pixels(&self) -> Rgb8Image {
        let bytes = std::fs::read(self.frames.path().join("Xvfb_screen0")).unwrap();
        let word = |at: usize| u32::from_be_bytes(bytes[4 * at..4 * at + 4].try_into().unwrap());
        let (header, width, height, line, colors) = (word(0), word(4), word(5), word(12), word(19));
        let first = (header + 12 * colors) as usize;
        Rgb8Image::from_fn(width, height, |x, y| {
            let at = first + (y * line + 4 * x) as usize;
            [bytes[at + 2], bytes[at + 1], bytes[at]]
        })
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        for child in [&mut self.manager, &mut self.server] {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

pub struct Win<'a> {
    screen: &'a Screen,
    child: Mutex<Child>,
    dir: TempDir,
    id: String,
    /// Keys and buttons down or up.
    sent: Cell<u64>,
}

impl Win<'_> {
    pub fn dir(&self) -> &Path {
        self.dir.path()
    }

    pub fn id(&self) -> String {
        self.id.clone()
    }

    fn child(&self) -> MutexGuard<'_, Child> {
        self.child.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub fn is_alive(&self) -> bool {
        self.child().try_wait().unwrap().is_none()
    }

    pub fn memory_kib(&self) -> u64 {
        let path = PathBuf::from(format!("/proc/{}/status", self.child().id()));
        let text = std::fs::read_to_string(path).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmRSS:"));
        line.and_then(|line| line.split_whitespace().next()?.parse().ok())
            .unwrap_or_default()
    }

    pub fn report(&self) -> Value {
        let text = std::fs::read_to_string(self.dir.path().join("report.json")).unwrap_or_default();
        serde_json::from_str(&text).unwrap_or_default()
    }

    pub fn wait(&self, what: &str, is_so: impl Fn(&Value) -> bool) {
        let begun = Instant::now();
        loop {
            let report = self.report();
            if !report.is_null() && is_so(&report) {
                return;
            }
            if !self.is_alive() || begun.elapsed() > PATIENCE {
                let mut errors = String::new();
                let _ = self.child().kill();
                let pipe = self.child().stderr.take();
                pipe.map(|mut pipe| pipe.read_to_string(&mut errors));
                panic!("waited for {what}: {report}\n{errors}");
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Waits until the window shows everything that the state requests.
    pub fn wait_done(&self) {
        self.settle();
        self.wait("all pictures", |report| {
            report["is_done"] == true && report["asked"] == report["shown"]
        });
    }

    /// Waits until the window has handled all sent input.
    fn settle(&self) {
        let sent = self.sent.get();
        self.wait(&format!("{sent} inputs"), |report| {
            report["inputs"] == sent && report["is_still"] == true
        });
    }

    pub fn state(&self) -> Value {
        self.settle();
        self.report()["state"].clone()
    }

    pub fn controls(&self) -> Vec<String> {
        self.settle();
        self.report()["controls"]
            .as_object()
            .unwrap()
            .keys()
            .cloned()
            .collect()
    }

    pub fn has(&self, name: &str) -> bool {
        self.settle();
        self.report()["controls"].get(name).is_some()
    }

    /// Left, top, width, height of a control in the window.
    pub fn place(&self, name: &str) -> [f64; 4] {
        let report = self.report();
        let found = report["controls"]
            .get(name)
            .unwrap_or_else(|| panic!("no control {name}: {}", report["controls"]));
        serde_json::from_value(found.clone()).unwrap()
    }

    /// Sends input without waiting: words of `xdotool`.
    pub fn act(&self, line: &str) {
        self.screen.act(line);
    }

    /// Runs actions that make `count` inputs.
    fn send(&self, line: &str, count: u64) {
        self.act(line);
        self.sent.set(self.sent.get() + count);
        self.settle();
    }

    pub fn key(&self, key: &str) {
        self.send(
            &format!("windowfocus --sync {} key {key}", self.id),
            2 * key.split('+').count() as u64,
        );
    }

    pub fn hold(&self, key: &str, is_down: bool) {
        self.send(
            &format!("{} {key}", if is_down { "keydown" } else { "keyup" }),
            1,
        );
    }

    fn point(&self, place: [f64; 2]) {
        let [x, y] = place.map(f64::round);
        self.act(&format!("mousemove --window {} {x} {y}", self.id));
        self.wait("the pointer", |report| {
            report["pointer"] == serde_json::json!([x, y])
        });
        self.settle();
    }

    fn go(&self, name: &str, [u, v]: [f64; 2]) {
        let [left, top, width, height] = self.place(name);
        self.point([left + u * width, top + v * height]);
    }

    pub fn click(&self, name: &str, at: [f64; 2]) {
        self.go(name, at);
        self.send("click 1", 2);
    }

    pub fn choose(&self, list: &str, entry: &str) {
        self.click(list, [0.5, 0.5]);
        self.click(entry, [0.5, 0.5]);
    }

    /// Opens the rest of the controls and ends the reference early.
    pub fn few_samples(&self) {
        self.click("advanced", [0.2, 0.5]);
        self.choose("reference samples", "choice 32");
    }

    /// From one place of a control to another, in fractions of its size.
    pub fn drag(&self, name: &str, from: [f64; 2], to: [f64; 2], held: Option<&str>) {
        let place = self.place(name);
        self.go(name, from);
        held.into_iter().for_each(|key| self.hold(key, true));
        self.send("mousedown 1", 1);
        for step in 1..=3 {
            let at = |axis: usize| {
                place[axis]
                    + (from[axis] + (to[axis] - from[axis]) * f64::from(step) / 3.0)
                        * place[axis + 2]
            };
            self.point([at(0), at(1)]);
        }
        self.send("mouseup 1", 1);
        held.into_iter().for_each(|key| self.hold(key, false));
    }

    pub fn wheel(&self, name: &str, clicks: u32) {
        self.go(name, [0.5, 0.5]);
        let before = self.report()["state"].clone();
        self.act(&format!("click --repeat {clicks} 4"));
        // The number of events per turn depends on the display.
        self.wait("the wheel", |report| report["state"] != before);
        self.settle();
    }

    pub fn resize(&self, width: u32, height: u32) {
        let before = self.place("image");
        self.act(&format!(
            "windowmove {id} 0 30 windowsize {id} {width} {height}",
            id = self.id
        ));
        self.wait("the new size", |report| {
            report["controls"]["image"] != serde_json::json!(before)
        });
        self.settle();
    }

    pub fn picture(&self) -> Rgb8Image {
        // The pointer locates the window: window managers put frames around it.
        self.point([0.0; 2]);
        let all = self.screen.pixels();
        let text = self.screen.act("getmouselocation --shell");
        let number = |key: &str| {
            let line = text
                .lines()
                .find_map(|line| line.strip_prefix(key))
                .unwrap();
            line.trim_start_matches('=').parse::<f64>().unwrap()
        };
        let [left, top, width, height] = self.place("image").map(f64::round);
        let [x, y] = [number("X") + left, number("Y") + top].map(|place| place as u32);
        Rgb8Image::from_fn(width as u32, height as u32, |dx, dy| {
            all.get(x + dx, y + dy)
        })
    }

    /// Iconifies the window, and shows it again.
    pub fn minimise_and_restore(&self) {
        self.act(&format!("windowminimize --sync {}", self.id));
        std::thread::sleep(Duration::from_millis(300));
        self.act(&format!(
            "windowmap --sync {id} windowactivate --sync {id}",
            id = self.id
        ));
        self.settle();
    }

    /// Asks it to close through the window manager, as often as a user would: the manager drops
    /// keys while it holds a grab. The window ends without a fault. Returns what it logged.
    pub fn close(mut self) -> String {
        let begun = Instant::now();
        while self.is_alive() && begun.elapsed() < PATIENCE {
            let asked = Instant::now();
            // A random click may have iconified it. The call fails or waits for ever if the window
            // goes meanwhile.
            let _ = Command::new("timeout")
                .args([
                    "5",
                    "xdotool",
                    "windowactivate",
                    "--sync",
                    &self.id,
                    "windowfocus",
                    "--sync",
                    &self.id,
                ])
                .args(["key", "alt+F4"])
                .env("DISPLAY", &self.screen.display)
                .output();
            while self.is_alive() && asked.elapsed() < Duration::from_secs(5) {
                std::thread::sleep(Duration::from_millis(50));
            }
        }
        let (code, message) = self.end();
        assert_eq!(code, Some(0), "{message}");
        message
    }

    /// Waits for the end; returns exit code and output.
    pub fn end(&mut self) -> (Option<i32>, String) {
        let begun = Instant::now();
        while self.is_alive() {
            assert!(
                begun.elapsed() < PATIENCE,
                "the window stays: {}",
                self.report()
            );
            std::thread::sleep(Duration::from_millis(50));
        }
        let mut child = self.child();
        let mut message = String::new();
        child
            .stderr
            .take()
            .map(|mut pipe| pipe.read_to_string(&mut message));
        (child.wait().unwrap().code(), message)
    }
}

impl Drop for Win<'_> {
    fn drop(&mut self) {
        let _ = self.child().kill();
        let _ = self.child().wait();
    }
}
