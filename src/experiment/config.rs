//! The experiment file as written: every value checked alone, with its location.
//!
//! Reading never stops at the first fault. Paths are relative to the file.

use super::axis::named::LISTED_AXES;
use super::axis::{AXES, AxisId, METHOD, Named, PerAxis, Point, Reference, SAMPLES, Terms};
use super::fault::{Faults, Location};
use super::toml_tree::{checked, entries, parsed, raw, section, start_of, text, unknown_key};
use super::value::{COORDINATE, Kind, Range, Raw, Value};
use crate::base::names::Listed;
use crate::instrument::metrics::{HEADLINE, Metric, NoiseEffect, Weight};
use crate::instrument::recovery::Loss;
use crate::instrument::scene::{CameraKind, Light, Orbit};
use crate::instrument::shade::{METHODS, Method, NONE};
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

#[derive(Clone, Debug)]
pub struct Located {
    pub value: Value,
    pub location: Location,
}

#[derive(Clone, Debug)]
pub struct Sweep {
    pub axis: AxisId,
    pub named: Named,
    pub values: Vec<Located>,
    /// Number of values in the file; more than `values` if some are faulty.
    pub written: usize,
}

#[derive(Clone, Debug)]
pub struct Ask {
    pub question: String,
    pub location: Location,
    /// The axis of the answer's rows.
    pub by: Option<(AxisId, Location)>,
}

#[derive(Clone, Debug)]
pub struct Zip {
    pub axes: Vec<AxisId>,
    pub location: Location,
}

/// Combinations to leave out: every condition must match.
#[derive(Clone, Debug)]
pub struct Exclusion {
    pub conditions: Vec<Condition>,
    pub why: String,
    pub location: Location,
}

/// The values of an axis that match.
#[derive(Clone, Debug)]
pub struct Condition {
    pub axis: AxisId,
    pub values: Vec<Located>,
}

