//! Hostile inputs do no harm: every target of `fuzz/` over its corpus, its regressions and mutated
//! seeds, on any toolchain.

mod mutation;
mod targets;

use crate::cpu_time;
use mutation::Mutator;
use rayon::prelude::*;
use splitsum::bake::{container, source};
use splitsum::instrument::environment::{Environment, LoadOptions};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::Duration;
use targets::{TARGETS, Target};

/// Mutated files of each target in an ordinary test run.
const MUTATIONS: usize = 400;
/// No file of this size may take longer, with any content.
const LONGEST: Duration = Duration::from_secs(10);

/// Runs a target; on failure keeps the input below `target/`.
fn try_input(target: &Target, name: &str, bytes: &[u8]) {
    let started = cpu_time();
    let result = catch_unwind(AssertUnwindSafe(|| (target.run)(bytes)));
    let is_slow = cpu_time() - started > LONGEST;
    if result.is_err() || is_slow {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/robustness");
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join(format!("{}-{name}", target.name));
        std::fs::write(&path, bytes).unwrap();
        let fault = if is_slow { "too slow" } else { "panicked" };
        panic!(
            "{} {name}: {fault} (kept as {})",
            target.name,
            path.display()
        );
    }
}

/// The files of a folder of `fuzz/` with their names, sorted.
fn kept(folder: &str, target: &str) -> Vec<(String, Vec<u8>)> {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("fuzz")
        .join(folder)
        .join(target);
    let mut paths: Vec<PathBuf> = std::fs::read_dir(dir)
        .into_iter()
        .flatten()
        .map(|entry| entry.unwrap().path())
        .collect();
    paths.sort();
    let name = |path: &Path| path.file_name().unwrap().to_string_lossy().into_owned();
    paths
        .iter()
        .map(|path| (name(path), std::fs::read(path).unwrap()))
        .collect()
}

/// Valid files, from which mutation starts.
fn seeds(target: &str) -> Vec<(String, Vec<u8>)> {
    kept("corpus", target)
        .into_iter()
        .filter(|(name, _)| name.starts_with("seed-"))
        .collect()
}

fn check(target: &Target) {
    let name = target.name;
    for (name, bytes) in kept("corpus", name)
        .iter()
        .chain(&kept("regressions", name))
    {
        try_input(target, name, bytes);
    }
    let (seeds, mut mutator) = (seeds(name), Mutator::new(0x5eed));
    let seeds: Vec<&[u8]> = seeds.iter().map(|(_, bytes)| bytes.as_slice()).collect();
    assert!(seeds.len() >= 2, "{name} has {} seeds", seeds.len());
    let count =
        std::env::var("SPLITSUM_MUTATIONS").map_or(MUTATIONS, |count| count.parse().unwrap());
    for i in 0..count {
        try_input(target, &format!("mutation-{i}"), &mutator.mutate(&seeds));
    }
}

#[test]
fn hostile_files_do_no_harm() {
    TARGETS.par_iter().for_each(check);
}

/// A truncated file is not a smaller texture.
#[test]
fn truncated_textures_are_refused() {
    for name in ["ktx2", "ktx", "dds"] {
        for (seed, bytes) in seeds(name) {
            let path = PathBuf::from(format!("{seed}.{name}"));
            container::from_bytes(&path, &bytes).unwrap_or_else(|error| panic!("{error}"));
            for length in 0..bytes.len() {
                assert!(
                    container::from_bytes(&path, &bytes[..length]).is_err(),
                    "{seed}.{name} of {length} bytes"
                );
            }
        }
    }
}

/// If the seeds were invalid, mutation would only test refusals.
#[test]
fn seeds_are_valid_files() {
    for extension in ["hdr", "exr"] {
        for (name, bytes) in seeds(extension) {
            let path = PathBuf::from(format!("{name}.{extension}"));
            let environment = Environment::from_bytes(&path, &bytes, &LoadOptions::default());
            environment.unwrap_or_else(|error| panic!("{error}"));
        }
    }
    for (name, bytes) in seeds("bake") {
        let dir = tempfile::tempdir().unwrap();
        targets::write_files(dir.path(), &bytes);
        let reading = source::Reading {
            layout: None,
            brdf: "ggx",
            byte_color: None,
        };
        let bake = source::read(&[dir.path().display().to_string()], reading);
        assert!(bake.is_ok_and(|bake| bake.specular.is_some()), "{name}");
    }
}
