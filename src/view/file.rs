//! A state as commands.

use super::state::{Image, State};
use crate::base::names::Listed;
use crate::experiment::axis::{
    AxisId, ENVIRONMENT, METHOD, Named, Point, SAMPLES, SCENE, SIZE, View,
};
use crate::experiment::lights::light_text;
use crate::experiment::value::Value;

/// Axes whose defaults differ between `render` and `view`.
const ALWAYS: [AxisId; 4] = [ENVIRONMENT, SCENE, METHOD, SAMPLES];

impl State {
    /// Writes the `render` command of an image into the file `out`.
    pub fn render_command(&self, image: &Image, out: &str) -> String {
        let mut words = axis_flags(&image.point);
        words.extend(view_flags(&image.view));
        if image.point[SAMPLES] == Value::Unset && image.point.diffuse().is_integrated() {
            words.push(format!("--samples={}", image.view.reference_samples));
        }
        words.push(format!("--out={out}"));
        words.extend(image.view.background.then(|| "--background".to_owned()));
        format!("splitsum render {}", words.join(" "))
    }

    /// Writes the `view` command that opens the state again.
    pub fn view_command(&self) -> String {
        let mut point = self.point.clone();
        if self.fill {
            point[SIZE] = Point::default()[SIZE].clone();
        }
        let mut words = axis_flags(&point);
        words.push(format!("--right={}", quoted(&self.right.to_string())));
        words.extend(view_flags(&self.view));
        words.push(format!(
            "--reference-samples={}",
            self.view.reference_samples
        ));
        words.extend((!self.view.background).then(|| "--no-background".to_owned()));
        format!("splitsum view {}", words.join(" "))
    }
}

/// Writes the flags of values that are not defaults of `render`, and of inputs, method and samples.
fn axis_flags(point: &Point) -> Vec<String> {
    let defaults = Point::default();
    let is_shown = |axis: AxisId| point[axis] != defaults[axis] || ALWAYS.contains(&axis);
    let names =
        Named::all().filter(|named| !named.is_second() && point[named.axis] != Value::Unset);
    names
        .filter(|named| is_shown(named.axis))
        .map(|named| {
            format!(
                "--{}={}",
                named.flag(),
                quoted(&point[named.axis].to_string())
            )
        })
        .collect()
}

fn view_flags(view: &View) -> Vec<String> {
    let mut words = vec![
        format!("--camera={}", view.camera.name()),
        format!("--seed={}", view.seed),
    ];
    if !view.orbit.is_still() {
        words.push(format!(
            "--orbit={}",
            view.orbit.numbers().map(|x| x.to_string()).join(",")
        ));
    }
    let lights = view.lights.iter();
    words.extend(lights.map(|light| format!("--light={}", light_text(light))));
    words
}

pub fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./:,=+#@%".contains(c);
    if word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}