impl Condition {
    fn matches(&self, point: &Point) -> bool {
        let mut values = self.values.iter();
        values.any(|located| located.value == point[self.axis])
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timing {
    pub warmup: u32,
    pub rounds: u32,
}

/// An experiment file, checked value by value.
#[derive(Clone, Debug, Default)]
pub struct Config {
    pub path: PathBuf,
    pub text: String,
    pub name: String,
    pub question: String,
    /// Questions to answer, unchecked; the first one leads.
    pub asks: Vec<Ask>,
    /// Metric of the answers; one of [`crate::instrument::metrics::METRICS`].
    pub metric: &'static str,
    /// Weights of views, the leading one first, each with its location; unchecked. Empty for the
    /// default.
    pub weights: Vec<(Weight, Location)>,
    pub seed: u32,
    pub camera: CameraKind,
    pub orbit: Orbit,
    pub background: bool,
    pub antialias: bool,
    /// Of every cell, besides the lights of a scene's file.
    pub lights: Vec<Light>,
    pub lights_location: Location,
    /// Whether cells are compared with references; not with `reference = "none"`.
    pub is_scored: bool,
    /// Without scores it has its defaults.
    pub reference: Reference,
    pub reference_samples_location: Location,
    /// Where `reference.stated_noise_share` is set.
    pub noise_share_location: Location,
    /// Values of axes that are not swept.
    pub base: Point,
    /// Location of each value of `base`, in the order of [`AXES`].
    pub base_locations: PerAxis<Location>,
    /// In the order of the file, then of the command line.
    pub axes: Vec<Sweep>,
    /// Axes of the file that `--set` replaced.
    pub set_aside: Vec<Sweep>,
    pub zips: Vec<Zip>,
    pub exclusions: Vec<Exclusion>,
    pub timing: Option<Timing>,
    /// Samples per pixel for the steps of `[ladder]`.
    pub ladder: Option<u32>,
    /// Losses of the fits of `[recovery]`.
    pub recovery: Option<Vec<Loss>>,
    pub has_sheets: bool,
    pub overrides: Vec<String>,
    /// Folder of paths in the file, if not the file's own.
    pub file_dir: Option<PathBuf>,
    /// Folder of paths in `--set`; the current one if empty.
    pub set_dir: PathBuf,
}

pub(super) const AXIS: Kind = Kind::Name {
    what: "axis",
    names: axis_names,
    listed_in: Some(LISTED_AXES),
};

pub(super) const METRIC_KEY: &str = "metric";

/// The key of `reference` that `--set` sets, too.
pub const NOISE_SHARE_KEY: &str = "noise_share";
/// The text of `--set` for references with all their samples.
pub const EXACT_REFERENCES: &str = "noise_share=0";
pub(super) const NOISE_SHARE_KIND: Kind = Kind::Number(Range::closed(0.0, 1.0));

/// The value of `reference` for an experiment whose cells are not scored.
pub const UNSCORED: &str = "none";

type Reader = fn(&mut Config, &Spanned<DeValue>, &mut Faults);

/// Keys of the file except axes, each with its reader.
pub(super) const KEYS: &[(&str, Reader)] = &[
    ("name", Config::read_name),
    ("question", |config, value, faults| {
        config.question = text("question", value, faults)
    }),
    ("asks", Config::read_asks),
    (METRIC_KEY, |config, value, faults| {
        if let Some(found) = checked(Kind::one_of::<Metric>(), METRIC_KEY, value, faults) {
            config.metric = Metric::listed(found.text()).name;
        }
    }),
    ("weights", Config::read_weights),
    ("seed", |config, value, faults| {
        config.seed = checked(SEED, "seed", value, faults).map_or(config.seed, |v| v.count());
    }),
    ("camera", |config, value, faults| {
        let camera = checked(Kind::one_of::<CameraKind>(), "camera", value, faults);
        config.camera = camera.map_or(config.camera, |v| *CameraKind::listed(v.text()));
    }),
    ("orbit", |config, value, faults| {
        let orbit =
            checked(Kind::Color(COORDINATE), "orbit", value, faults).map(|v| Orbit::new(v.color()));
        match orbit {
            Some(Ok(orbit)) => config.orbit = orbit,
            Some(Err(fault)) => faults.add(
                &start_of(value),
                format!("orbit: {fault}; expected [yaw, pitch, distance]"),
            ),
            None => {}
        }
    }),
    ("background", |config, value, faults| {
        read_switch(&mut config.background, "background", value, faults)
    }),
    ("antialias", |config, value, faults| {
        read_switch(&mut config.antialias, "antialias", value, faults)
    }),
    ("lights", Config::read_lights),
    ("reference", Config::read_reference),
    ("axes", Config::read_axes),
    ("zip", Config::read_zips),
    ("exclude", Config::read_exclusions),
    ("timing", Config::read_timing),
    ("ladder", Config::read_ladder),
    ("recovery", Config::read_recovery),
    ("precompute", Config::read_precompute),
    ("sheets", |config, value, faults| {
        read_switch(&mut config.has_sheets, "sheets", value, faults)
    }),
];

fn read_switch(switch: &mut bool, name: &str, value: &Spanned<DeValue>, faults: &mut Faults) {
    match raw(value) {
        Raw::Boolean(is_set) => *switch = is_set,
        other => faults.add(
            &start_of(value),
            format!("{name}: {other} is not true or false"),
        ),
    }
}

pub const SEED: Kind = Kind::Count {
    min: 0,
    max: u32::MAX,
};

impl Config {
    /// Reads `text` as the experiment at `path` with `--set axis=v1,v2` texts. The result is
    /// complete only if `faults` is empty.
    pub fn parse(path: &Path, text: &str, overrides: &[String], faults: &mut Faults) -> Self {
        let root = parsed(text, faults);
        let is_whole = faults.is_empty();
        let mut config = Self {
            path: path.to_owned(),
            text: text.to_owned(),
            metric: HEADLINE,
            seed: 1,
            is_scored: true,
            has_sheets: true,
            base_locations: PerAxis::from_fn(|_| Location::Default),
            overrides: overrides.to_vec(),
            ..Self::default()
        };
        let root = root.get_ref();
        for (key, value, location) in entries(root) {
            config.read_key(key, value, &location, faults);
        }
        for key in ["name", "axes"] {
            // After a syntax fault the recovered table may lack keys of the file.
            if !root.contains_key(key) && is_whole {
                faults.add(&Location::File(0), format!("{key} is missing"));
            }
        }
        config.check_double_settings(root, faults);
        config.apply_overrides(faults);
        config.check_reference_stops(faults);
        config.check_zips(faults);
        config.check_twice(faults);
        config
    }

    fn check_double_settings(&self, root: &DeTable, faults: &mut Faults) {
        let precompute = root
            .get("precompute")
            .and_then(|value| value.get_ref().as_table());
        let fixed = precompute
            .into_iter()
            .flat_map(entries)
            .map(|(key, _, location)| ("precompute.", key, location));
        let keys = entries(root)
            .into_iter()
            .filter(|(key, ..)| AxisId::find(key).is_some_and(|axis| AXES[axis].is_key));
        for (prefix, key, location) in
            fixed.chain(keys.map(|(key, _, location)| ("", key, location)))
        {
            if self.axes.iter().any(|sweep| AXES[sweep.axis].name == key) {
                faults.add(
                    &location,
                    format!("{prefix}{key} is also an axis: set it in one place"),
                );
            }
        }
    }

    pub(super) fn set_noise_share(&mut self, share: f64, location: Location) {
        self.reference.stated_noise_share = Some(share);
        self.noise_share_location = location;
    }

    /// Checks that a reference stops by one rule. It is exact by default if noise would distort the
    /// metric of the answers.
    fn check_reference_stops(&mut self, faults: &mut Faults) {
        let reference = &mut self.reference;
        if Metric::listed(self.metric).noise == NoiseEffect::Distorts {
            reference.stated_noise_share.get_or_insert(0.0);
        }
        if reference.relative_error.is_some() && reference.noise_share().is_some() {
            faults.add(
                &self.noise_share_location,
                "reference.noise_share: relative_error stops the reference already; give one of \
                 them, or noise_share = 0",
            );
        }
    }

    /// The weights of views to answer by, the leading one first.
    pub fn weights(&self) -> Vec<Weight> {
        match &self.weights[..] {
            [] => vec![Weight::Picture, Weight::Uniform],
            weights => weights.iter().map(|(weight, _)| weight.clone()).collect(),
        }
    }

    pub(super) fn set_base(&mut self, axis: AxisId, value: Value, location: Location) {
        self.base[axis] = value;
        self.base_locations[axis] = location;
    }

    pub fn sweep(&self, axis: AxisId) -> Option<&Sweep> {
        self.axes.iter().find(|sweep| sweep.axis == axis)
    }

    /// Returns an axis by the name in the experiment, if that name can write every value.
    pub fn named(&self, axis: AxisId) -> Named {
        self.sweep(axis)
            .map_or(Named::primary(axis), |sweep| sweep.named)
    }

    /// Lists every value of an axis, swept or not, with its location.
    pub fn values(&self, axis: AxisId) -> impl Iterator<Item = (&Value, &Location)> {
        let sweep = self.sweep(axis);
        let fixed = sweep
            .is_none()
            .then(|| (&self.base[axis], &self.base_locations[axis]));
        let swept = sweep
            .into_iter()
            .flat_map(|sweep| &sweep.values)
            .map(|located| (&located.value, &located.location));
        swept.chain(fixed)
    }

    /// Finds the location of a point's value on an axis.
    pub fn location_of(&self, axis: AxisId, point: &Point) -> Location {
        let found = self.values(axis).find(|(value, _)| **value == point[axis]);
        found.map_or_else(
            || self.base_locations[axis].clone(),
            |(_, location)| location.clone(),
        )
    }

    /// Finds the first exclusion that matches a point.
    pub fn exclusion_of(&self, point: &Point) -> Option<usize> {
        self.exclusions.iter().position(|exclusion| {
            let mut conditions = exclusion.conditions.iter();
            conditions.all(|condition| condition.matches(point))
        })
    }

    fn read_key(
        &mut self,
        key: &str,
        value: &Spanned<DeValue>,
        location: &Location,
        faults: &mut Faults,
    ) {
        if let Some((_, read)) = KEYS.iter().find(|(name, _)| *name == key) {
            return read(self, value, faults);
        }
        match AxisId::find(key).filter(|&axis| AXES[axis].is_key) {
            Some(axis) => {
                if let Some(checked) = checked(AXES[axis].kind, key, value, faults) {
                    self.set_base(axis, checked, start_of(value));
                }
            }
            None => {
                let axes = AXES.iter().filter(|axis| axis.is_key).map(|axis| axis.name);
                unknown_key(
                    location,
                    "",
                    key,
                    &KEYS
                        .iter()
                        .map(|(name, _)| *name)
                        .chain(axes)
                        .collect::<Vec<_>>(),
                    faults,
                );
            }
        }
    }

    fn read_name(&mut self, value: &Spanned<DeValue>, faults: &mut Faults) {
        match raw(value) {
            Raw::String(name) if is_file_name(&name) => self.name = name,
            other => faults.add(
                &start_of(value),
                format!(
                    "name: {other} is not a name of 1 to {NAME_LENGTH_MAX} letters, digits, '-', \
                     '_' and '.' that begins \
                     with a letter, digit or '_'"
                ),
            ),
        }
    }

    fn read_reference(&mut self, value: &Spanned<DeValue>, faults: &mut Faults) {
        if let Raw::String(text) = raw(value) {
            if text == UNSCORED {
                self.is_scored = false;
            } else {
                let fault = format!(
                    "reference: {text:?} is not {UNSCORED:?}, which renders cells without scores; \
                     or write a table such as {{ samples = 4096 }}"
                );
                faults.add(&start_of(value), fault);
            }
            return;
        }
        for (key, value, _) in section(
            value,
            "reference",
            &[
                "method",
                "samples",
                "relative_error",
                NOISE_SHARE_KEY,
                "terms",
            ],
            faults,
        ) {
            let kind = match key {
                "method" => AXES[METHOD].kind,
                "samples" => AXES[SAMPLES].kind,
                "relative_error" => Kind::Number(Range::above(0.0, 1.0)),
                NOISE_SHARE_KEY => NOISE_SHARE_KIND,
                _ => Kind::one_of::<Terms>(),
            };
            let Some(found) = checked(kind, &format!("reference.{key}"), value, faults) else {
                continue;
            };
            match key {
                "method" => {
                    self.reference.method = found.text().to_owned();
                    if let Some(fault) = reference_method_fault(found.text()) {
                        faults.add(&start_of(value), fault);
                    }
                }
                "samples" => {
                    self.reference.samples = found.count();
                    self.reference_samples_location = start_of(value);
                }
                "relative_error" => self.reference.relative_error = Some(found.number()),
                NOISE_SHARE_KEY => self.set_noise_share(found.number(), start_of(value)),
                _ => self.reference.terms = *Terms::listed(found.text()),
            }
        }
    }
}

/// Why a method cannot be the reference, if it is an approximation.
fn reference_method_fault(name: &str) -> Option<String> {
    let is_exact =
        Method::by_name(name).is_some_and(|method| method.is_integrated() || method.is_none());
    if is_exact {
        return None;
    }
    let exact = METHODS
        .iter()
        .filter(|method| method.is_integrated())
        .map(|method| method.name);
    Some(format!(
        "reference.method: {name} is an approximation and cannot be the reference; expected one of \
         {}, or {NONE} to compare with the image without a specular term",
        exact.collect::<Vec<_>>().join(", ")
    ))
}

pub(super) fn axis_names() -> Vec<&'static str> {
    Named::all().map(Named::name).collect()
}

const NAME_LENGTH_MAX: usize = 100;

/// A leading dot would hide the run's folder; a leading dash would look like an option.
fn is_file_name(name: &str) -> bool {
    (1..=NAME_LENGTH_MAX).contains(&name.len())
        && !name.starts_with(['.', '-'])
        && name
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.'))
}
