//! Fuzz targets: one function per kind of input, which passes any bytes through all their readers.
//!
//! They panic if a promise is broken: a result that later code could not trust, or a message that
//! does not name the file. `fuzz/fuzz_targets` and the tests beside this file share them.

use splitsum::bake::container::{TEXELS_MAX, from_bytes};
use splitsum::bake::{sh, source};
use splitsum::base::names::Listed;
use splitsum::base::pixels::{GrayImage, RgbImage, exr};
use splitsum::experiment::fault::Faults;
use splitsum::experiment::{Config, Plan};
use splitsum::instrument::environment::{Environment, EnvironmentError, LoadOptions};
use splitsum::instrument::scene::{Scene, SceneFiles};
use splitsum::oracle::{Kind, Queries};
use splitsum::report::page::{PageOptions, PageRun, write};
use splitsum::study::finished::Finished;
use splitsum::study::questions::answers;
use std::collections::BTreeMap;
use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};

/// A kind of input: the name of its fuzz target and corpus folder, and its reader.
pub struct Target {
    pub name: &'static str,
    pub run: fn(&[u8]),
}

/// Every kind of input. Models and experiments are several files in one, see [`files`].
pub const TARGETS: &[Target] = &[
    Target {
        name: "hdr",
        run: |bytes| environment("x.hdr", bytes),
    },
    Target {
        name: "exr",
        run: |bytes| environment("x.exr", bytes),
    },
    Target {
        name: "obj",
        run: |bytes| scene("x.obj", Memory(files(bytes))),
    },
    Target {
        name: "gltf",
        run: gltf,
    },
    Target {
        name: "experiment",
        run: experiment,
    },
    Target {
        name: "queries",
        run: queries,
    },
    Target {
        name: "report",
        run: report,
    },
    Target {
        name: "ktx2",
        run: |bytes| texture("x.ktx2", bytes),
    },
    Target {
        name: "ktx",
        run: |bytes| texture("x.ktx", bytes),
    },
    Target {
        name: "dds",
        run: |bytes| texture("x.dds", bytes),
    },
    Target {
        name: "png",
        run: |bytes| texture("x.png", bytes),
    },
    Target {
        name: "sh",
        run: coefficients,
    },
    Target {
        name: "bake",
        run: bake,
    },
];

/// Runs the target of this name, for `fuzz/fuzz_targets`.
#[allow(dead_code, reason = "the tests run each of the list")]
pub fn run(name: &str, bytes: &[u8]) {
    let target = TARGETS
        .iter()
        .find(|target| target.name == name)
        .expect("a target of the list");
    (target.run)(bytes);
}

fn environment(name: &str, bytes: &[u8]) {
    let load = |clamp_invalid| {
        Environment::from_bytes(
            Path::new(name),
            bytes,
            &LoadOptions {
                clamp_invalid,
                ..LoadOptions::default()
            },
        )
    };
    match load(true) {
        Ok(environment) => {
            let image = &environment.image;
            assert_eq!(
                image.data.len(),
                image.width as usize * image.height as usize
            );
            assert!(
                image
                    .data
                    .iter()
                    .flatten()
                    .all(|x| x.is_finite() && *x >= 0.0),
                "an invalid texel came through"
            );
            match load(false) {
                Ok(strict) => assert_eq!(
                    strict.hash, environment.hash,
                    "reading twice gives two images"
                ),
                Err(EnvironmentError::InvalidTexels { .. }) => {}
                Err(error) => panic!("read only the first time: {error}"),
            }
        }
        Err(error) => assert_names(&error.to_string(), name),
    }
}

/// Nine coefficients, as cmgen's text and as our JSON.
fn coefficients(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    for name in ["x.txt", "x.json"] {
        match sh::parse(Path::new(name), text) {
            Ok(found) => assert!(found.radiance.iter().all(|triple| triple.is_finite())),
            Err(error) => assert_names(&error.to_string(), name),
        }
    }
}

/// A folder of a bake, as [`files`]: faces by their names, or the files named in `bake.json`.
fn bake(bytes: &[u8]) {
    let dir = tempfile::tempdir().expect("a folder for temporary files");
    write_files(dir.path(), bytes);
    match source::read(
        &[dir.path().display().to_string()],
        source::Reading {
            layout: None,
            brdf: "ggx",
            byte_color: None,
        },
    ) {
        Ok(bake) => {
            for map in [bake.specular, bake.irradiance].iter().flatten() {
                assert!(!map.levels.is_empty());
                assert!(
                    map.levels
                        .iter()
                        .all(|level| level.len() == map.layout.face_count as usize)
                );
            }
        }
        Err(error) => assert_names(&error.to_string(), &dir.path().display().to_string()),
    }
}

