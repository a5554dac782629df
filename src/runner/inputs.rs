//! Environments and scenes of an experiment, each loaded once.

use super::fault::{Faults, Place};
use crate::environment::{BUILTIN_PREFIX, Environment, LoadOptions};
use crate::scene::Scene;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// Everything that the cells of an experiment read, by the name that the experiment uses.
#[derive(Clone, Debug, Default)]
pub struct Inputs {
    environments: BTreeMap<String, Arc<Environment>>,
    scenes: BTreeMap<String, Arc<Scene>>,
    clipped: Arc<Mutex<Vec<Clipped>>>,
    options: LoadOptions,
}

/// An environment cut off at 2 to a power: name, power, result.
type Clipped = (String, f64, Arc<Environment>);

/// Cut-off environments kept at a time: a sweep takes them one after the other.
const CLIPPED_COUNT: usize = 4;

/// A short name for each of these files, none like another: the stem of its file name; where that names two, the file name, then with folders.
/// Formulas keep their own names.
pub fn short_names<'n>(names: impl IntoIterator<Item = &'n str>) -> BTreeMap<String, String> {
    let mut forms: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for name in names {
        forms
            .entry(name)
            .or_insert_with(|| if name.starts_with(BUILTIN_PREFIX) { Vec::new() } else { shortenings(name) });
    }
    let shortest = |name: &str, own: &[String]| {
        let others = || forms.iter().filter(|(other, _)| **other != name);
        let is_own = |form: &&String| others().all(|(other, forms)| *other != form.as_str() && !forms.contains(form));
        own.iter().find(is_own).map_or(name.to_owned(), String::clone)
    };
    forms.iter().map(|(name, own)| (name.to_string(), shortest(name, own))).collect()
}

/// A path without folders and extension, without folders, with one folder, with two and so on; a layer stays behind each.
fn shortenings(name: &str) -> Vec<String> {
    let (file, layer) =
        name.rsplit_once('#').map_or((name, String::new()), |(file, layer)| (file, format!("#{layer}")));
    let parts: Vec<&str> = file.split(['/', '\\']).filter(|part| !part.is_empty()).collect();
    let stem = Path::new(file).file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let with_folders = (0..parts.len()).rev().map(|first| parts[first..].join("/"));
    stem.into_iter().chain(with_folders).map(|form| form + &layer).collect()
}

impl Inputs {
    /// Nothing yet; environments will be loaded so.
    pub fn new(options: LoadOptions) -> Self {
        Self { options, ..Self::default() }
    }

    /// Loads an environment unless it is there; a failure becomes a fault at `place`.
    pub fn add_environment(&mut self, name: &str, dir: &Path, place: &Place, faults: &mut Faults) {
        if self.environments.contains_key(name) {
            return;
        }
        match Environment::load(name, dir, &self.options) {
            Ok(environment) => {
                self.environments.insert(name.to_owned(), Arc::new(environment));
            }
            Err(fault) => faults.add(place, fault.to_string()),
        }
    }

    /// Loads a scene unless it is there; a failure becomes a fault at `place`.
    pub fn add_scene(&mut self, name: &str, dir: &Path, place: &Place, faults: &mut Faults) {
        if self.scenes.contains_key(name) {
            return;
        }
        match Scene::load(name, dir) {
            Ok(scene) => {
                self.scenes.insert(name.to_owned(), Arc::new(scene));
            }
            Err(fault) => faults.add(place, fault.to_string()),
        }
    }

    /// Whether an environment of that name is loaded.
    pub fn has_environment(&self, name: &str) -> bool {
        self.environments.contains_key(name)
    }

    /// A loaded environment.
    pub fn environment(&self, name: &str) -> &Arc<Environment> {
        self.environments.get(name).unwrap_or_else(|| panic!("the plan loaded no environment {name}"))
    }

    /// A loaded environment without radiance above 2 to the power `clip_log2`.
    pub fn clipped(&self, name: &str, clip_log2: Option<f64>) -> Arc<Environment> {
        let whole = self.environment(name);
        let Some(power) = clip_log2 else { return whole.clone() };
        // A thread that panicked left a whole list: entries are added in one step.
        let mut kept = self.clipped.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((.., environment)) = kept.iter().find(|(known, at, _)| known == name && *at == power) {
            return environment.clone();
        }
        let environment = Arc::new(whole.clipped(power.exp2() as f32));
        if kept.len() == CLIPPED_COUNT {
            kept.remove(0);
        }
        kept.push((name.to_owned(), power, environment.clone()));
        environment
    }

    /// A loaded scene.
    pub fn scene(&self, name: &str) -> &Arc<Scene> {
        self.scenes.get(name).unwrap_or_else(|| panic!("the plan loaded no scene {name}"))
    }

    /// Every loaded scene.
    pub fn scenes(&self) -> impl Iterator<Item = &Scene> {
        self.scenes.values().map(Arc::as_ref)
    }

    /// Name and content hash of every input, environments first.
    pub fn hashes(&self) -> Vec<(String, String)> {
        let environments = self.environments.values().map(|e| (e.name.clone(), e.hash.clone()));
        environments.chain(self.scenes.values().map(|s| (s.name.clone(), s.hash.clone()))).collect()
    }

    /// Warnings about the inputs, one sentence each with the input's name.
    pub fn warnings(&self) -> Vec<String> {
        let environments =
            self.environments.values().flat_map(|e| e.warnings.iter().map(|w| format!("{}: {w}", e.name)));
        let scenes = self.scenes.values().flat_map(|s| s.warnings.iter().map(|w| format!("{}: {w}", s.name)));
        environments.chain(scenes).collect()
    }
}
