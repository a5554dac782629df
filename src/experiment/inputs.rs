//! Environments and scenes of an experiment, each loaded once.

use super::fault::{Faults, Place};
use crate::environment::{Environment, LoadOptions};
use crate::scene::Scene;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// Everything that the cells of an experiment read, by the name that the experiment uses.
#[derive(Clone, Debug, Default)]
pub struct Inputs {
    environments: BTreeMap<String, Arc<Environment>>,
    scenes: BTreeMap<String, Arc<Scene>>,
}

impl Inputs {
    /// Loads an environment unless it is there; a failure becomes a fault at `place`.
    pub fn add_environment(&mut self, name: &str, dir: &Path, place: &Place, faults: &mut Faults) {
        if self.environments.contains_key(name) {
            return;
        }
        match Environment::load(name, dir, &LoadOptions::default()) {
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

    /// A loaded environment.
    pub fn environment(&self, name: &str) -> &Arc<Environment> {
        self.environments.get(name).unwrap_or_else(|| panic!("the plan loaded no environment {name}"))
    }

    /// A loaded scene.
    pub fn scene(&self, name: &str) -> &Arc<Scene> {
        self.scenes.get(name).unwrap_or_else(|| panic!("the plan loaded no scene {name}"))
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
