//! Long because each part of the window is listed once, in visual order.
//!
//! The window's content: controls on the left, the picture, numbers below it. Keys are those of the report.

use super::controls::Controls;
use super::overlay::{composed, label, legend, outlined, text, wipe_line};
use super::picture::{Picture, Tone, at};
use super::state::{Side, State};
use super::worker::{Shown, Standing};
use crate::experiment::axis::{AXES, ENVIRONMENT, ENVIRONMENT_ROTATION, EXPOSURE, METHOD, SCENE};
use crate::experiment::value::{Value, decimal};
use crate::pipeline::Frame;
use crate::scene::{CameraKind, Light, LightKind, Orbit, scene_extensions, scene_format};
use crate::spelling::Listed;
use egui::{Align2, Color32, ColorImage, CursorIcon, DragValue, Key, Pos2, Rect, Sense, Stroke, TextureHandle};
use egui::{TextureOptions, Ui, UiBuilder, pos2, vec2};
use glam::DVec3;
use std::collections::VecDeque;
use std::sync::Arc;

const PANEL_WIDTH: f32 = 376.0;
const NUMBERS_HEIGHT: f32 = 164.0;
/// Frames in the graph of times.
const TIMES: usize = 120;
/// Sample counts for the reference.
const REFERENCE_COUNTS: [u32; 6] = [32, 128, 512, 2048, 8192, 32768];
/// Turn by an arrow key, degrees, and distance factor of + and -.
const KEY_DEG: f64 = 5.0;
const KEY_ZOOM: f64 = 1.15;
/// Direction or position of an added light.
const LIGHT: [f64; 3] = [1.5, 2.0, 2.5];
const COORDINATES: std::ops::RangeInclusive<f64> = -100.0..=100.0;

struct Painted {
    texture: TextureHandle,
    of: (u64, usize, f32, bool),
}

/// The window's own state.
#[derive(Default)]
pub struct Panel {
    pub controls: Controls,
    /// One line about the last action.
    pub notice: String,
    is_fault: bool,
    pub wants_save: bool,
    painted: Option<Painted>,
    /// Number of updates from the renderer.
    arrivals: usize,
    /// Times of the left half's frames, ms.
    times: VecDeque<f64>,
    last: Option<Arc<Frame>>,
    probed: Option<[u32; 2]>,
    is_flipped: bool,
}

impl Panel {
    /// Records an update from the renderer.
    pub fn arrive(&mut self, shown: &Shown) {
        self.arrivals += 1;
        let is_new = |frame: &Arc<Frame>| !self.last.as_ref().is_some_and(|last| Arc::ptr_eq(last, frame));
        if let Some(shot) = shown.left.as_ref().filter(|shot| is_new(&shot.frame)) {
            self.last = Some(shot.frame.clone());
            self.times.push_back(shot.frame.timings.wall_ms);
            if self.times.len() > TIMES {
                self.times.pop_front();
            }
        }
    }

    pub fn tell(&mut self, notice: String) {
        (self.notice, self.is_fault) = (notice, false);
    }

    pub fn tell_fault(&mut self, notice: String) {
        (self.notice, self.is_fault) = (notice, true);
    }

    /// Opens a file dropped on the window.
    pub fn dropped(&mut self, path: &std::path::Path, state: &mut State) {
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        let axis = match extension.as_str() {
            "hdr" | "exr" => ENVIRONMENT,
            _ if scene_format(path).is_some() => SCENE,
            _ => {
                self.tell_fault(format!("{}: expected an .hdr, .exr, {} file", path.display(), scene_extensions()));
                return;
            }
        };
        self.tell(format!("{}: {}", AXES[axis].name, path.display()));
        state.point[axis] = Value::Text(path.display().to_string().into());
    }

