//! A state as a file, as `render` commands and as an experiment.

use super::picture::{Picture, Tone};
use super::state::{Image, Side, State};
use crate::experiment::axis::{AXES, METHOD, Named, Point, SAMPLES, View};
use crate::experiment::lights::{light_text, parse_light};
use crate::experiment::value::Value;
use crate::scene::{CameraKind, LightKind, Orbit};
use crate::spelling::Listed;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Write;

#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Written {
    /// By the names of axes; missing ones have their defaults.
    axes: BTreeMap<String, String>,
    right: String,
    camera: String,
    orbit: [f32; 3],
    background: bool,
    lights: Vec<String>,
    seed: u32,
    reference_samples: u32,
    picture: String,
    tone: String,
    wipe: f32,
    #[serde(default)]
    fill: bool,
    level: u32,
}

impl State {
    /// Writes the state for [`State::parse`].
    pub fn text(&self) -> String {
        let axes = AXES.iter().zip(&self.point.0).filter(|(_, value)| **value != Value::Unset);
        let written = Written {
            axes: axes.map(|(axis, value)| (axis.name.to_owned(), value.to_string())).collect(),
            right: self.right.to_string(),
            camera: self.view.camera.name().to_owned(),
            orbit: self.view.orbit.numbers(),
            background: self.view.background,
            lights: self.view.lights.iter().map(light_text).collect(),
            seed: self.view.seed,
            reference_samples: self.view.reference_samples,
            picture: self.picture.name().to_owned(),
            tone: self.tone.name().to_owned(),
            wipe: self.wipe,
            fill: self.fill,
            level: self.level,
        };
        serde_json::to_string_pretty(&written).expect("plain data") + "\n"
    }

    /// Reads the text of a state file.
    pub fn parse(text: &str) -> Result<Self, String> {
        let written: Written = serde_json::from_str(text).map_err(|error| error.to_string())?;
        let mut point = Point::default();
        for (name, value) in &written.axes {
            let named = Named::find(name).ok_or_else(|| format!("axes: {name:?} is not an axis"))?;
            point[named.axis] = named.parse_text(value).map_err(|fault| format!("axes.{name}: {fault}"))?;
        }
        let lights: Result<Vec<_>, String> = written.lights.iter().map(|text| parse_light(text)).collect();
        let camera = *CameraKind::parse(&written.camera).map_err(|fault| format!("camera: {fault}"))?;
        let view = View {
            camera,
            orbit: Orbit::new(written.orbit).map_err(|fault| format!("orbit: {fault}"))?,
            background: written.background,
            antialias: false,
            lights: lights.map_err(|fault| format!("lights: {fault}"))?,
            seed: written.seed,
            reference_error: None,
            reference_samples: written.reference_samples,
        };
        let tone = *Tone::parse(&written.tone).map_err(|fault| format!("tone: {fault}"))?;
        let picture = *Picture::parse(&written.picture).map_err(|fault| format!("picture: {fault}"))?;
        let right = AXES[METHOD].kind.parse_text(&written.right).map_err(|fault| format!("right: {fault}"))?;
        if !(0.0..=1.0).contains(&written.wipe) {
            return Err(format!("wipe: {} is outside [0, 1]", written.wipe));
        }
        let Written { wipe, fill, level, .. } = written;
        Self { right, picture, tone, wipe, fill, level, ..Self::new(point, view) }.checked()
    }

    /// Checks the reference's sample count.
    pub fn checked(self) -> Result<Self, String> {
        let count = self.view.reference_samples;
        crate::shade::reference_pass::pair_count(count).map_err(|fault| format!("reference_samples: {fault}"))?;
        Ok(self)
    }

    /// Writes the `render` command of an image into the file `out`.
    pub fn command_line(&self, image: &Image, out: &str) -> String {
        let mut words = vec!["splitsum".to_owned(), "render".to_owned()];
        let mut add = |flag: &str, value: String| words.push(format!("--{flag}={}", quoted(&value)));
        let defaults = Point::default();
        let is_picture = out.ends_with(".png");
        for named in Named::all().filter(|named| !named.is_second()) {
            let axis = named.axis;
            let (value, is_display) = (&image.point[axis], !AXES[axis].changes_radiance());
            let value = if is_display { &self.point[axis] } else { value };
            let is_shown = *value != defaults[axis] || [METHOD, SAMPLES].contains(&axis);
            if *value != Value::Unset && is_shown && (is_picture || !is_display) {
                add(&named.flag(), value.to_string());
            }
        }
        let View { camera, orbit, lights, seed, reference_samples, background, .. } = &image.view;
        if image.point[SAMPLES] == Value::Unset && image.point.diffuse().is_integrated() {
            add(&AXES[SAMPLES].name.replace('_', "-"), reference_samples.to_string());
        }
        add("camera", camera.name().to_owned());
        if !orbit.is_still() {
            add("orbit", orbit.numbers().map(|x| x.to_string()).join(","));
        }
        lights.iter().for_each(|light| add("light", light_text(light)));
        add("seed", seed.to_string());
        add("out", out.to_owned());
        if *background {
            words.push("--background".to_owned());
        }
        words.join(" ")
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
