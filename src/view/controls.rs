//! The panel: eight controls that matter most, and the rest of the axes under "Advanced".

use super::browse::Browse;
use super::state::{Side, State};
use super::theme;
use crate::base::names::{Listed, capitalised, in_words};
use crate::experiment::axis::{
    ALBEDO, ALPHA, AXES, AxisId, ENVIRONMENT, EXPOSURE, F0, METALLIC, METHOD, Named, Part, Point,
    SAMPLES, SCENE, SIZE,
};
use crate::experiment::value::{Kind, Range, Value};
use crate::instrument::environment::{BUILTIN_PREFIX, BUILTINS};
use crate::instrument::scene::{CameraKind, SCENES};
use crate::instrument::shade::Method;
use egui::{Align2, ComboBox, DragValue, Rect, Response, Slider, SliderClamping, Ui, vec2};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Range of sliders over many decades; other numbers can be typed.
const DECADES: [f64; 2] = [1e-3, 1e3];
const SAMPLES_MAX: u32 = 4096;
const REFERENCE_COUNTS: [u32; 6] = [32, 256, 1024, 4096, 16384, 65536];
const LABEL: egui::Vec2 = vec2(112.0, 26.0);
const SLIDER_WIDTH: f32 = 84.0;
const MENU_WIDTH: f32 = 176.0;
/// Leaves room for a button.
const INPUT_WIDTH: f32 = 116.0;

/// Controls with their places by name, for tests.
#[derive(Default)]
pub struct Controls {
    pub places: BTreeMap<String, Rect>,
    pub has_probe: bool,
    browse: Option<Browse>,
}

impl Controls {
    pub fn place(&mut self, name: impl Into<String>, response: &Response) {
        self.places.insert(name.into(), response.rect);
    }

    /// Shows every control. Returns a file that the user chose.
    pub fn ui(&mut self, ui: &mut Ui, state: &mut State) -> Option<PathBuf> {
        ui.add_space(10.0);
        self.input(ui, ENVIRONMENT, state);
        self.input(ui, SCENE, state);
        self.axis(ui, ALPHA, state);
        self.axis(ui, METALLIC, state);
        self.axis(ui, f0(state), state);
        self.method(ui, "left", state);
        self.method(ui, "right", state);
        let uses_samples = |side| {
            let method = state.image(side, 1).point.method();
            method.uses_samples && !method.is_integrated()
        };
        if [Side::Left, Side::Right].into_iter().any(uses_samples) {
            self.axis(ui, SAMPLES, state);
        }
        self.axis(ui, EXPOSURE, state);
        ui.add_space(4.0);
        let advanced = egui::CollapsingHeader::new("Advanced")
            .show_unindented(ui, |ui| self.advanced(ui, state));
        self.place("advanced", &advanced.header_response);
        let mut browse = self.browse.take()?;
        let chosen = browse.ui(ui, &mut self.places);
        if chosen.is_none() {
            self.browse = Some(browse);
        }
        chosen.flatten()
    }

    fn advanced(&mut self, ui: &mut Ui, state: &mut State) {
        self.row(
            ui,
            "Camera",
            "Drag to turn, wheel to zoom, 0 to reset",
            |controls, ui| {
                for (kind, word) in CameraKind::all().zip(["Parallel", "Perspective"]) {
                    controls.place(
                        kind.name(),
                        &ui.radio_value(&mut state.view.camera, *kind, word),
                    );
                }
            },
        );
        let switches = [
            (
                "background",
                "Environment as background",
                &mut state.view.background,
            ),
            ("fill", "Picture as large as the window", &mut state.fill),
            ("probe", "Values under the pointer (P)", &mut self.has_probe),
        ];
        let placed = switches.map(|(name, label, is_on)| (name, ui.checkbox(is_on, label)));
        placed
            .iter()
            .for_each(|(name, response)| self.place(*name, response));
        self.row(
            ui,
            "Reference up to",
            "Samples a pixel at which the reference stops",
            |controls, ui| {
                let count = &mut state.view.reference_samples;
                let items = REFERENCE_COUNTS.map(|count| (count.to_string(), count.to_string()));
                let chosen = controls.menu(
                    ui,
                    "reference samples",
                    MENU_WIDTH,
                    &count.to_string(),
                    items.into(),
                );
                *count = chosen.and_then(|text| text.parse().ok()).unwrap_or(*count);
            },
        );
        for part in [Part::Case, Part::Method, Part::Display, Part::Table] {
            let heading = part.heading();
            ui.add_space(8.0);
            // The rest concerns flags of `render`.
            ui.heading(heading.split(',').next().unwrap_or(heading));
            let eight = [
                ENVIRONMENT,
                SCENE,
                ALPHA,
                METALLIC,
                f0(state),
                METHOD,
                SAMPLES,
                EXPOSURE,
            ];
            let is_choice = |axis: AxisId| !matches!(AXES[axis].kind, Kind::NameOrFile { names, .. } if names().len() < 2);
            let is_here =
                |axis: &AxisId| AXES[*axis].part.heading() == heading && !eight.contains(axis);
            AXES.ids()
                .filter(is_here)
                .filter(|axis| is_choice(*axis))
                .for_each(|axis| self.axis(ui, axis, state));
        }
    }

