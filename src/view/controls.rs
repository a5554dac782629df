//! The panel: the inputs, both methods and the sliders of the source documents; the rest of the axes
//! under "Advanced".

use super::browse::Browse;
use super::state::{Side, State};
use super::theme;
use crate::base::names::{Listed, capitalised, in_words};
use crate::experiment::axis::{
    ALBEDO, ALPHA, AXES, AxisId, CONTRAST, ENVIRONMENT, ENVIRONMENT_SCALE, EXPOSURE, F0, Layer,
    METALLIC, METHOD, Named, Part, Point, SAMPLES, SCENE, SIZE,
};
use crate::experiment::value::{Kind, Range, Value};
use crate::instrument::environment::{BUILTIN_PREFIX, BUILTINS};
use crate::instrument::scene::{CameraKind, SCENES};
use crate::instrument::shade::Method;
use egui::{Align2, ComboBox, Rect, Response, Ui, vec2};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const REFERENCE_COUNTS: [u32; 6] = [32, 256, 1024, 4096, 16384, 65536];
const LABEL: egui::Vec2 = vec2(112.0, 26.0);
pub const MENU_WIDTH: f32 = 176.0;
/// Leaves room for a button.
const INPUT_WIDTH: f32 = 116.0;

#[derive(Default)]
pub struct Controls {
    /// Rectangles of the controls by name, for tests.
    pub rects: BTreeMap<String, Rect>,
    pub has_probe: bool,
    browse: Option<Browse>,
}

impl Controls {
    /// Records where a control is.
    pub fn record(&mut self, name: impl Into<String>, response: &Response) {
        self.rects.insert(name.into(), response.rect);
    }

    /// Shows every control. Returns a file that the user chose.
    pub fn ui(&mut self, ui: &mut Ui, state: &mut State) -> Option<PathBuf> {
        ui.add_space(10.0);
        self.input(ui, ENVIRONMENT, state);
        self.input(ui, SCENE, state);
        self.axis(ui, ALPHA, state);
        self.axis(ui, METALLIC, state);
        self.albedo(ui, state);
        self.axis(ui, F0, state);
        self.method(ui, Side::Left, state);
        self.method(ui, Side::Right, state);
        let uses_samples = |side| {
            let method = state.image(side, 1).point.method();
            method.uses_samples && !method.is_integrated()
        };
        if [Side::Left, Side::Right].into_iter().any(uses_samples) {
            self.axis(ui, SAMPLES, state);
        }
        self.axis(ui, ENVIRONMENT_SCALE, state);
        self.axis(ui, EXPOSURE, state);
        self.axis(ui, CONTRAST, state);
        ui.add_space(4.0);
        let advanced = egui::CollapsingHeader::new("Advanced")
            .show_unindented(ui, |ui| self.advanced(ui, state));
        self.record("advanced", &advanced.header_response);
        let mut browse = self.browse.take()?;
        let chosen = browse.ui(ui, &mut self.rects);
        if chosen.is_none() {
            self.browse = Some(browse);
        }
        chosen.flatten()
    }

    fn advanced(&mut self, ui: &mut Ui, state: &mut State) {
        self.camera(ui, state);
        self.switches(ui, state);
        self.reference_samples(ui, state);
        let shown_above = [
            ENVIRONMENT,
            SCENE,
            ALPHA,
            METALLIC,
            ALBEDO,
            F0,
            METHOD,
            SAMPLES,
            ENVIRONMENT_SCALE,
            EXPOSURE,
            CONTRAST,
        ];
        for part in [Part::Case, Part::Method, Part::Display, Part::Table] {
            let heading = part.heading();
            ui.add_space(8.0);
            // The rest concerns flags of `render`.
            ui.heading(heading.split(',').next().unwrap_or(heading));
            for axis in AXES.ids() {
                let is_here = AXES[axis].part.heading() == heading && !shown_above.contains(&axis);
                if is_here && has_choice(axis) {
                    self.axis(ui, axis, state);
                }
            }
        }
    }

    fn camera(&mut self, ui: &mut Ui, state: &mut State) {
        let about = "Drag to turn, wheel to zoom, 0 to reset";
        self.row(ui, "Camera", about, |controls, ui| {
            for (kind, word) in CameraKind::all().zip(["Parallel", "Perspective"]) {
                let button = ui.radio_value(&mut state.view.camera, *kind, word);
                controls.record(kind.name(), &button);
            }
        });
    }

    fn switches(&mut self, ui: &mut Ui, state: &mut State) {
        let background = ui.checkbox(&mut state.view.background, "Environment as background");
        self.record("background", &background);
        let fill = ui.checkbox(&mut state.fill, "Picture as large as the window");
        self.record("fill", &fill);
        let probe = ui.checkbox(&mut self.has_probe, "Values under the pointer (P)");
        self.record("probe", &probe);
    }

