//! Inputs of anyone's making do no harm: every target of `fuzz/` over its corpus, its regressions and mutated seeds, on any toolchain.

mod mutation;
mod seeds;
mod targets;

use crate::cpu_time;
use mutation::Mutator;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::Duration;
use targets::{TARGETS, Target};

/// Mutated files of each target in an ordinary test run.
const MUTATIONS: usize = 400;
/// No file of this size may take longer, whatever it holds.
const LONGEST: Duration = Duration::from_secs(10);

/// Runs a target; a failure leaves the input below `target/`.
fn try_input(target: &Target, name: &str, bytes: &[u8]) {
    let started = cpu_time();
    let result = catch_unwind(AssertUnwindSafe(|| (target.run)(bytes)));
    let is_slow = cpu_time() - started > LONGEST;
    if result.is_err() || is_slow {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/robustness");
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join(format!("{}-{name}", target.name));
        std::fs::write(&path, bytes).unwrap();
        panic!(
            "{} {name}: {} (kept as {})",
            target.name,
            if is_slow { "too slow" } else { "panicked" },
            path.display()
        );
    }
}

/// The files of a folder of `fuzz/` with their names, in order.
fn kept(folder: &str, target: &Target) -> Vec<(String, Vec<u8>)> {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz").join(folder).join(target.name);
    let mut paths: Vec<PathBuf> =
        std::fs::read_dir(dir).into_iter().flatten().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let name = |path: &Path| path.file_name().unwrap().to_string_lossy().into_owned();
    paths.iter().map(|path| (name(path), std::fs::read(path).unwrap())).collect()
}

fn check(name: &str) {
    let target = TARGETS.iter().find(|target| target.name == name).unwrap();
    let seeds = seeds::seeds(name);
    for (name, bytes) in seeds.iter().chain(&kept("corpus", target)).chain(&kept("regressions", target)) {
        try_input(target, name, bytes);
    }
    let count = std::env::var("SPLITSUM_MUTATIONS").map_or(MUTATIONS, |count| count.parse().unwrap());
    let mut mutator = Mutator::new(0x5eed);
    for i in 0..count {
        let bytes = mutator.mutate(&seeds.iter().map(|(_, bytes)| bytes.as_slice()).collect::<Vec<_>>());
        try_input(target, &format!("mutation-{i}"), &bytes);
    }
}

#[test]
fn radiance_pictures() {
    check("hdr");
}

#[test]
fn openexr_files() {
    check("exr");
}

#[test]
fn wavefront_files() {
    check("obj");
}

#[test]
fn gltf_files() {
    check("gltf");
}

#[test]
fn experiments() {
    check("experiment");
}

#[test]
fn tables_of_queries() {
    check("queries");
}

#[test]
fn folders_of_runs() {
    check("report");
}

#[test]
fn textures() {
    for name in ["ktx2", "ktx", "dds"] {
        check(name);
        for (seed, bytes) in seeds::seeds(name) {
            let path = PathBuf::from(format!("{seed}.{name}"));
            splitsum::bakes::container::from_bytes(&path, &bytes).unwrap_or_else(|error| panic!("{error}"));
            // A file that ends early is no smaller texture.
            for length in 0..bytes.len() {
                let cut = splitsum::bakes::container::from_bytes(&path, &bytes[..length]);
                assert!(cut.is_err(), "{seed}.{name} of {length} bytes");
            }
        }
    }
}

#[test]
fn parts_of_bakes() {
    for name in ["png", "sh", "bake"] {
        check(name);
    }
}

/// The seeds must be right files, or mutation starts from refusals only.
#[test]
fn seeds_are_read() {
    use splitsum::environment::{Environment, LoadOptions};
    for (extension, count) in [("hdr", 9), ("exr", 23)] {
        let seeds = seeds::seeds(extension);
        assert_eq!(seeds.len(), count);
        for (name, bytes) in seeds {
            let path = PathBuf::from(format!("{name}.{extension}"));
            let environment = Environment::from_bytes(&path, &bytes, &LoadOptions::default());
            environment.unwrap_or_else(|error| panic!("{error}"));
        }
    }
    for (name, bytes) in seeds::seeds("bake") {
        let dir = tempfile::tempdir().unwrap();
        targets::write_files(dir.path(), &bytes);
        let reading = splitsum::bakes::source::Reading { layout: None, brdf: "ggx" };
        let bake = splitsum::bakes::source::read(&[dir.path().display().to_string()], reading);
        assert!(bake.is_ok_and(|bake| bake.specular.is_some()), "{name}");
    }
}

/// Writes the seeds to `fuzz/corpus`.
#[test]
#[ignore = "writes files of the repository: scripts/fuzz.sh calls it"]
fn write_seeds() {
    for target in TARGETS {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(target.name);
        std::fs::create_dir_all(&folder).unwrap();
        for (name, bytes) in seeds::seeds(target.name) {
            std::fs::write(folder.join(format!("seed-{name}")), bytes).unwrap();
        }
    }
}
