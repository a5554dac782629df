//! Controls of single values: sliders, colours, pairs, menus.

use super::controls::{Choice, Controls, MENU_WIDTH, short};
use crate::experiment::axis::Named;
use crate::experiment::value::{ALPHA_MIN, Kind, Range, Value};
use egui::{DragValue, Slider, SliderClamping, Ui};
use std::ops::RangeInclusive;

/// Range of sliders over many decades; other numbers can be typed.
const DECADES: [f64; 2] = [1e-3, 1e3];
const SAMPLES_MAX: u32 = 4096;
const SLIDER_WIDTH: f32 = 84.0;
/// Ranges of sliders, most as in the source documents; other numbers can be typed.
const USUAL_RANGES: [(&str, [f64; 2]); 4] = [
    ("perceptual_roughness", [0.1, 0.8]),
    ("environment_scale", [0.5, 5.0]),
    ("contrast", [0.1, 5.0]),
    ("light_intensity", [0.0, 10.0]),
];

impl Controls {
    /// Shows the control of a value, and changes the value to what the user chose.
    pub fn value(&mut self, ui: &mut Ui, named: Named, is_set: bool, value: &mut Value) {
        ui.spacing_mut().slider_width = SLIDER_WIDTH;
        let kind = named.kind();
        let shown = named.shown(value);
        let typed = match (kind, &shown) {
            (kind, Value::Number(_) | Value::Count(_)) => {
                let number = shown.size().unwrap_or_default();
                self.number(ui, named.name(), kind, is_set, number)
            }
            (Kind::Color(_), Value::Color(color)) => self.color(ui, named.name(), is_set, *color),
            (Kind::Pair { min, max }, Value::Pair(pair)) => {
                self.pair(ui, named.name(), min..=max, *pair)
            }
            (
                Kind::Name { names, .. }
                | Kind::NameOrFile { names, .. }
                | Kind::NameOrList { names, .. },
                Value::Text(text),
            ) => {
                let choices: Vec<Choice> = names().into_iter().map(Choice::code).collect();
                self.menu(ui, named.name(), MENU_WIDTH, text, &choices)
            }
            _ => None,
        };
        // Ignores numbers out of range.
        if let Some(Ok(parsed)) = typed.map(|text| named.parse_text(&text)) {
            *value = parsed;
        }
    }

    /// Shows a slider, and returns the number if it was moved.
    fn number(
        &mut self,
        ui: &mut Ui,
        name: &str,
        kind: Kind,
        is_set: bool,
        mut number: f64,
    ) -> Option<String> {
        let is_count = matches!(kind, Kind::Count { .. });
        let SliderRange { range, is_log } = usual_range(name).unwrap_or_else(|| slider_range(kind));
        let slider = Slider::new(&mut number, range)
            .logarithmic(is_log)
            .clamping(SliderClamping::Never);
        let slider = if is_count {
            slider.integer()
        } else {
            slider.max_decimals(3)
        };
        let response = ui.add(numbered(slider, is_set));
        self.record(name, &response);
        response.changed().then(|| {
            if is_count {
                number.to_string()
            } else {
                short(number)
            }
        })
    }

    /// Shows a slider for greys and a button for colours, and returns the changed colour.
    fn color(
        &mut self,
        ui: &mut Ui,
        name: &str,
        is_set: bool,
        mut color: [f32; 3],
    ) -> Option<String> {
        ui.spacing_mut().slider_width = SLIDER_WIDTH - 40.0;
        ui.spacing_mut().interact_size.x = 28.0;
        let [r, g, b] = color;
        let mut grey = (r + g + b) / 3.0;
        let slider = Slider::new(&mut grey, 0.0..=1.0).max_decimals(3);
        let response = ui.add(numbered(slider, is_set));
        self.record(name, &response);
        if ui.color_edit_button_rgb(&mut color).changed() {
            return Some(color.map(|x| short(x.clamp(0.0, 1.0).into())).join(":"));
        }
        response.changed().then(|| short(grey.into()))
    }

    /// Shows a slider of one channel of a colour, and returns the number if it was moved.
    pub fn channel(&mut self, ui: &mut Ui, name: &str, is_set: bool, channel: f32) -> Option<f32> {
        ui.spacing_mut().slider_width = SLIDER_WIDTH;
        let mut changed = channel;
        let slider = Slider::new(&mut changed, 0.0..=1.0).max_decimals(3);
        let response = ui.add(numbered(slider, is_set));
        self.record(name, &response);
        response.changed().then_some(changed)
    }

    /// Shows two numbers, and returns them if one changed.
    fn pair(
        &mut self,
        ui: &mut Ui,
        name: &str,
        range: RangeInclusive<u32>,
        pair: [u32; 2],
    ) -> Option<String> {
        let mut sides = pair;
        for (side, label) in sides.iter_mut().zip(["", "× "]) {
            let response = ui.add(DragValue::new(side).range(range.clone()).prefix(label));
            self.record(format!("{name}{label}"), &response);
        }
        (sides != pair).then(|| format!("{}x{}", sides[0], sides[1]))
    }
}

/// Shows the slider's number, or `model` for an unset axis.
fn numbered(slider: Slider<'_>, is_set: bool) -> Slider<'_> {
    if is_set {
        slider
    } else {
        slider.custom_formatter(|_, _| "model".to_owned())
    }
}

struct SliderRange {
    range: RangeInclusive<f64>,
    is_log: bool,
}

fn usual_range(name: &str) -> Option<SliderRange> {
    let (_, [min, max]) = USUAL_RANGES.iter().find(|(known, _)| *known == name)?;
    Some(SliderRange {
        range: *min..=*max,
        is_log: false,
    })
}

fn slider_range(kind: Kind) -> SliderRange {
    match kind {
        Kind::Number(Range {
            max,
            min_open: true,
            ..
        }) if max > 1.0 => SliderRange {
            range: DECADES[0]..=DECADES[1].min(max),
            is_log: true,
        },
        Kind::Number(Range { min, max, .. })
        | Kind::NumberOrName {
            range: Range { min, max, .. },
            ..
        } => SliderRange {
            range: min..=max,
            is_log: false,
        },
        Kind::Count { min, max } => SliderRange {
            range: f64::from(min)..=f64::from(max.min(SAMPLES_MAX.max(min))),
            is_log: true,
        },
        _ => SliderRange {
            range: ALPHA_MIN..=1.0,
            is_log: false,
        },
    }
}