    fn reference_samples(&mut self, ui: &mut Ui, state: &mut State) {
        let about = "Samples a pixel at which the reference stops";
        self.row(ui, "Reference up to", about, |controls, ui| {
            let current = state.view.reference_samples.to_string();
            let choices = REFERENCE_COUNTS.map(|count| Choice::code(&count.to_string()));
            let chosen = controls.menu(ui, "reference samples", MENU_WIDTH, &current, &choices);
            if let Some(Ok(count)) = chosen.map(|text| text.parse()) {
                state.view.reference_samples = count;
            }
        });
    }

    fn row(&mut self, ui: &mut Ui, label: &str, about: &str, add: impl FnOnce(&mut Self, &mut Ui)) {
        ui.horizontal(|ui| {
            let (rect, response) = ui.allocate_exact_size(LABEL, egui::Sense::hover());
            let font = egui::TextStyle::Body.resolve(ui.style());
            ui.painter().text(
                rect.left_center(),
                Align2::LEFT_CENTER,
                label,
                font,
                theme::INK,
            );
            // A window has no commands.
            response.on_hover_text(about.split("; `splitsum").next().unwrap_or(about));
            add(self, ui);
        });
    }

    /// Shows a menu and returns the code that was clicked. `shown` is the code of the current
    /// choice.
    pub fn menu(
        &mut self,
        ui: &mut Ui,
        name: &str,
        width: f32,
        shown: &str,
        choices: &[Choice],
    ) -> Option<String> {
        let words = choices
            .iter()
            .find(|choice| choice.code == shown)
            .map_or(shown, |choice| &choice.words);
        let combo = ComboBox::from_id_salt(name)
            .width(width)
            .height(900.0)
            .truncate();
        let response = ui
            .scope(|ui| {
                ui.set_max_width(width);
                combo
                    .selected_text(words)
                    .show_ui(ui, |ui| self.menu_list(ui, shown, choices))
            })
            .inner;
        response.response.clone().on_hover_text(words);
        self.record(name, &response.response);
        response.inner.flatten()
    }

    fn menu_list(&mut self, ui: &mut Ui, shown: &str, choices: &[Choice]) -> Option<String> {
        ui.set_min_width(MENU_WIDTH);
        let mut clicked = None;
        for Choice { code, words } in choices {
            let method = Method::all().find(|method| method.name == code);
            let about = method.map_or(String::new(), |method| format!(": {}", method.about));
            let response = ui
                .selectable_label(code == shown, words)
                .on_hover_text(format!("{code}{about}"));
            self.record(format!("choice {code}"), &response);
            if response.clicked() {
                clicked = Some(code.clone());
            }
        }
        clicked
    }

    /// Shows the built-in names of an environment or scene, and a button for files.
    fn input(&mut self, ui: &mut Ui, axis: AxisId, state: &mut State) {
        let named = Named::primary(axis);
        let current = state.point[axis].text().to_owned();
        let choices = input_choices(axis, &current);
        let about = capitalised(named.about());
        self.row(ui, &named.label(), &about, |controls, ui| {
            let chosen = controls.menu(ui, named.name(), INPUT_WIDTH, &current, &choices);
            if let Some(name) = chosen {
                state.point[axis] = Value::from(name);
            }
            let button = ui
                .button("Open")
                .on_hover_text("Type a path, or drop a file on the picture");
            controls.record(format!("open {}", named.name()), &button);
            if button.clicked() {
                controls.browse = Some(Browse {
                    axis,
                    typed: String::new(),
                });
            }
        });
    }

    fn method(&mut self, ui: &mut Ui, side: Side, state: &mut State) {
        let name = match side {
            Side::Left => "left",
            Side::Right => "right",
        };
        let value = match side {
            Side::Left => &mut state.point[METHOD],
            Side::Right => &mut state.right,
        };
        let about = format!("Method of the {name} half");
        self.row(ui, &capitalised(name), &about, |controls, ui| {
            let current = Method::listed(value.text());
            let in_file = Some(current).filter(|current| !Method::names().contains(&current.name));
            let choices: Vec<Choice> = Method::all()
                .chain(in_file)
                .map(|method| Choice {
                    code: method.name.to_owned(),
                    words: method.title.to_owned(),
                })
                .collect();
            if let Some(code) = controls.menu(ui, name, MENU_WIDTH, current.name, &choices) {
                *value = Value::from(code);
            }
        });
    }

