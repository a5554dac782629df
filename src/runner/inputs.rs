//! Environments and scenes of an experiment, each loaded once.

use super::fault::{Faults, Place};
use crate::environment::{Environment, LoadOptions};
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

    /// What is odd about the inputs, one sentence each with the input's name.
    pub fn warnings(&self) -> Vec<String> {
        let environments =
            self.environments.values().flat_map(|e| e.warnings.iter().map(|w| format!("{}: {w}", e.name)));
        let scenes = self.scenes.values().flat_map(|s| s.warnings.iter().map(|w| format!("{}: {w}", s.name)));
        environments.chain(scenes).collect()
    }
}
