//! The window's content: the picture with its toolbar, controls on the right, the status below.

use super::canvas::Canvas;
use super::controls::{Choice, Controls};
use super::keys::{self, nearer, turn_light, turned};
use super::overlay::{self, caption, legend, veiled, wipe_line};
use super::picture::Picture;
use super::shown::{Shown, Status};
use super::state::{HOME, Side, State};
use super::theme;
use crate::base::names::Listed;
use crate::experiment::axis::SIZE;
use crate::experiment::value::Value;
use egui::text::LayoutJob;
use egui::{Align2, CursorIcon, FontId, Frame as Ground, Rect, Sense, Ui, UiBuilder, vec2};
use std::time::{Duration, Instant};

const PANEL_WIDTH: f32 = 320.0;
const STATUS_HEIGHT: f32 = 30.0;
/// Distance of overlays from the edge of the picture.
const MARGIN: f32 = 14.0;
/// Half the width of the wipe's line for the pointer.
const GRIP: f32 = 9.0;
/// Pixels of the largest picture that fills the window: every device holds its reference. Larger
/// windows enlarge it.
const PIXELS_MAX: f32 = (1 << 20) as f32;
const NOTICE: Duration = Duration::from_secs(10);
/// Delay before the window says that it is busy.
const BUSY_AFTER: Duration = Duration::from_millis(250);

/// Width of the menu of what the image is made of.
const BETWEEN_WIDTH: f32 = 128.0;

struct PictureButton {
    picture: Picture,
    label: &'static str,
    about: &'static str,
}

const PICTURE_BUTTONS: [PictureButton; 3] = [
    PictureButton {
        picture: Picture::Image,
        label: "Image",
        about: "The picture; E or S returns to it from an error",
    },
    PictureButton {
        picture: Picture::Error,
        label: "Error",
        about: "Relative error against the reference (E)",
    },
    PictureButton {
        picture: Picture::Signed,
        label: "Signed",
        about: "Relative error: blue is too dark, red too bright (S)",
    },
];

#[derive(Default)]
pub struct Panel {
    pub controls: Controls,
    /// One line about the last action.
    pub notice: String,
    is_fault: bool,
    noticed_at: Option<Instant>,
    pub wants_save: bool,
    pub wants_fullscreen: bool,
    pub canvas: Canvas,
    is_flipped: bool,
    /// Whether a drag of the picture began on the wipe's line: a slow window hears press and move
    /// together.
    is_wiping: bool,
    /// The state that the user asked for.
    generation: u64,
    /// The last state with a picture.
    pictured: u64,
    /// Since when they differ.
    outdated: Option<Instant>,
    probed: Option<[u32; 2]>,
    has_opened: bool,
}

impl Panel {
    /// Takes an update of the renderer.
    pub fn arrive(&mut self, shown: &Shown) {
        if shown.generation > self.pictured {
            self.pictured = shown.generation;
            self.outdated = Some(Instant::now());
        }
    }

    /// Records that the user asked for another state.
    pub fn ask(&mut self, generation: u64) {
        if self.pictured == self.generation {
            self.outdated = Some(Instant::now());
        }
        self.generation = generation;
    }

    /// Returns when a half that shows an older state is to be dimmed, if that is after `now`.
    pub fn dims_at(&self, now: Instant) -> Option<Instant> {
        let since = self.outdated.filter(|_| self.pictured != self.generation)?;
        Some(since + BUSY_AFTER).filter(|time| *time > now)
    }

    /// Shows the result of an action for a while, or its error.
    pub fn report(&mut self, notice: Result<String, String>) {
        self.is_fault = notice.is_err();
        self.noticed_at = Some(Instant::now());
        self.notice = notice.unwrap_or_else(|why| why);
    }

    /// Opens a file that was chosen or dropped on the window.
    pub fn open(&mut self, path: &std::path::Path, state: &mut State) {
        self.has_opened = true;
        let opened = state.open(path);
        self.report(opened.map(|what| format!("{what}: {}", path.display())));
    }