fn texture(name: &str, bytes: &[u8]) {
    match from_bytes(Path::new(name), bytes) {
        Ok(texture) => {
            let images = || texture.levels.iter().flatten();
            let texels: usize = images().map(|image| image.data.len()).sum();
            assert!(texels as u64 <= TEXELS_MAX, "{texels} texels");
            assert!(
                images()
                    .all(|image| image.data.len() == image.width as usize * image.height as usize)
            );
            assert!(
                images()
                    .flat_map(|image| image.data.as_flattened())
                    .all(|x| x.is_finite()),
                "no number came through"
            );
            assert!(
                texture
                    .levels
                    .iter()
                    .all(|level| level.len() == texture.levels[0].len())
            );
        }
        Err(error) => assert_names(&error.to_string(), name),
    }
}

fn assert_names(message: &str, name: &str) {
    assert!(
        message.contains(name) && message.lines().count() == 1,
        "{message:?} should name {name} in one line"
    );
}

struct Memory(BTreeMap<PathBuf, Vec<u8>>);

impl SceneFiles for Memory {
    fn read(&self, path: &Path) -> std::io::Result<Vec<u8>> {
        self.0
            .get(path)
            .cloned()
            .ok_or_else(|| Error::from(ErrorKind::NotFound))
    }

    fn has(&self, path: &Path) -> bool {
        self.0.contains_key(path)
    }
}

/// Several files in one: each begins after a line `@@NAME`. Text before the first such line is
/// ignored.
fn files(bytes: &[u8]) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files: BTreeMap<PathBuf, Vec<u8>> = BTreeMap::new();
    let mut current = None;
    for line in bytes.split_inclusive(|byte| *byte == b'\n') {
        match line
            .strip_prefix(b"@@")
            .and_then(|name| std::str::from_utf8(name).ok())
        {
            Some(name) => {
                // Compares by components: "m.mtl/" is found as "m.mtl" and must have that name.
                let name: PathBuf = Path::new(name.trim_end()).components().collect();
                files.entry(name.clone()).or_default();
                current = Some(name);
            }
            None => {
                if let Some(file) = current.as_ref().and_then(|name| files.get_mut(name)) {
                    file.extend(line);
                }
            }
        }
    }
    files
}

/// Writes [`files`] to a folder: at most one deep, and never outside.
pub fn write_files(dir: &Path, bytes: &[u8]) {
    for (name, content) in files(bytes) {
        let is_plain = |name: &std::ffi::OsStr| {
            !name.is_empty() && name.len() < 100 && !name.as_encoded_bytes().contains(&0)
        };
        let parts: Vec<_> = name.components().collect();
        let is_inside = parts
            .iter()
            .all(|part| matches!(part, std::path::Component::Normal(name) if is_plain(name)));
        if is_inside && (1..=2).contains(&parts.len()) {
            let path = dir.join(&name);
            let _ = std::fs::create_dir_all(path.parent().expect("it is joined"));
            let _ = std::fs::write(path, content);
        }
    }
}

/// A binary glTF file, or a text `x.gltf` with its buffers and images, as [`files`].
fn gltf(bytes: &[u8]) {
    let (name, memory) = match bytes.starts_with(b"glTF") {
        true => (
            "x.glb",
            BTreeMap::from([(PathBuf::from("x.glb"), bytes.to_vec())]),
        ),
        false => ("x.gltf", files(bytes)),
    };
    scene(name, Memory(memory));
}

fn scene(name: &str, memory: Memory) {
    match Scene::from_file(Path::new(name), &memory) {
        Ok(scene) => {
            for mesh in &scene.meshes {
                assert!(mesh.material < scene.materials.len());
                assert_eq!(mesh.positions.len(), mesh.normals.len());
                assert_eq!(mesh.positions.len(), mesh.uvs.len());
                assert_eq!(mesh.positions.len(), mesh.tangents.len());
                assert!(
                    mesh.indices
                        .iter()
                        .all(|&index| (index as usize) < mesh.positions.len())
                );
                let is_unit =
                    |n: &[f32; 3]| (n.iter().map(|x| x * x).sum::<f32>() - 1.0).abs() < 1e-3;
                assert!(
                    mesh.indices
                        .iter()
                        .all(|&index| is_unit(&mesh.normals[index as usize])),
                    "no unit normal"
                );
            }
            for material in &scene.materials {
                assert!(
                    material.alpha > 0.0 && material.alpha <= 1.0,
                    "alpha {}",
                    material.alpha
                );
                assert!((0.0..=1.0).contains(&material.metallic));
                assert!(
                    material
                        .albedo
                        .iter()
                        .chain(&material.f0)
                        .all(|x| (0.0..=1.0).contains(x))
                );
                assert!(
                    material
                        .maps()
                        .into_iter()
                        .flatten()
                        .all(|map| map < scene.textures.len())
                );
            }
        }
        Err(error) => {
            let message = error.to_string();
            assert!(
                message.starts_with(name)
                    || memory
                        .0
                        .keys()
                        .any(|name| message.contains(&*name.to_string_lossy()))
            );
            assert!(message.lines().count() == 1, "{message:?}");
        }
    }
}

