//! A control for each axis, made from the list of axes.

use super::overlay::text;
use super::state::{Side, State};
use crate::environment::{BUILTIN_PREFIX, BUILTINS};
use crate::experiment::axis::{AXES, ENVIRONMENT, METHOD, Named, Part, Point, SAMPLES, SIZE};
use crate::experiment::value::{Kind, Range, Value};
use crate::scene::SCENES;
use egui::{Align2, ComboBox, DragValue, Rect, Response, Slider, SliderClamping, TextEdit, Ui};
use std::collections::BTreeMap;
use std::path::Path;

/// Sides in the size menu.
const SIZES: [u32; 5] = [128, 256, 512, 768, 1024];
/// Range of sliders over many decades; other numbers can be typed.
const DECADES: [f64; 2] = [1e-3, 1e3];
/// Largest sample count of a slider.
const SAMPLES_MAX: u32 = 4096;
const SLIDER_WIDTH: f32 = 100.0;
const LABEL: egui::Vec2 = egui::vec2(112.0, 18.0);

/// Places of the controls by name, for tests, and unfinished text.
#[derive(Default)]
pub struct Controls {
    pub places: BTreeMap<String, Rect>,
    typed: BTreeMap<usize, String>,
}

impl Controls {
    pub fn place(&mut self, name: impl Into<String>, response: &Response) {
        self.places.insert(name.into(), response.rect);
    }

    /// Shows every axis under the headings of `render`'s help.
    pub fn axes(&mut self, ui: &mut Ui, state: &mut State) {
        let used = [Side::Left, Side::Right].map(|side| {
            let mut point = state.image(side, 1).point;
            // The reference has its own count.
            if point.method().is_integrated() {
                point[SAMPLES] = Value::Unset;
            }
            point
        });
        for part in [Part::Case, Part::Method, Part::Display, Part::Table] {
            let (heading, is_open) = (part.heading(), part != Part::Table);
            // The rest concerns flags of `render`.
            let short = heading.split(',').next().unwrap_or(heading);
            let section = egui::CollapsingHeader::new(short).default_open(is_open).show(ui, |ui| {
                for axis in (0..AXES.len()).filter(|&axis| AXES[axis].part.heading() == heading) {
                    let is_used = AXES[axis].part == Part::Display
                        || used.iter().any(|point| point[axis] != Value::Unset)
                        || state.point[axis] == Value::Unset;
                    self.axis(ui, axis, is_used, &mut state.point);
                    if axis == METHOD {
                        let right = &mut state.right;
                        self.row(ui, "right", "method of the right half", |controls, ui| {
                            controls.value(ui, "right", (METHOD, Named::usual(METHOD), true), right)
                        });
                    }
                }
            });
            self.place(heading, &section.header_response);
        }
    }

    pub fn row(&mut self, ui: &mut Ui, name: &str, about: &str, add: impl FnOnce(&mut Self, &mut Ui)) {
        ui.horizontal(|ui| {
            let label = name.replace('_', " ").replace("sample count", "samples");
            let label = label.replace("environment ", "").replace("perceptual ", "");
            let (place, response) = ui.allocate_exact_size(LABEL, egui::Sense::hover());
            text(ui, place.left_center(), Align2::LEFT_CENTER, &label, 13.0, ui.visuals().text_color());
            response.on_hover_text(about);
            add(self, ui);
        });
    }

    /// Shows a menu and returns the name that was clicked.
    pub fn menu(&mut self, ui: &mut Ui, name: &str, width: f32, shown: &str, items: &[String]) -> Option<String> {
        let combo = ComboBox::from_id_salt(name).width(width).height(520.0).selected_text(shown);
        let response = combo.show_ui(ui, |ui| {
            let is_clicked = |item: &&String| {
                let response = ui.selectable_label(*item == shown, *item);
                self.place(format!("choice {item}"), &response);
                response.clicked()
            };
            items.iter().filter(is_clicked).last().cloned()
        });
        self.place(name, &response.response);
        response.inner.flatten()
    }

    fn axis(&mut self, ui: &mut Ui, axis: usize, is_used: bool, point: &mut Point) {
        let named = Named::usual(axis);
        let may_be_unset = (AXES[axis].default)() == Value::Unset;
        self.row(ui, named.name(), named.about(), |controls, ui| {
            ui.add_enabled_ui(is_used, |ui| {
                if may_be_unset {
                    let mut is_set = point[axis] != Value::Unset;
                    let about = "without a tick the scene or layout decides; the slider sets it";
                    let response = ui.checkbox(&mut is_set, "").on_hover_text(about);
                    controls.place(format!("{} set", named.name()), &response);
                    if response.changed() {
                        point[axis] = if is_set { first(axis, named, point) } else { Value::Unset };
                    }
                    if !is_set {
                        ui.multiply_opacity(0.5);
                    }
                }
                // A control of an unset axis shows its first value; moving it sets the axis.
                let is_set = point[axis] != Value::Unset;
                let before = if is_set { point[axis].clone() } else { first(axis, named, point) };
                let mut value = before.clone();
                controls.value(ui, named.name(), (axis, named, is_set), &mut value);
                if value != before {
                    point[axis] = value;
                }
            });
        });
    }