    pub fn ui(&mut self, ui: &mut Ui, state: &mut State, shown: &Shown) {
        self.controls.places.clear();
        self.keys(ui, state);
        egui::Panel::left("controls").resizable(false).exact_size(PANEL_WIDTH).show_inside(ui, |ui| {
            egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| self.all_controls(ui, state, shown));
        });
        egui::Panel::bottom("numbers").resizable(false).exact_size(NUMBERS_HEIGHT).show_inside(ui, |ui| {
            self.numbers(ui, shown);
        });
        egui::CentralPanel::default().show_inside(ui, |ui| self.picture(ui, state, shown));
    }

    fn keys(&mut self, ui: &Ui, state: &mut State) {
        let context = ui.ctx().clone();
        if context.memory(|memory| memory.focused()).is_some() {
            self.is_flipped = false;
            return;
        }
        context.input(|input| {
            self.is_flipped = input.key_down(Key::Space);
            let mut stops = 0.0;
            for event in &input.events {
                let egui::Event::Key { key, pressed: true, modifiers, .. } = event else { continue };
                // A slow pass sees several keys, each with its own modifiers.
                let (picture, orbit, shift) = (state.picture, state.view.orbit, modifiers.shift);
                let toggled = |wanted: Picture| if picture == wanted { Picture::Image } else { wanted };
                let turn = |yaw: f64, pitch: f64| turned(orbit, yaw, pitch);
                match key {
                    key if modifiers.command => self.wants_save |= *key == Key::S,
                    Key::E => state.picture = toggled(Picture::Error),
                    Key::S => state.picture = toggled(Picture::Signed),
                    Key::T => state.tone = if state.tone == Tone::Curve { Tone::Srgb } else { Tone::Curve },
                    Key::D => state.wipe = if state.wipe == 1.0 { 0.5 } else { 1.0 },
                    Key::OpenBracket => stops -= 0.5,
                    Key::CloseBracket => stops += 0.5,
                    Key::Plus | Key::Equals => state.view.orbit = nearer(orbit, 1.0 / KEY_ZOOM),
                    Key::Minus => state.view.orbit = nearer(orbit, KEY_ZOOM),
                    Key::Num0 => state.view.orbit = Orbit::default(),
                    Key::ArrowLeft if shift => turn_light(state, -KEY_DEG),
                    Key::ArrowRight if shift => turn_light(state, KEY_DEG),
                    Key::ArrowLeft => state.view.orbit = turn(-KEY_DEG, 0.0),
                    Key::ArrowRight => state.view.orbit = turn(KEY_DEG, 0.0),
                    Key::ArrowUp => state.view.orbit = turn(0.0, KEY_DEG),
                    Key::ArrowDown => state.view.orbit = turn(0.0, -KEY_DEG),
                    key => {
                        // Keys 1 to 9 choose a method in list order.
                        let digit = key.symbol_or_name().parse::<usize>().ok().filter(|digit| *digit > 0);
                        if let Some(method) = digit.and_then(|digit| crate::shade::METHODS.get(digit - 1)) {
                            state.point[METHOD] = Value::Text(method.name.to_owned().into());
                        }
                    }
                }
            }
            if stops != 0.0 {
                let exposure = (state.point[EXPOSURE].number() * 2f64.powf(stops)).clamp(1e-6, 1e9);
                state.point[EXPOSURE] = Value::Number(decimal(exposure));
            }
        });
    }

    fn all_controls(&mut self, ui: &mut Ui, state: &mut State, shown: &Shown) {
        ui.add_space(4.0);
        self.controls.row(
            ui,
            "picture",
            "image, error (e), signed error (s), difference of the halves, g-buffer or tables",
            |controls, ui| {
                let items: Vec<String> = Picture::names().into_iter().map(str::to_owned).collect();
                let chosen = controls.menu(ui, "picture", 180.0, state.picture.name(), &items);
                state.picture = chosen.map_or(state.picture, |name| *Picture::listed(&name));
            },
        );
        if state.picture == Picture::Prefiltered {
            self.controls.row(ui, "level", "level of the prefiltered map", |controls, ui| {
                let last = shown.level_count.max(1) - 1;
                controls.place("level", &ui.add(egui::Slider::new(&mut state.level, 0..=last)));
            });
        }
        self.controls.row(ui, "camera", "drag to turn, wheel to zoom, 0 to reset", |controls, ui| {
            for kind in CameraKind::all() {
                controls.place(kind.name(), &ui.radio_value(&mut state.view.camera, *kind, kind.name()));
            }
            controls.place("background", &ui.checkbox(&mut state.view.background, "background"));
        });
        self.controls.row(ui, "tone", "tone curve or sRGB (t)", |controls, ui| {
            for tone in Tone::all() {
                controls.place(tone.name(), &ui.radio_value(&mut state.tone, *tone, tone.name()));
            }
        });
        self.controls.row(ui, "reference samples", "samples per pixel at which the reference stops", |controls, ui| {
            let count = &mut state.view.reference_samples;
            let items = REFERENCE_COUNTS.map(|count| count.to_string());
            let chosen = controls.menu(ui, "reference samples", 80.0, &count.to_string(), &items);
            *count = chosen.and_then(|text| text.parse().ok()).unwrap_or(*count);
            let save = ui.button("save").on_hover_text("ctrl+S: picture, linear images, state, commands, experiment");
            self.wants_save |= save.clicked();
            controls.place("save", &save);
        });
        self.controls.axes(ui, state);
        let lights = &mut state.view.lights;
        let section = egui::CollapsingHeader::new("Analytic lights").default_open(!lights.is_empty());
        let section = section.show(ui, |ui| self.lights(ui, lights));
        self.controls.place("Analytic lights", &section.header_response);
        ui.add_space(6.0);
        ui.weak("drag: camera · shift+drag: light · wheel: zoom\nspace: other half · d: wipe · e, s: errors · [ ]: exposure");
    }

    fn lights(&mut self, ui: &mut Ui, lights: &mut Vec<Light>) {
        ui.horizontal(|ui| {
            for kind in LightKind::all() {
                let label = format!("add {}", kind.name());
                let response = ui.button(&label);
                self.controls.place(label, &response);
                if response.clicked() {
                    let place = DVec3::from(LIGHT);
                    let place = if *kind == LightKind::Directional { place.normalize() } else { place };
                    // Files and flags hold f32.
                    let position_or_direction = place.as_vec3().as_dvec3();
                    lights.push(Light { kind: *kind, position_or_direction, color: [1.0; 3] });
                }
            }
        });
        let mut gone = None;
        for (index, light) in lights.iter_mut().enumerate() {
            ui.horizontal(|ui| {
                ui.label(light.kind.name());
                let mut place = light.position_or_direction.as_vec3().to_array();
                let mut is_moved = false;
                for (x, axis) in place.iter_mut().zip(["x", "y", "z"]) {
                    let response = ui.add(DragValue::new(x).speed(0.05).range(COORDINATES).max_decimals(2));
                    self.controls.place(format!("light {index} {axis}"), &response);
                    is_moved |= response.changed();
                }
                if is_moved && let Ok(moved) = crate::experiment::lights::light(light.kind, place, Some(light.color)) {
                    light.position_or_direction = moved.position_or_direction.as_vec3().as_dvec3();
                }
                let most = light.color.into_iter().fold(0.0, f32::max);
                let mut strength = most;
                let response = ui.add(DragValue::new(&mut strength).speed(0.05).range(0.01..=1e6).prefix("× "));
                self.controls.place(format!("light {index} strength"), &response);
                if response.changed() && most > 0.0 {
                    light.color = light.color.map(|x| x / most * strength);
                }
                let mut hue = light.color.map(|x| if most > 0.0 { x / most } else { 1.0 });
                if ui.color_edit_button_rgb(&mut hue).changed() {
                    light.color = hue.map(|x| x.max(0.0) * most);
                }
                if ui.small_button("×").clicked() {
                    gone = Some(index);
                }
            });
        }
        gone.map(|index| lights.remove(index));
    }

    fn picture(&mut self, ui: &mut Ui, state: &mut State, shown: &Shown) {
        let area = ui.available_rect_before_wrap();
        let wipe = if self.is_flipped { 1.0 - state.wipe.round() } else { state.wipe };
        let wipe = if state.picture.has_sides() { wipe } else { 1.0 };
        self.paint(ui.ctx(), state, shown, wipe);
        let Some(painted) = &self.painted else {
            text(ui, area.center(), Align2::CENTER_CENTER, "rendering the first picture", 16.0, Color32::GRAY);
            return;
        };
        // Enlarges by whole factors.
        let scale = ui.ctx().pixels_per_point();
        // A coarse picture fills the place of the whole one.
        let table = painted.texture.size().map(|side| side as f32);
        let sides = if state.picture.is_table() { table } else { state.size().map(|side| side as f32) };
        let [width, height] = sides.map(|side| side / scale);
        let fit = (area.width() / width).min(area.height() / height);
        let zoom = if fit >= 1.0 { fit.floor() } else { fit };
        let size = vec2(width, height) * zoom;
        let corner = ((area.center() - 0.5 * size).to_vec2() * scale).round() / scale;
        let rect = Rect::from_min_size(corner.to_pos2(), size);
        // The painter samples half a pixel to the upper left.
        let half = vec2(0.5 / table[0], 0.5 / table[1]);
        let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0)).translate(half);
        ui.painter().image(painted.texture.id(), rect, whole, Color32::WHITE);
        let response = ui.allocate_rect(rect, Sense::click_and_drag());
        self.controls.place("image", &response);
        self.look(ui, state, &response, rect);
        if !state.picture.has_sides() {
            match state.picture.scale() {
                Some(colors) => legend(ui, rect, &colors, state.picture.about()),
                None => {
                    let place = rect.left_top() + vec2(6.0, 5.0);
                    outlined(ui, place, Align2::LEFT_TOP, state.picture.about(), rect.width() - 12.0);
                }
            }
            return;
        }
        self.handle(ui, state, rect);
        for (side, align, x) in
            [(Side::Left, Align2::LEFT_TOP, rect.left() + 6.0), (Side::Right, Align2::RIGHT_TOP, rect.right() - 6.0)]
        {
            let is_seen = if side == Side::Left { wipe > 0.05 } else { wipe < 0.95 };
            if let Some(shot) = shown.side(side).filter(|_| is_seen) {
                outlined(ui, pos2(x, rect.top() + 5.0), align, &label(shot), 0.5 * rect.width() - 12.0);
            }
        }
        if let Some(colors) = state.picture.scale() {
            legend(ui, rect, &colors, state.picture.about());
        }
    }

    /// Handles the camera, the light and the probe.
    fn look(&mut self, ui: &Ui, state: &mut State, response: &egui::Response, rect: Rect) {
        let (shift, wheel) = ui.input(|input| (input.modifiers.shift, input.smooth_scroll_delta.y));
        if response.clicked() || response.drag_started() {
            ui.memory_mut(|memory| memory.focused().map(|id| memory.surrender_focus(id)));
        }
        if response.dragged() {
            // Half a turn over the picture's width, as in the report.
            let [dx, dy] =
                [response.drag_delta().x, response.drag_delta().y].map(|d| f64::from(d / rect.width()) * 180.0);
            if shift {
                turn_light(state, dx);
            } else {
                state.view.orbit = turned(state.view.orbit, -dx, dy);
            }
        }
        if response.hovered() && wheel != 0.0 {
            state.view.orbit = nearer(state.view.orbit, (f64::from(wheel) * -0.002).exp());
        }
        let [width, height] = state.size();
        let pointer = response.hover_pos().filter(|_| !state.picture.is_table());
        self.probed = pointer.map(|place| {
            let share = (place - rect.min) / rect.size();
            [(share.x, width), (share.y, height)].map(|(x, side)| ((x * side as f32).max(0.0) as u32).min(side - 1))
        });
    }

    /// Drags and draws the line between the halves.
    fn handle(&mut self, ui: &mut Ui, state: &mut State, rect: Rect) {
        let x = rect.left() + state.wipe * rect.width();
        // Above the legend of an error.
        let height = if state.picture.scale().is_some() { 76.0 } else { 24.0 };
        let place = Rect::from_center_size(pos2(x, rect.bottom() - height), vec2(18.0, 30.0));
        let response =
            ui.interact(place, ui.id().with("wipe"), Sense::drag()).on_hover_cursor(CursorIcon::ResizeHorizontal);
        self.controls.place("wipe", &response);
        if let Some(pointer) = response.interact_pointer_pos().filter(|_| response.dragged()) {
            state.wipe = ((pointer.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
        }
        if !self.is_flipped {
            wipe_line(ui, rect, x, place);
        }
    }

    /// Updates the texture if its content changed.
    fn paint(&mut self, context: &egui::Context, state: &State, shown: &Shown, wipe: f32) {
        let of = (shown.generation, self.arrivals, wipe, state.picture.has_sides());
        if self.painted.as_ref().is_some_and(|painted| painted.of == of) {
            return;
        }
        let Some(image) = composed(shown, wipe) else { return };
        let size = [image.width, image.height].map(|side| side as usize);
        let pixels = image.data.iter().map(|[r, g, b]| Color32::from_rgb(*r, *g, *b)).collect();
        let image = ColorImage::new(size, pixels);
        match &mut self.painted {
            Some(painted) => {
                painted.texture.set(image, TextureOptions::NEAREST);
                painted.of = of;
            }
            None => {
                let texture = context.load_texture("picture", image, TextureOptions::NEAREST);
                self.painted = Some(Painted { texture, of });
            }
        }
    }

    fn numbers(&mut self, ui: &mut Ui, shown: &Shown) {
        let whole = ui.available_rect_before_wrap();
        let (left, right) = whole.split_left_right_at_fraction(0.76);
        ui.scope_builder(UiBuilder::new().max_rect(left.shrink2(vec2(4.0, 2.0))), |ui| {
            ui.spacing_mut().item_spacing.y = 2.0;
            let color = matches!(shown.standing, Standing::Refused(_)).then(|| ui.visuals().warn_fg_color);
            ui.label(egui::RichText::new(standing(shown)).color(color.unwrap_or(ui.visuals().text_color())));
            ui.add_space(2.0);
            self.probe(ui, shown);
            if !self.notice.is_empty() {
                let text = egui::RichText::new(&self.notice);
                let text = if self.is_fault { text.color(ui.visuals().warn_fg_color) } else { text.weak() };
                ui.label(text);
            }
        });
        ui.scope_builder(UiBuilder::new().max_rect(right.shrink2(vec2(4.0, 2.0))), |ui| {
            ui.spacing_mut().item_spacing.y = 1.0;
            self.graph(ui, shown);
        });
    }

    /// Shows linear values under the pointer.
    fn probe(&self, ui: &mut Ui, shown: &Shown) {
        egui::Grid::new("probe").num_columns(4).spacing(vec2(8.0, 2.0)).show(ui, |ui| {
            let place = self
                .probed
                .map_or_else(|| "linear values: point at a pixel".to_owned(), |[x, y]| format!("pixel ({x}, {y})"));
            ui.weak(place);
            ui.weak("red, green, blue");
            ui.weak(crate::metrics::HEADLINE);
            ui.weak("standard error");
            ui.end_row();
            for (name, shot) in [("left", &shown.left), ("right", &shown.right), ("truth", &shown.truth)] {
                let Some(shot) = shot else {
                    ui.label(name);
                    ui.end_row();
                    continue;
                };
                ui.label(format!("{name}: {}", shot.image.point.method().name));
                let value = |image: &crate::pixels::RgbImage| {
                    let [x, y] = self.probed?;
                    at(image, x / shot.scale, y / shot.scale).map(|rgb| rgb.map(|c| format!("{c:.4}")).join(" "))
                };
                // As wide as the values, so that columns stay in place.
                ui.monospace(value(&shot.frame.radiance).unwrap_or_else(|| "  –      –      –   ".to_owned()));
                ui.monospace(shot.score.map_or_else(String::new, |score| format!("{score:.3e}")));
                ui.monospace(shot.frame.standard_error.as_ref().and_then(value).unwrap_or_default());
                ui.end_row();
            }
        });
    }

    /// Shows times of recent frames and of the last frame's passes.
    fn graph(&self, ui: &mut Ui, shown: &Shown) {
        let cpu = shown.device.as_ref().is_some_and(|device| device.device_type == "cpu");
        let unit = if cpu { "CPU times" } else { "GPU times" };
        let last = self.times.back().copied().unwrap_or_default();
        ui.weak(format!("left {last:.0} ms, {unit}"));
        let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 36.0), Sense::hover());
        let most = self.times.iter().copied().fold(1.0, f64::max);
        ui.painter().rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
        let place = |(index, ms): (usize, &f64)| {
            let x = rect.right() - (self.times.len() - 1 - index) as f32 * rect.width() / (TIMES - 1) as f32;
            pos2(x, rect.bottom() - 2.0 - (ms / most) as f32 * (rect.height() - 4.0))
        };
        let line: Vec<Pos2> = self.times.iter().enumerate().map(place).collect();
        ui.painter().line(line, Stroke::new(1.5, Color32::LIGHT_BLUE));
        let place = rect.left_top() + vec2(3.0, 2.0);
        text(ui, place, Align2::LEFT_TOP, &format!("{most:.0} ms"), 10.0, Color32::GRAY);
        let Some(shot) = &shown.left else { return };
        egui::Grid::new("passes").num_columns(2).spacing(vec2(8.0, 0.0)).show(ui, |ui| {
            for time in &shot.frame.timings.frame {
                ui.label(time.pass);
                ui.monospace(format!("{:6.2}", time.ms));
                ui.end_row();
            }
        });
    }
}