    pub fn ui(&mut self, ui: &mut Ui, state: &mut State, shown: &Shown) {
        self.controls.rects.clear();
        let pressed = keys::press(ui, state, &mut self.controls.has_probe);
        self.is_flipped = pressed.is_flipped;
        self.wants_save |= pressed.save;
        self.wants_fullscreen |= pressed.fullscreen;
        let ground =
            Ground::side_top_panel(ui.style()).inner_margin(egui::Margin::symmetric(12, 0));
        egui::Panel::right("controls")
            .resizable(false)
            .exact_size(PANEL_WIDTH)
            .frame(ground)
            .show_inside(ui, |ui| {
                let area = egui::ScrollArea::vertical().auto_shrink(false);
                if let Some(path) = area.show(ui, |ui| self.controls.ui(ui, state)).inner {
                    self.open(&path, state);
                }
            });
        let ground =
            Ground::side_top_panel(ui.style()).inner_margin(egui::Margin::symmetric(14, 0));
        egui::Panel::bottom("status")
            .resizable(false)
            .exact_size(STATUS_HEIGHT)
            .frame(ground)
            .show_inside(ui, |ui| {
                ui.centered_and_justified(|ui| ui.horizontal_centered(|ui| self.status(ui, shown)));
            });
        egui::CentralPanel::default()
            .frame(Ground::NONE)
            .show_inside(ui, |ui| self.picture(ui, state, shown));
    }

    fn picture(&mut self, ui: &mut Ui, state: &mut State, shown: &Shown) {
        let area = ui.available_rect_before_wrap();
        let scale = ui.ctx().pixels_per_point();
        if state.fill {
            state.point[SIZE] = Value::Pair(filling_size(area.size() * scale));
        }
        if shown.size().is_none() {
            let job = LayoutJob::simple_singleline(
                "Rendering the first picture".into(),
                theme::medium(15.0),
                theme::MUTED,
            );
            veiled(ui, area, Align2::CENTER_CENTER, job);
            self.toolbar(ui, area, state);
            return;
        }
        let rect = picture_rect(area, state.size(), scale);
        let wipe = if self.is_flipped {
            1.0 - state.wipe.round()
        } else {
            state.shown_wipe()
        };
        let is_stale = [Side::Left, Side::Right].map(|side| self.is_stale(state, shown, side));
        let pixels = |v: egui::Vec2| [v.x, v.y].map(|side| (side * scale).round().max(0.0) as u32);
        self.canvas = Canvas {
            corner: pixels(rect.min.to_vec2()),
            size: pixels(rect.size()),
            wipe,
            is_stale,
        };
        let response = ui.allocate_rect(rect, Sense::click_and_drag());
        self.controls.record("image", &response);
        self.look(ui, state, &response, rect);
        if wipe == state.wipe && !self.is_flipped {
            self.wipe(ui, state, rect);
        }
        let inner = rect.shrink(MARGIN);
        self.captions(ui, shown, inner);
        if let Some(colors) = state.picture.scale().filter(|_| is_stale != [true; 2]) {
            legend(ui, rect, &colors);
        }
        self.toolbar(ui, area, state);
        if self.controls.has_probe {
            let text = overlay::probe(shown, self.probed).trim_end().to_owned();
            let job = LayoutJob::simple(text, FontId::monospace(12.5), theme::INK, f32::INFINITY);
            let below_toolbar = inner.with_min_y(area.top() + 96.0);
            veiled(ui, below_toolbar, Align2::LEFT_TOP, job);
        }
    }

    /// Captions of the halves in the lower corners.
    fn captions(&self, ui: &Ui, shown: &Shown, inner: Rect) {
        let Canvas { wipe, is_stale, .. } = self.canvas;
        let size = vec2(0.5 * inner.width() - MARGIN, inner.height());
        let caption_of = |side: Side, align: Align2, is_stale: bool| {
            if let Some(shot) = shown.side(side) {
                let rect = align.anchor_size(align.pos_in_rect(&inner), size);
                caption(ui, rect, align, shot, is_stale);
            }
        };
        if wipe > 0.0 {
            caption_of(Side::Left, Align2::LEFT_BOTTOM, is_stale[0]);
        }
        if wipe < 1.0 {
            caption_of(Side::Right, Align2::RIGHT_BOTTOM, is_stale[1]);
        }
    }