/// An experiment `x.toml`, with the lines of `set` as `--set`, as [`files`].
fn experiment(bytes: &[u8]) {
    /// Above this many combinations the expansion is merely slow.
    const COMBINATIONS_MAX: u64 = 3000;
    let files = files(bytes);
    let text = |name: &str| {
        files
            .get(Path::new(name))
            .and_then(|bytes| std::str::from_utf8(bytes).ok())
    };
    let Some(toml) = text("x.toml") else { return };
    let sets: Vec<String> = text("set")
        .unwrap_or_default()
        .lines()
        .take(4)
        .map(str::to_owned)
        .collect();
    // A folder that does not exist: paths of the file lead nowhere.
    let path = Path::new("nowhere/x.toml");
    if Config::parse(path, toml, &sets, &mut Faults::new(path, toml)).combination_count()
        > COMBINATIONS_MAX
    {
        return;
    }
    match Plan::from_text(path, toml, &sets) {
        Ok(plan) => {
            let planned: usize = plan
                .groups()
                .iter()
                .flat_map(|group| &group.radiances)
                .map(|radiance| radiance.cells.len())
                .sum();
            assert_eq!(planned, plan.cells.len());
            for cell in &plan.cells {
                plan.request(&cell.point);
                plan.label(cell);
            }
            splitsum::run::timing::jobs(&plan);
        }
        Err(error) => {
            assert!(!error.faults.is_empty());
            let places = ["nowhere/x.toml", "--set"];
            for fault in &error.faults {
                assert!(
                    places
                        .iter()
                        .any(|place| fault.to_string().starts_with(place)),
                    "no place in {fault}"
                );
            }
        }
    }
}

fn queries(bytes: &[u8]) {
    let options = LoadOptions {
        builtin_size: [8, 4],
        ..LoadOptions::default()
    };
    for &kind in Kind::all() {
        match Queries::from_bytes(Path::new("nowhere/x.csv"), bytes, kind, &options) {
            Ok(queries) => assert!(queries.len() <= bytes.len()),
            Err(faults) => assert!(faults.to_string().starts_with("nowhere/x.csv:")),
        }
    }
}

/// The files of a run's folder, as [`files`]; the images already exist. The files go to their own
/// folder, because a report reads, lists and writes folders.
fn report(bytes: &[u8]) {
    let dir = tempfile::tempdir().expect("a folder for temporary files");
    let run = dir.path().join("run");
    std::fs::create_dir_all(run.join("images")).expect("a folder of our own");
    for (name, value) in [("a.exr", 1.0), ("b.exr", 0.5), ("r.exr", 0.75)] {
        let (rgb, mask) = (
            RgbImage::filled(2, 2, [value; 3]),
            GrayImage::filled(2, 2, 1.0),
        );
        exr::write_rgba(&run.join("images").join(name), &rgb, &mask, &[])
            .expect("a folder of our own");
    }
    write_files(&run, bytes);
    let options = PageOptions {
        out: dir.path().join("page.html"),
        ..PageOptions::in_folder(&run)
    };
    let read_run = Finished::read(&run).map(|run| {
        let answers = answers(&run, None);
        [(run, answers)]
    });
    let runs = match read_run {
        Ok(runs) => runs,
        Err(error) => {
            return assert!(
                error.to_string().contains("run"),
                "{error} should name the folder"
            );
        }
    };
    match write(&options, &PageRun::of_runs(&runs)) {
        Ok(written) => {
            let page = std::fs::read_to_string(&written.path).expect("the page was written");
            assert!(page.trim_end().ends_with("</html>"));
        }
        Err(error) => assert!(
            error.to_string().contains("run"),
            "{error} should name the folder"
        ),
    }
}
