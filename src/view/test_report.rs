//! A file that describes the window for tests: rectangles of the controls, and the shown state.

use super::painter::Paint;
use super::panel::Panel;
use super::shown::{Shown, Status};
use super::state::{Side, State};
use crate::base::names::Listed;
use crate::experiment::axis::AXES;
use serde_json::{Value as Json, json};
use std::collections::BTreeMap;
use std::path::PathBuf;
use winit::event::WindowEvent;

/// Names the file.
const TEST_WINDOW: &str = "SPLITSUM_TEST_WINDOW";

/// The file, rewritten when its content changes.
pub struct TestReport {
    path: PathBuf,
    written: String,
}

/// Counts of what the window heard and showed.
#[derive(Default)]
pub struct Counts {
    /// Presses and releases.
    inputs: u64,
    pointer: [f64; 2],
    /// States with a picture.
    pub pictures: u64,
    /// Frames that the window took.
    pub frames: u64,
    /// Passes with a dimmed half.
    pub dimmed: u64,
}

impl Counts {
    pub fn count(&mut self, event: &WindowEvent) {
        match event {
            WindowEvent::KeyboardInput {
                event,
                is_synthetic: false,
                ..
            } if !event.repeat => self.inputs += 1,
            WindowEvent::MouseInput { .. } => self.inputs += 1,
            WindowEvent::CursorMoved { position, .. } => self.pointer = [position.x, position.y],
            _ => {}
        }
    }
}

/// The window at the end of a frame.
pub struct Snapshot<'a> {
    pub panel: &'a Panel,
    /// How the window is painted, once that is known.
    pub paint: Option<Paint>,
    pub state: &'a State,
    pub shown: &'a Shown,
    pub counts: &'a Counts,
    /// The number of the state that the window asked for.
    pub generation: u64,
    pub pixels_per_point: f32,
    /// Whether no animation is due.
    pub is_still: bool,
}

impl TestReport {
    /// `None` unless a test asks for the file.
    pub fn from_environment() -> Option<Self> {
        let path = std::env::var_os(TEST_WINDOW)?;
        Some(Self {
            path: path.into(),
            written: String::new(),
        })
    }

    pub fn write(&mut self, snapshot: &Snapshot) {
        let text = snapshot.json().to_string();
        if text != self.written {
            // Replaces the file in one step.
            let part = self.path.with_extension("part");
            let _ = std::fs::write(&part, &text).and_then(|()| std::fs::rename(&part, &self.path));
            self.written = text;
        }
    }
}

impl Snapshot<'_> {
    fn json(&self) -> Json {
        let shown = self.shown;
        let scales = [Side::Left, Side::Right].map(|side| shown.side(side).map(|shot| shot.scale));
        let reference_samples = shown
            .truth
            .as_ref()
            .map(|shot| shot.image.view.reference_samples);
        json!({
            "controls": self.controls(),
            "inputs": self.counts.inputs,
            "pointer": self.counts.pointer,
            "pictures": self.counts.pictures,
            "frames": self.counts.frames,
            "paint": self.paint.map(|paint| paint.name()),
            "is_still": self.is_still,
            "asked": self.generation,
            "shown": shown.generation,
            "is_done": shown.status == Status::Done,
            "status": format!("{:?}", shown.status),
            "scales": scales,
            "stale": self.panel.canvas.is_stale,
            "dimmed": self.counts.dimmed,
            "reference": reference_samples,
            "notice": self.panel.notice,
            "state": self.state(),
        })
    }

    /// Left, top, width and height of each control, pixels.
    fn controls(&self) -> BTreeMap<&str, [f64; 4]> {
        let scale = f64::from(self.pixels_per_point);
        let pixels = |rect: &egui::Rect| {
            [rect.left(), rect.top(), rect.width(), rect.height()].map(|x| f64::from(x) * scale)
        };
        let rects = self.panel.controls.rects.iter();
        rects
            .map(|(name, rect)| (name.as_str(), pixels(rect)))
            .collect()
    }

    fn state(&self) -> Json {
        let axes: BTreeMap<&str, String> = AXES
            .iter()
            .zip(self.state.point.values())
            .map(|(axis, value)| (axis.name, value.to_string()))
            .collect();
        json!({
            "axes": axes,
            "right": self.state.right.to_string(),
            "orbit": self.state.view.orbit.numbers(),
            "picture": self.state.picture.name(),
            "wipe": self.state.wipe,
        })
    }
}