/// Describes the renderer's state in one line.
fn standing(shown: &Shown) -> String {
    let device = shown.device.as_ref().map_or("", |device| device.name.as_str());
    let refined = shown.truth.as_ref().map_or_else(String::new, |shot| {
        let errors = shot.frame.convergences.iter().map(|term| term.relative_error);
        let error = errors.fold(0.0, f64::max);
        format!(" · reference {} samples, relative standard error {error:.1e}", shot.image.view.reference_samples)
    });
    match &shown.standing {
        Standing::Busy => format!("refining{refined} · {device}"),
        Standing::Done => format!("done{refined} · {device}"),
        Standing::Refused(why) | Standing::Lost(why) | Standing::Failed(why) => why.clone(),
    }
}

/// Turns the orbit, in hundredths of a degree.
fn turned(orbit: Orbit, yaw: f64, pitch: f64) -> Orbit {
    let yaw_deg = (orbit.yaw_deg + yaw + 180.0).rem_euclid(360.0) - 180.0;
    rounded(Orbit { yaw_deg, pitch_deg: (orbit.pitch_deg + pitch).clamp(-180.0, 180.0), ..orbit })
}

fn nearer(orbit: Orbit, factor: f64) -> Orbit {
    let [nearest, farthest] = Orbit::DISTANCE;
    rounded(Orbit { distance: (orbit.distance * factor).clamp(nearest, farthest), ..orbit })
}

/// Rounds as files and flags write it.
fn rounded(orbit: Orbit) -> Orbit {
    let [yaw, pitch, distance] = orbit.numbers();
    let to = |x: f32, digits: f32| (x * digits).round() / digits;
    Orbit::new([to(yaw, 100.0), to(pitch, 100.0), to(distance, 1000.0)]).unwrap_or(orbit)
}

fn turn_light(state: &mut State, by: f64) {
    let old = state.point[ENVIRONMENT_ROTATION].number();
    let turned = (old + by + 180.0).rem_euclid(360.0) - 180.0;
    state.point[ENVIRONMENT_ROTATION] = Value::Number(decimal((turned * 100.0).round() / 100.0));
}