    /// Whether a half shows another state: at once if the other half or the picture is newer, else
    /// after a moment.
    fn is_stale(&self, state: &State, shown: &Shown, side: Side) -> bool {
        let Some(shot) = shown.side(side) else {
            return false;
        };
        let is_other = shot.kind != state.picture || shot.generation < self.pictured;
        shot.generation != self.generation
            && (is_other
                || self
                    .outdated
                    .is_some_and(|since| since.elapsed() >= BUSY_AFTER))
    }

    fn toolbar(&mut self, ui: &mut Ui, area: Rect, state: &mut State) {
        let rect = Rect::from_min_max(area.min + vec2(MARGIN - 4.0, MARGIN - 4.0), area.max);
        let ground = Ground::new()
            .fill(theme::VEIL)
            .corner_radius(8)
            .inner_margin(4);
        ui.scope_builder(UiBuilder::new().max_rect(rect), |ui| {
            ground.show(ui, |ui| {
                ui.horizontal(|ui| {
                    ui.spacing_mut().item_spacing.x = 4.0;
                    self.pictures(ui, state);
                    ui.separator();
                    self.actions(ui, state);
                });
            });
        });
    }

    /// The buttons that choose what is shown.
    fn pictures(&mut self, ui: &mut Ui, state: &mut State) {
        for PictureButton {
            picture,
            label,
            about,
        } in PICTURE_BUTTONS
        {
            let button = ui
                .selectable_value(&mut state.picture, picture, label)
                .on_hover_text(about);
            self.controls.record(label, &button);
        }
        let choices: Vec<Choice> = Picture::between().map(Choice::code).collect();
        let shown = match state.picture {
            Picture::Between(_) => state.picture.name(),
            _ => "Made of",
        };
        let chosen = self
            .controls
            .menu(ui, "made of", BETWEEN_WIDTH, shown, &choices);
        if let Some(picture) = chosen.and_then(|name| Picture::by_name(&name)) {
            state.picture = *picture;
        }
    }

    fn actions(&mut self, ui: &mut Ui, state: &mut State) {
        let about = "Save the picture, EXR files and commands in a new folder (Ctrl+S)";
        self.wants_save |= self.is_clicked(ui, "Save", about);
        if self.is_clicked(ui, "Reset camera", "Return to the first view (0)") {
            state.view.orbit = HOME;
        }
        let about = "Turn full screen on or off (F)";
        self.wants_fullscreen |= self.is_clicked(ui, "Fullscreen", about);
    }

    /// Shows a button of the toolbar.
    fn is_clicked(&mut self, ui: &mut Ui, label: &str, about: &str) -> bool {
        let button = ui
            .add(egui::Button::new(label).frame_when_inactive(false))
            .on_hover_text(about);
        self.controls.record(label, &button);
        button.clicked()
    }