    /// Shows a value; ignores invalid input.
    fn value(&mut self, ui: &mut Ui, name: &str, (axis, named, is_set): (usize, Named, bool), value: &mut Value) {
        ui.spacing_mut().slider_width = SLIDER_WIDTH;
        let shown = named.shown(value);
        let mut found: Option<String> = None;
        match (named.kind(), &shown) {
            (Kind::Number(_) | Kind::Alpha | Kind::NumberOrName { .. }, Value::Number(x)) => {
                let (range, is_log) = reach(named.kind());
                let mut number = *x;
                let slider = Slider::new(&mut number, range).logarithmic(is_log).clamping(SliderClamping::Never);
                let response = ui.add(numbered(slider.max_decimals(3), is_set));
                found = response.changed().then(|| short(number));
                self.place(name, &response);
            }
            (Kind::Count { min, max }, Value::Count(n)) => {
                let mut count = *n;
                let range = min..=max.min(SAMPLES_MAX.max(min));
                let slider = Slider::new(&mut count, range).logarithmic(true).clamping(SliderClamping::Never);
                let response = ui.add(slider);
                found = response.changed().then(|| count.to_string());
                self.place(name, &response);
            }
            (Kind::Color(_), Value::Color([r, g, b])) => {
                let mut grey = (r + g + b) / 3.0;
                let mut color = [*r, *g, *b];
                let response = ui.add(numbered(Slider::new(&mut grey, 0.0..=1.0).max_decimals(3), is_set));
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
                if axis == SIZE {
                    let items = SIZES.map(|side| side.to_string());
                    let chosen = self.menu(ui, &format!("{name} list"), 50.0, "…", &items);
                    sides = chosen.and_then(|side| side.parse().ok()).map_or(sides, |side| [side; 2]);
                }
                found = (sides != *pair).then(|| format!("{}x{}", sides[0], sides[1]));
            }
            (Kind::Name { names, .. } | Kind::NameOrFile { names, .. }, Value::Text(text)) => {
                let items: Vec<String> = names().into_iter().map(str::to_owned).collect();
                found = self.menu(ui, name, SLIDER_WIDTH + 58.0, text, &items);
            }
            (Kind::Input, Value::Text(text)) => found = self.input(ui, name, axis, text),
            _ => {}
        }
        // Ignores numbers out of range and unfinished words.
        if let Some(Ok(parsed)) = found.map(|text| named.parse_text(&text)) {
            *value = parsed;
        }
    }

    /// Shows a list of built-in names and a field for a path.
    fn input(&mut self, ui: &mut Ui, name: &str, axis: usize, text: &str) -> Option<String> {
        let typed = self.typed.entry(axis).or_insert_with(|| text.to_owned());
        let field = TextEdit::singleline(typed).desired_width(SLIDER_WIDTH + 14.0).hint_text("path of a file");
        let field = ui.add(field).on_hover_text(text);
        let found = (field.lost_focus() && *typed != text).then(|| typed.clone());
        // Shows the folder only while editing.
        if field.gained_focus() {
            text.clone_into(typed);
        } else if !field.has_focus() && found.is_none() {
            *typed = Path::new(text).file_name().unwrap_or_default().to_string_lossy().into_owned();
        }
        let list: Vec<String> = match axis {
            ENVIRONMENT => BUILTINS.iter().map(|builtin| format!("{BUILTIN_PREFIX}{}", builtin.name)).collect(),
            _ => SCENES.iter().map(|scene| scene.name.to_owned()).collect(),
        };
        self.place(name, &field);
        self.menu(ui, &format!("{name} list"), 24.0, "…", &list).or(found)
    }
}

/// Shows the slider's number if the axis is set.
fn numbered(slider: Slider<'_>, is_set: bool) -> Slider<'_> {
    if is_set { slider } else { slider.custom_formatter(|_, _| "default".to_owned()) }
}

/// Returns the first value of an axis that the user sets.
fn first(axis: usize, named: Named, point: &Point) -> Value {
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
        Kind::Number(Range { max, min_open: true, .. }) if max > 1.0 => (DECADES[0]..=DECADES[1].min(max), true),
        Kind::Number(Range { min, max, .. }) | Kind::NumberOrName { range: Range { min, max, .. }, .. } => {
            (min..=max, false)
        }
        _ => (crate::experiment::value::ALPHA_MIN..=1.0, false),
    }
}

/// Formats a number with four digits.
fn short(number: f64) -> String {
    format!("{number:.3e}").parse::<f64>().unwrap_or(number).to_string()
}
