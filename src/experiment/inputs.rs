//! Environments, scenes, methods and tables of an experiment, each loaded once.

use super::axis::{AxisId, DFG_TABLE, ENVIRONMENT, METHOD, PREFILTERED, SCENE, Settings};
use super::config::Config;
use super::fault::Faults;
use crate::bake::given;
use crate::instrument::environment::{BUILTIN_PREFIX, Environment, LoadOptions};
use crate::instrument::precompute::given::{Given, GivenMap, GivenTable};
use crate::instrument::scene::Scene;
use crate::instrument::shade::{FILE_PREFIX, Method, from_file};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::Path;
use std::sync::Arc;

/// Everything that the cells read, by its name in the experiment.
#[derive(Clone, Debug, Default)]
pub struct Inputs {
    environments: BTreeMap<String, Arc<Environment>>,
    scenes: BTreeMap<String, Arc<Scene>>,
    methods: BTreeMap<String, &'static Method>,
    /// `None` for the program's own.
    maps: BTreeMap<String, Option<Arc<GivenMap>>>,
    tables: BTreeMap<String, Option<Arc<GivenTable>>>,
}

/// Gives each file a short name: its stem, or its path if another input has this stem. Formulas
/// keep their names.
pub fn short_names<'n>(names: impl IntoIterator<Item = &'n str>) -> BTreeMap<String, String> {
    let stems: BTreeMap<&str, String> = names.into_iter().map(|name| (name, stem(name))).collect();
    let is_unique = |stem: &String| {
        let alike = stems
            .iter()
            .filter(|(name, other)| *other == stem || *name == stem);
        alike.count() == 1
    };
    let mut short_names = BTreeMap::new();
    for (name, stem) in &stems {
        let short = if is_unique(stem) {
            stem.clone()
        } else {
            name.to_string()
        };
        short_names.insert(name.to_string(), short);
    }
    short_names
}

/// The stem of a file with its layer; other names as they are.
fn stem(name: &str) -> String {
    let (file, layer) = name.split_at(name.rfind('#').unwrap_or(name.len()));
    let stem = Path::new(file)
        .file_stem()
        .filter(|_| !name.starts_with(BUILTIN_PREFIX));
    stem.map_or_else(
        || name.to_owned(),
        |stem| stem.to_string_lossy().into_owned() + layer,
    )
}

fn each<T, E: Display>(
    config: &Config,
    axis: AxisId,
    faults: &mut Faults,
    load: impl Fn(&str, &Path) -> Result<T, E>,
) -> BTreeMap<String, T> {
    let mut loaded = BTreeMap::new();
    for (value, location) in config.values(axis) {
        match load(value.text(), config.dir_of(location)) {
            Ok(input) => drop(loaded.insert(value.text().to_owned(), input)),
            Err(fault) => faults.add(location, fault.to_string()),
        }
    }
    loaded
}

pub fn load_methods(config: &Config, faults: &mut Faults) -> BTreeMap<String, &'static Method> {
    let load = |name: &str, dir: &Path| {
        name.starts_with(FILE_PREFIX)
            .then(|| from_file::load(name, dir))
            .transpose()
    };
    let loaded = each(config, METHOD, faults, load).into_iter();
    loaded
        .filter_map(|(name, method)| Some((name, method?)))
        .collect()
}

impl Inputs {
    pub fn load(config: &Config, options: &LoadOptions, faults: &mut Faults) -> Self {
        let environments = each(config, ENVIRONMENT, faults, |name, dir| {
            Environment::load(name, dir, options).map(Arc::new)
        });
        let scenes = each(config, SCENE, faults, |name, dir| {
            Scene::load(name, dir).map(Arc::new)
        });
        let maps = each(config, PREFILTERED, faults, given::map);
        let tables = each(config, DFG_TABLE, faults, given::table);
        let methods = load_methods(config, faults);
        Self {
            environments,
            scenes,
            methods,
            maps,
            tables,
        }
    }

    pub fn environment(&self, name: &str) -> &Arc<Environment> {
        self.environments
            .get(name)
            .unwrap_or_else(|| panic!("the plan loaded no environment {name}"))
    }

    pub fn scene(&self, name: &str) -> &Arc<Scene> {
        self.scenes
            .get(name)
            .unwrap_or_else(|| panic!("the plan loaded no scene {name}"))
    }

    pub fn given(&self, settings: &Settings) -> Given {
        Given {
            prefiltered: self.maps.get(&settings.prefiltered).cloned().flatten(),
            dfg: self.tables.get(&settings.dfg).cloned().flatten(),
        }
    }

    pub fn scenes(&self) -> impl Iterator<Item = &Scene> {
        self.scenes.values().map(Arc::as_ref)
    }

    /// Lists name and content hash of every input.
    pub fn hashes(&self) -> Vec<(String, String)> {
        let environments = self
            .environments
            .values()
            .map(|e| (e.name.clone(), e.hash.clone()));
        let scenes = self
            .scenes
            .values()
            .map(|s| (s.name.clone(), s.hash.clone()));
        let methods = self
            .methods
            .values()
            .filter_map(|m| Some((m.name.to_owned(), m.shader?.to_owned())));
        let maps = self
            .maps
            .values()
            .flatten()
            .map(|m| (m.name.clone(), m.hash.clone()));
        let tables = self
            .tables
            .values()
            .flatten()
            .map(|t| (t.name.clone(), t.hash.clone()));
        environments
            .chain(scenes)
            .chain(methods)
            .chain(maps)
            .chain(tables)
            .collect()
    }

    /// Lists warnings about the inputs, each with the input's name.
    pub fn warnings(&self) -> Vec<String> {
        let environments = self
            .environments
            .values()
            .flat_map(|e| e.warnings.iter().map(|w| format!("{}: {w}", e.name)));
        let scenes = self
            .scenes
            .values()
            .flat_map(|s| s.warnings.iter().map(|w| format!("{}: {w}", s.name)));
        environments.chain(scenes).collect()
    }
}

#[cfg(test)]
mod tests;