    /// Turns the camera or the light, moves the wipe, and notes the pixel under the pointer.
    fn look(&mut self, ui: &Ui, state: &mut State, response: &egui::Response, rect: Rect) {
        let has_shift = ui.input(|input| input.modifiers.shift);
        let wheel = ui.input(|input| input.smooth_scroll_delta.y);
        if response.clicked() || response.drag_started() {
            ui.memory_mut(|memory| memory.focused().map(|id| memory.surrender_focus(id)));
        }
        if response.drag_started() {
            let line = rect.left() + state.wipe * rect.width();
            let origin = ui.input(|input| input.pointer.press_origin());
            let is_on_line = origin.is_some_and(|origin| (origin.x - line).abs() <= GRIP);
            self.is_wiping = is_on_line && !self.is_flipped;
        }
        if let Some(pointer) = response
            .interact_pointer_pos()
            .filter(|_| self.is_wiping && response.dragged())
        {
            state.wipe = ((pointer.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
        } else if response.dragged() {
            // Half a turn over the picture's width, as in the report.
            let [dx, dy] = [response.drag_delta().x, response.drag_delta().y]
                .map(|d| f64::from(d / rect.width()) * 180.0);
            if has_shift {
                turn_light(state, dx);
            } else {
                state.view.orbit = turned(state.view.orbit, -dx, dy);
            }
        }
        // The line between the halves lies above the picture.
        if ui.rect_contains_pointer(rect) && wheel != 0.0 {
            state.view.orbit = nearer(state.view.orbit, (f64::from(wheel) * -0.002).exp());
        }
        let [width, height] = state.size();
        let pixel = |share: f32, side: u32| ((share * side as f32).max(0.0) as u32).min(side - 1);
        self.probed = response.hover_pos().map(|pointer| {
            let share = (pointer - rect.min) / rect.size();
            [pixel(share.x, width), pixel(share.y, height)]
        });
    }

    /// Drags and draws the line between the halves. Its whole length lies above the picture that
    /// turns the camera.
    fn wipe(&mut self, ui: &mut Ui, state: &mut State, rect: Rect) {
        let x = rect.left() + state.wipe * rect.width();
        let line = Rect::from_x_y_ranges(x - GRIP..=x + GRIP, rect.y_range());
        let response = ui
            .interact(line, ui.id().with("wipe"), Sense::drag())
            .on_hover_cursor(CursorIcon::ResizeHorizontal);
        self.controls.record("wipe", &response);
        if let Some(pointer) = response
            .interact_pointer_pos()
            .filter(|_| response.dragged())
        {
            state.wipe = ((pointer.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
        }
        wipe_line(
            ui,
            line.translate(vec2(rect.left() + state.wipe * rect.width() - x, 0.0)),
        );
    }

    /// Shows the last notice, or how far the renderer is, in one line.
    fn status(&mut self, ui: &mut Ui, shown: &Shown) {
        let device = shown
            .device
            .as_ref()
            .map_or("", |device| device.name.as_str());
        let is_recent = self
            .noticed_at
            .is_some_and(|time| self.is_fault || time.elapsed() < NOTICE);
        let (text, is_fault) = match &shown.status {
            Status::Refused(why) | Status::Lost(why) | Status::Failed(why) => (why.clone(), true),
            _ if is_recent => (self.notice.clone(), self.is_fault),
            status => (progress(shown, *status == Status::Done), false),
        };
        let hint = if self.has_opened {
            device
        } else {
            "Drop an .hdr or a model here"
        };
        let line = if hint.is_empty() || is_fault {
            text.clone()
        } else {
            format!("{text} · {hint}")
        };
        let color = if is_fault { theme::WARN } else { theme::MUTED };
        ui.add(egui::Label::new(egui::RichText::new(line).color(color)).truncate())
            .on_hover_text(format!("{text}\n{device}"));
    }
}

/// The size of a picture that fills an area of pixels, divided by a whole factor if that is too
/// large.
fn filling_size(area: egui::Vec2) -> [u32; 2] {
    let [width, height] = [area.x, area.y].map(f32::floor);
    let factor = (width * height / PIXELS_MAX).sqrt().ceil().max(1.0);
    [width, height].map(|side| ((side / factor) as u32).max(1))
}

/// Where a picture of `size` pixels is: in the middle, as large as the area has room for. It is
/// enlarged by whole factors. A coarse picture has the rectangle of the whole one.
fn picture_rect(area: Rect, size: [u32; 2], pixels_per_point: f32) -> Rect {
    let [width, height] = size.map(|side| side as f32 / pixels_per_point);
    let fit = (area.width() / width).min(area.height() / height);
    let size = vec2(width, height) * if fit >= 1.0 { fit.floor() } else { fit };
    let corner = (area.center() - 0.5 * size).to_vec2() * pixels_per_point;
    Rect::from_min_size((corner.floor() / pixels_per_point).to_pos2(), size)
}

/// How far the reference is, in words.
fn progress(shown: &Shown, is_done: bool) -> String {
    let Some(truth) = &shown.truth else {
        return "Rendering".to_owned();
    };
    let error = truth
        .frame
        .iter()
        .flat_map(|frame| &frame.convergences)
        .map(|term| term.relative_error)
        .fold(0.0, f64::max);
    let percent = crate::draw::markdown::significant(100.0 * error, 2);
    let samples = truth.image.view.reference_samples;
    let doing = if is_done {
        "Reference done"
    } else {
        "Refining the reference"
    };
    format!("{doing}: {samples} samples a pixel, standard error {percent} %")
}
