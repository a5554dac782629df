//! A state as commands and as an experiment.

use super::state::{Image, Side, State};
use crate::experiment::axis::{AXES, ENVIRONMENT, METHOD, Named, Point, SAMPLES, SCENE, SIZE, View};
use crate::experiment::lights::light_text;
use crate::experiment::value::Value;
use crate::scene::LightKind;
use crate::spelling::Listed;
use std::fmt::Write;

/// Axes whose defaults differ between `render` and `view`.
const ALWAYS: [usize; 4] = [ENVIRONMENT, SCENE, METHOD, SAMPLES];

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
        words.push(format!("--reference-samples={}", self.view.reference_samples));
        words.extend((!self.view.background).then(|| "--no-background".to_owned()));
        format!("splitsum view {}", words.join(" "))
    }

    /// Writes an experiment whose cells are the halves.
    pub fn experiment(&self, name: &str) -> String {
        let mut text = format!("# A state of the window of splitsum, as an experiment.\nname = {name:?}\n");
        let View { camera, orbit, background, lights, seed, reference_samples, .. } = &self.view;
        let _ = writeln!(text, "seed = {seed}\ncamera = {:?}\nbackground = {background}", camera.name());
        if !orbit.is_still() {
            let _ = writeln!(text, "orbit = {:?}", orbit.numbers());
        }
        let _ = writeln!(text, "reference = {{ samples = {reference_samples} }}");
        for light in lights {
            let key = if light.kind == LightKind::Point { "position" } else { "direction" };
            let (place, kind) = (light.position_or_direction.as_vec3().to_array(), light.kind.name());
            let _ = writeln!(text, "\n[[lights]]\nkind = {kind:?}\n{key} = {place:?}\ncolor = {:?}", light.color);
        }
        let _ = writeln!(text, "\n[axes]");
        let sides = [Side::Left, Side::Right].map(|side| self.image(side, *reference_samples).point);
        let judged: Vec<&Point> = sides.iter().filter(|point| !point.method().is_integrated()).collect();
        let judged = if judged.is_empty() { vec![&sides[0]] } else { judged };
        for (index, axis) in AXES.iter().enumerate() {
            let value =
                |point: &&Point| if axis.changes_radiance() { point[index].clone() } else { self.point[index].clone() };
            let mut values: Vec<Value> = judged.iter().map(value).filter(|value| *value != Value::Unset).collect();
            values.dedup();
            if !values.is_empty() {
                let texts: Vec<String> = values.iter().map(toml_text).collect();
                let _ = writeln!(text, "{} = [{}]", axis.name, texts.join(", "));
            }
        }
        text
    }
}

/// Writes the flags of values that are not defaults of `render`, and of inputs, method and samples.
fn axis_flags(point: &Point) -> Vec<String> {
    let defaults = Point::default();
    let is_shown = |axis: usize| point[axis] != defaults[axis] || ALWAYS.contains(&axis);
    let names = Named::all().filter(|named| !named.is_second() && point[named.axis] != Value::Unset);
    names
        .filter(|named| is_shown(named.axis))
        .map(|named| format!("--{}={}", named.flag(), quoted(&point[named.axis].to_string())))
        .collect()
}

fn view_flags(view: &View) -> Vec<String> {
    let mut words = vec![format!("--camera={}", view.camera.name()), format!("--seed={}", view.seed)];
    if !view.orbit.is_still() {
        words.push(format!("--orbit={}", view.orbit.numbers().map(|x| x.to_string()).join(",")));
    }
    words.extend(view.lights.iter().map(|light| format!("--light={}", light_text(light))));
    words
}

fn toml_text(value: &Value) -> String {
    match value {
        Value::Text(text) => toml::Value::from(text.as_str()).to_string(),
        Value::Color([r, g, b]) => format!("[{r}, {g}, {b}]"),
        Value::Pair([w, h]) => format!("[{w}, {h}]"),
        other => other.to_string(),
    }
}

/// Quotes a word for a shell.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./:,=+#@%".contains(c);
    if word.chars().all(is_plain) { word.to_owned() } else { format!("'{}'", word.replace('\'', "'\\''")) }
}