    fn row(&mut self, ui: &mut Ui, label: &str, about: &str, add: impl FnOnce(&mut Self, &mut Ui)) {
        ui.horizontal(|ui| {
            let (place, response) = ui.allocate_exact_size(LABEL, egui::Sense::hover());
            let font = egui::TextStyle::Body.resolve(ui.style());
            ui.painter().text(
                place.left_center(),
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

    /// Shows a menu of codes with their words and returns the code that was clicked.
    fn menu(
        &mut self,
        ui: &mut Ui,
        name: &str,
        width: f32,
        shown: &str,
        items: Vec<(String, String)>,
    ) -> Option<String> {
        let words = items
            .iter()
            .find(|(code, _)| code == shown)
            .map_or(shown, |(_, words)| words);
        let combo = ComboBox::from_id_salt(name)
            .width(width)
            .height(900.0)
            .truncate();
        let list = |ui: &mut Ui| {
            ui.set_min_width(MENU_WIDTH);
            let is_clicked = |(code, words): &&(String, String)| {
                let method = Method::all().find(|method| method.name == code);
                let about = method.map_or(String::new(), |method| format!(": {}", method.about));
                let response = ui
                    .selectable_label(code == shown, words)
                    .on_hover_text(format!("{code}{about}"));
                self.place(format!("choice {code}"), &response);
                response.clicked()
            };
            items
                .iter()
                .filter(is_clicked)
                .last()
                .map(|(code, _)| code.clone())
        };
        let cut = |ui: &mut Ui| {
            ui.set_max_width(width);
            combo.selected_text(words).show_ui(ui, list)
        };
        let response = ui.scope(cut).inner;
        response.response.clone().on_hover_text(words);
        self.place(name, &response.response);
        response.inner.flatten()
    }

    /// Shows the built-in names of an environment or scene, and a button for files.
    fn input(&mut self, ui: &mut Ui, axis: AxisId, state: &mut State) {
        let named = Named::own(axis);
        let text = state.point[axis].text().to_owned();
        self.row(
            ui,
            &named.label(),
            &capitalised(named.about()),
            |controls, ui| {
                let mut names: Vec<String> = match axis {
                    ENVIRONMENT => BUILTINS
                        .iter()
                        .map(|built| format!("{BUILTIN_PREFIX}{}", built.name))
                        .collect(),
                    _ => SCENES.iter().map(|scene| scene.name.to_owned()).collect(),
                };
                if !names.contains(&text) {
                    names.push(text.clone());
                }
                let words = |name: &String| match Path::new(name)
                    .extension()
                    .and(Path::new(name).file_name())
                {
                    Some(file) => file.to_string_lossy().into_owned(),
                    None => in_words(name.trim_start_matches(BUILTIN_PREFIX)),
                };
                let items = names
                    .iter()
                    .map(|name| (name.clone(), words(name)))
                    .collect();
                if let Some(name) = controls.menu(ui, named.name(), INPUT_WIDTH, &text, items) {
                    state.point[axis] = Value::from(name);
                }
                let button = ui
                    .button("Open")
                    .on_hover_text("Type a path, or drop a file on the picture");
                controls.place(format!("open {}", named.name()), &button);
                if button.clicked() {
                    controls.browse = Some(Browse {
                        axis,
                        typed: String::new(),
                    });
                }
            },
        );
    }

    fn method(&mut self, ui: &mut Ui, side: &str, state: &mut State) {
        let value = if side == "left" {
            &mut state.point[METHOD]
        } else {
            &mut state.right
        };
        self.row(
            ui,
            &capitalised(side),
            &format!("Method of the {side} half"),
            |controls, ui| {
                let current = Method::listed(value.text());
                let in_file =
                    Some(current).filter(|current| !Method::names().contains(&current.name));
                let items = Method::all()
                    .chain(in_file)
                    .map(|method| (method.name.to_owned(), method.title.to_owned()));
                if let Some(name) =
                    controls.menu(ui, side, MENU_WIDTH, current.name, items.collect())
                {
                    *value = Value::from(name);
                }
            },
        );
    }

    fn axis(&mut self, ui: &mut Ui, axis: AxisId, state: &mut State) {
        let named = Named::usual(axis);
        let label = if axis == f0(state) {
            Named::own(F0).label()
        } else {
            named.label()
        };
        let is_used = |side| {
            let point = state.image(side, 1).point;
            // The reference has its own count.
            point[axis] != Value::Unset && !(axis == SAMPLES && point.method().is_integrated())
        };
        let is_unset = state.point[axis] == Value::Unset;
        let is_used = AXES[axis].part == Part::Display
            || is_unset
            || [Side::Left, Side::Right].into_iter().any(is_used);
        let point = &mut state.point;
        self.row(ui, &label, &capitalised(named.about()), |controls, ui| {
            ui.add_enabled_ui(is_used, |ui| {
                // A control of an unset axis shows its first value; moving it sets the axis.
                let before = if is_unset {
                    first(axis, named, point)
                } else {
                    point[axis].clone()
                };
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
                    controls.place(format!("{} reset", named.name()), &response);
                    if response.clicked() {
                        point[axis] = Value::Unset;
                    }
                }
            });
        });
    }

    fn value(&mut self, ui: &mut Ui, named: Named, is_set: bool, value: &mut Value) {
        ui.spacing_mut().slider_width = SLIDER_WIDTH;
        let (name, shown) = (named.name(), named.shown(value));
        let mut found: Option<String> = None;
        match (named.kind(), &shown) {
            (kind, Value::Number(_) | Value::Count(_)) => {
                let ((range, is_log), is_count) = (reach(kind), matches!(kind, Kind::Count { .. }));
                let mut number = shown.size().unwrap_or_default();
                let slider = Slider::new(&mut number, range)
                    .logarithmic(is_log)
                    .clamping(SliderClamping::Never);
                let slider = if is_count {
                    slider.integer()
                } else {
                    slider.max_decimals(3)
                };
                let response = ui.add(numbered(slider, is_set));
                found = response.changed().then(|| {
                    if is_count {
                        number.to_string()
                    } else {
                        short(number)
                    }
                });
                self.place(name, &response);
            }
            (Kind::Color(_), Value::Color([r, g, b])) => {
                ui.spacing_mut().slider_width = SLIDER_WIDTH - 40.0;
                ui.spacing_mut().interact_size.x = 28.0;
                let mut grey = (r + g + b) / 3.0;
                let mut color = [*r, *g, *b];
                let response = ui.add(numbered(
                    Slider::new(&mut grey, 0.0..=1.0).max_decimals(3),
                    is_set,
                ));
                self.place(name, &response);
                if response.changed() {
                    found = Some(short(grey.into()));
                }
                if ui.color_edit_button_rgb(&mut color).changed() {
                    found = Some(color.map(|x| short(x.clamp(0.0, 1.0).into())).join(":"));
                }
            }
            (Kind::Pair { min, max }, Value::Pair(pair)) => {
                let mut sides = *pair;
                for (side, label) in sides.iter_mut().zip(["", "× "]) {
                    let response = ui.add(DragValue::new(side).range(min..=max).prefix(label));
                    self.place(format!("{name}{label}"), &response);
                }
                found = (sides != *pair).then(|| format!("{}x{}", sides[0], sides[1]));
            }
            (Kind::Name { names, .. } | Kind::NameOrFile { names, .. }, Value::Text(text)) => {
                let items = names()
                    .into_iter()
                    .map(|name| (name.to_owned(), name.to_owned()));
                found = self.menu(ui, name, MENU_WIDTH, text, items.collect());
            }
            _ => {}
        }
        // Ignores numbers out of range.
        if let Some(Ok(parsed)) = found.map(|text| named.parse_text(&text)) {
            *value = parsed;
        }
    }
}

/// Returns the axis of F0: a metal's is its albedo.
fn f0(state: &State) -> AxisId {
    if state.point[METALLIC] == Value::Number(1.0) {
        ALBEDO
    } else {
        F0
    }
}

/// Shows the slider's number, or what an unset axis stands for.
fn numbered(slider: Slider<'_>, is_set: bool) -> Slider<'_> {
    if is_set {
        slider
    } else {
        slider.custom_formatter(|_, _| "model".to_owned())
    }
}

/// Returns the first value of an axis that the user sets.
fn first(axis: AxisId, named: Named, point: &Point) -> Value {
    let of_layout = point.default_of(axis);
    if of_layout != Value::Unset {
        return of_layout;
    }
    let middle = match named.kind() {
        Kind::Number(Range { min, max, .. }) => short(0.5 * (min + max)),
        _ => "0.5".to_owned(),
    };
    named.parse_text(&middle).unwrap_or(Value::Unset)
}

/// Returns a slider's range, and whether it is logarithmic.
fn reach(kind: Kind) -> (std::ops::RangeInclusive<f64>, bool) {
    match kind {
        Kind::Number(Range {
            max,
            min_open: true,
            ..
        }) if max > 1.0 => (DECADES[0]..=DECADES[1].min(max), true),
        Kind::Number(Range { min, max, .. })
        | Kind::NumberOrName {
            range: Range { min, max, .. },
            ..
        } => (min..=max, false),
        Kind::Count { min, max } => (
            f64::from(min)..=f64::from(max.min(SAMPLES_MAX.max(min))),
            true,
        ),
        _ => (crate::experiment::value::ALPHA_MIN..=1.0, false),
    }
}

fn short(number: f64) -> String {
    format!("{number:.3e}")
        .parse::<f64>()
        .unwrap_or(number)
        .to_string()
}