    /// Three sliders of the albedo, as in the source documents.
    fn albedo(&mut self, ui: &mut Ui, state: &mut State) {
        let named = Named::primary(ALBEDO);
        let is_set = state.point[ALBEDO] != Value::Unset;
        let Value::Color(color) = first_or(&state.point, ALBEDO, named) else {
            return;
        };
        for (channel, word) in ["red", "green", "blue"].into_iter().enumerate() {
            let label = format!("{}, {word}", named.label());
            let about = capitalised(named.about());
            self.row(ui, &label, &about, |controls, ui| {
                let name = format!("{} {word}", named.name());
                if let Some(changed) = controls.channel(ui, &name, is_set, color[channel]) {
                    let mut color = color;
                    color[channel] = changed;
                    state.point[ALBEDO] = Value::Color(color);
                }
                if is_set && channel == 0 {
                    let response = ui
                        .small_button("×")
                        .on_hover_text("Return to the model's value");
                    controls.record(format!("{} reset", named.name()), &response);
                    if response.clicked() {
                        state.point[ALBEDO] = Value::Unset;
                    }
                }
            });
        }
    }

    fn axis(&mut self, ui: &mut Ui, axis: AxisId, state: &mut State) {
        let named = Named::usual(axis);
        let label = named.label();
        let is_used = |side| {
            let point = state.image(side, 1).point;
            // The reference has its own count.
            point[axis] != Value::Unset && !(axis == SAMPLES && point.method().is_integrated())
        };
        let is_unset = state.point[axis] == Value::Unset;
        let is_used = AXES[axis].part == Part::Display
            || is_unset
            || [Side::Left, Side::Right].into_iter().any(is_used);
        let is_used = is_used && has_effect(axis, state);
        let point = &mut state.point;
        self.row(ui, &label, &capitalised(named.about()), |controls, ui| {
            ui.add_enabled_ui(is_used, |ui| {
                // A control of an unset axis shows its first value; moving it sets the axis.
                let before = first_or(point, axis, named);
                let mut value = before.clone();
                controls.value(ui, named, !is_unset, &mut value);
                if value != before {
                    state.fill &= axis != SIZE;
                    point[axis] = value;
                }
                if !is_unset && (AXES[axis].default)() == Value::Unset {
                    let response = ui
                        .small_button("×")
                        .on_hover_text("Return to the model's value");
                    controls.record(format!("{} reset", named.name()), &response);
                    if response.clicked() {
                        point[axis] = Value::Unset;
                    }
                }
            });
        });
    }
}

/// An entry of a menu.
pub struct Choice {
    code: String,
    words: String,
}

impl Choice {
    /// An entry that is shown as its code.
    pub fn code(code: &str) -> Self {
        Self {
            code: code.to_owned(),
            words: code.to_owned(),
        }
    }
}

/// Whether an axis has several values to choose from without a file.
fn has_choice(axis: AxisId) -> bool {
    match AXES[axis].kind {
        Kind::NameOrFile { names, .. } => names().len() >= 2,
        _ => true,
    }
}

/// The built-in environments or scenes, and the current one if it is a file.
fn input_choices(axis: AxisId, current: &str) -> Vec<Choice> {
    let mut choices: Vec<Choice> = if axis == ENVIRONMENT {
        BUILTINS
            .iter()
            .map(|built| Choice {
                code: format!("{BUILTIN_PREFIX}{}", built.name),
                words: in_words(built.name),
            })
            .collect()
    } else {
        SCENES
            .iter()
            .map(|scene| Choice {
                code: scene.name.to_owned(),
                words: in_words(scene.name),
            })
            .collect()
    };
    if choices.iter().all(|choice| choice.code != current) {
        let path = Path::new(current);
        let file_name = path.extension().and(path.file_name());
        choices.push(Choice {
            code: current.to_owned(),
            words: match file_name {
                Some(name) => name.to_string_lossy().into_owned(),
                None => in_words(current.trim_start_matches(BUILTIN_PREFIX)),
            },
        });
    }
    choices
}

/// Whether an axis may change the picture, as far as the methods do not tell: a metal has no F0 but
/// its albedo, and axes of lights need lights.
fn has_effect(axis: AxisId, state: &State) -> bool {
    let is_built_in = SCENES
        .iter()
        .any(|scene| scene.name == state.point[SCENE].text());
    if Layer::Lights.has(axis) {
        return !state.view.lights.is_empty() || !is_built_in;
    }
    axis != F0 || state.point[METALLIC] != Value::Number(1.0)
}

/// Returns the value of an axis; of an unset one, its first value.
fn first_or(point: &Point, axis: AxisId, named: Named) -> Value {
    if point[axis] == Value::Unset {
        first(axis, named, point)
    } else {
        point[axis].clone()
    }
}

/// Returns the first value of an axis that the user sets.
fn first(axis: AxisId, named: Named, point: &Point) -> Value {
    let default = point.default_of(axis);
    if default != Value::Unset {
        return default;
    }
    let middle = match named.kind() {
        Kind::Number(Range { min, max, .. }) => short(0.5 * (min + max)),
        _ => "0.5".to_owned(),
    };
    named.parse_text(&middle).unwrap_or(Value::Unset)
}

/// Rounds to four significant digits.
pub fn short(number: f64) -> String {
    format!("{number:.3e}")
        .parse::<f64>()
        .unwrap_or(number)
        .to_string()
}
