//! Bakes through the binary: our own bake scores near zero, failing limits are printed, bad input
//! names its fault.

use super::end_to_end::folder;
use super::{assert_ends, assert_refusals, ok, splitsum};
use serde_json::Value;
use splitsum::bake::convention::Preset;
use splitsum::base::pixels::{GrayImage, RgbImage, exr};

#[test]
fn our_own_bakes_score_near_zero_in_every_layout() {
    let dir = tempfile::tempdir().unwrap();
    for layout in splitsum::instrument::environment::layout::LAYOUTS {
        let sets = ["layout", "brdf", "dfg_size"]
            .into_iter()
            .zip([layout.name, "ggx", "16"]);
        let sets: Vec<String> = sets
            .flat_map(|(name, value)| ["--set".into(), format!("{name}={value}")])
            .collect();
        let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
        ok(
            dir.path(),
            &[
                &["bake", "builtin:gradient", "--out", layout.name],
                &sets[..],
            ]
            .concat(),
        );
        let arguments = [
            "check-bake",
            layout.name,
            "--environment",
            "builtin:gradient",
            "--json",
        ];
        let limits = [
            "--fail-above",
            "1e-4",
            "--fail-table-above",
            "2e-3",
            "--fail-on-wrong",
        ];
        let found: Value =
            serde_json::from_str(&ok(dir.path(), &[&arguments[..], &limits].concat())).unwrap();
        let levels = found["levels"].as_array().unwrap();
        assert_eq!(levels.len(), 5);
        for level in levels {
            assert!(
                level["relmse"].as_f64().unwrap() < 1e-10
                    && level["bias_rel"].as_f64().unwrap().abs() < 1e-5,
                "{level}"
            );
        }
        assert!(found["dfg"]["max_error"].as_f64().unwrap() > 0.0, "{found}");
    }
    // The same bake against another light.
    let arguments = [
        "check-bake",
        "cube",
        "--environment",
        "builtin:sky",
        "--fail-above",
        "0.01",
    ];
    let output = splitsum(dir.path(), &arguments);
    assert_ends(&output, 1, &["level 1: relmse", "is above 1.00e-2"]);
    let arguments = [
        "check-bake",
        "cube",
        "--environment",
        "builtin:sky",
        "--fail-on-wrong",
    ];
    assert_ends(
        &splitsum(dir.path(), &arguments),
        1,
        &["wrong: seems to be a bake of another map"],
    );
    // The verdict does not name a width or a gain.
    let text = String::from_utf8_lossy(&output.stdout);
    let said = text
        .lines()
        .filter(|line| line.starts_with("| "))
        .find(|line| line.contains("too ") || line.contains("explains"));
    assert!(said.is_none(), "{said:?}");
}

/// Files of each engine, read with its preset, as a folder and file by file.
#[test]
fn bakes_for_every_engine_score_as_exact() {
    let dir = tempfile::tempdir().unwrap();
    for preset in Preset::engines() {
        let product = preset.product();
        // An atlas has its own size. Both packed files hold what other engines have beside the map.
        let is_packed = ["rgbd", "rgbp"].contains(&product.texel);
        let size = if product.texel == "rgbp" {
            "prefilter_size=512x512"
        } else {
            "prefilter_size=64x64"
        };
        // Bytes cut the sky.
        let environment = if product.texel == "srgb8" {
            "builtin:gradient:slope=0.4"
        } else {
            "builtin:sky"
        };
        let set = ["--set", size, "--set", "dfg_size=8"];
        ok(
            dir.path(),
            &[
                &[
                    "bake",
                    environment,
                    "--for",
                    product.engine,
                    "--out",
                    product.engine,
                ],
                &set[..],
            ]
            .concat(),
        );
        let limits = [
            "--environment",
            environment,
            "--fail-above",
            "1e-3",
            "--fail-table-above",
            "0.003",
        ];
        let scored = |files: &[&str]| -> Value {
            let arguments = [&["check-bake"], files, &limits, &["--json"]].concat();
            serde_json::from_str(&ok(dir.path(), &arguments)).unwrap()
        };
        let found = scored(&[product.engine]);
        assert_eq!(found["preset"], preset.name);
        assert!(
            found["axes_fits"]
                .as_array()
                .unwrap()
                .iter()
                .all(|fit| fit["warning"].is_null()),
            "{found}"
        );
        if !is_packed {
            assert_eq!(found["irradiance"].is_null(), product.irradiance.is_none());
            assert_eq!(
                [found["sh"].is_null(), found["dfg"].is_null()],
                [product.sh.is_none(), product.tables.is_empty()]
            );
        }
        // bake.json is not needed.
        let specular = format!("specular={}/{}", product.engine, product.specular);
        if let Some(table) = product.tables.last() {
            let table = format!("dfg={}/{table}", product.engine);
            let found = scored(&[&specular, &table, "--preset", preset.name]);
            assert!(!found["levels"].as_array().unwrap().is_empty(), "{found}");
        }
    }
    ok(
        dir.path(),
        &["check-bake", "bevy", "--environment", "builtin:sky"],
    );
    // F3D's folder as F3D leaves it, without bake.json.
    let cache = dir.path().join("f3d");
    std::fs::remove_file(cache.join("bake.json")).unwrap();
    let arguments = [
        "check-bake",
        "f3d",
        "--environment",
        "builtin:sky",
        "--json",
    ];
    let found: Value = serde_json::from_str(&ok(dir.path(), &arguments)).unwrap();
    assert!(
        found["preset"] == "vtk" && found["levels"][4]["passes"] == true && found["sh"].is_object(),
        "{found}"
    );
    // The skybox of Open3D is the sharp map.
    let arguments = [
        "check-bake",
        "specular=open3d/light_skybox.ktx",
        "--environment",
        "builtin:sky",
        "--json",
    ];
    let found: Value = serde_json::from_str(&ok(dir.path(), &arguments)).unwrap();
    assert_eq!(found["levels"][0]["passes"], true, "{found}");
    // A tool's folder, as cmgen leaves it.
    std::fs::create_dir(dir.path().join("tool")).unwrap();
    for (from, to) in [
        ("ibl.ktx", "sky_ibl.ktx"),
        ("ibl.ktx", "sky_skybox.ktx"),
        ("sh.txt", "sh.txt"),
    ] {
        std::fs::copy(
            dir.path().join("filament").join(from),
            dir.path().join("tool").join(to),
        )
        .unwrap();
    }
    let arguments = [
        "check-bake",
        "tool",
        "--environment",
        "builtin:sky",
        "--fail-on-wrong",
        "--json",
    ];
    let found: Value = serde_json::from_str(&ok(dir.path(), &arguments)).unwrap();
    assert!(
        found["levels"][1]["passes"] == true && found["sh"].is_object(),
        "{found}"
    );
    // With other widths than assumed it is still a bake of this light.
    let arguments = [
        "check-bake",
        "filament/ibl.ktx",
        "--environment",
        "builtin:sky",
    ];
    let said = splitsum(dir.path(), &arguments);
    assert!(
        !String::from_utf8_lossy(&said.stderr).contains("another map"),
        "{said:?}"
    );
    // A bake of another light is distinguished from a bake with other axes.
    let arguments = [
        "check-bake",
        "bevy",
        "--environment",
        "builtin:studio",
        "--fail-above",
        "1e-3",
    ];
    assert_ends(
        &splitsum(dir.path(), &arguments),
        1,
        &["seems to be a bake of another map"],
    );
    let arguments = [
        "check-bake",
        "bevy",
        "--environment",
        "builtin:sky",
        "--fail-above",
        "1e-3",
        "--axes=+y+x-z",
    ];
    let output = splitsum(dir.path(), &arguments);
    assert_ends(&output, 1, &["fit far better than +y+x-z"]);
    let text = String::from_utf8_lossy(&[&output.stderr[..], &output.stdout].concat()).into_owned();
    assert!(
        text.lines().all(|line| line.chars().count() <= 100)
            && text.contains("\nVerdict: wrong: axes"),
        "{text}"
    );
    // A sun that halves cut: the files are written, and the flag decides the exit code.
    let sun = RgbImage::from_fn(64, 32, |x, y| {
        [if [x, y] == [20, 8] { 1e7 } else { 1.0 }; 3]
    });
    let alpha = GrayImage::filled(64, 32, 1.0);
    exr::write_rgba(&dir.path().join("sun.exr"), &sun, &alpha, &[]).unwrap();
    let bake = |out: &str, more: &[&str]| {
        let arguments = ["bake", "sun.exr", "--for", "khronos", "--out", out];
        let size = ["--set", "prefilter_size=64x64", "--set", "dfg_size=8"];
        splitsum(dir.path(), &[&arguments[..], &size, more].concat())
    };
    let warned = bake("sunny", &[]);
    assert_eq!(warned.status.code(), Some(0), "{warned:?}");
    let text = String::from_utf8_lossy(&warned.stderr).into_owned();
    assert!(
        text.contains("level 0: loses 9") && text.contains("--format rgb32f holds them"),
        "{text}"
    );
    assert_ends(&bake("failing", &["--fail-on-loss"]), 1, &["of its light"]);
    let whole = bake("whole", &["--fail-on-loss", "--format", "rgb32f"]);
    assert_eq!(whole.status.code(), Some(0), "{whole:?}");
    // An .env of Babylon.js ends at 255.
    let arguments = ["bake", "sun.exr", "--for", "babylon-env", "--out", "env"];
    let warned = splitsum(
        dir.path(),
        &[&arguments[..], &["--set", "prefilter_size=64x64"]].concat(),
    );
    let text = String::from_utf8_lossy(&warned.stderr).into_owned();
    assert!(
        text.contains("level 0: loses 9") && text.contains("cut at 255, the maximum of rgbd"),
        "{text}"
    );
    // A manifest that names a file outside its folder.
    let manifest = std::fs::read_to_string(dir.path().join("bevy/bake.json")).unwrap();
    let elsewhere = manifest.replace("\"specular.ktx2\"", "\"../bevy/specular.ktx2\"");
    assert_ne!(elsewhere, manifest);
    std::fs::create_dir(dir.path().join("odd")).unwrap();
    std::fs::write(dir.path().join("odd/bake.json"), elsewhere).unwrap();
    assert_refusals(
        "commands_of_bake_that_are_refused",
        dir.path(),
        &[
            "bake builtin:sky --out x --for bevvy",
            "bake builtin:sky --out bevy --for bevy",
            "bake builtin:sky --out x --for bevy --format rg16f",
            "bake builtin:sky --out x --for unity --set prefilter_size=32x32",
            "bake builtin:sky --out x --for bevy --set prefilter_size=100x100",
            "bake builtin:sky --out x --for bevy --set layout=equirect",
            "bake builtin:sky --out x --set prefilter_level_count=9",
            "bake builtin:sky --out x --set dfg_sample_count=64",
            "bake builtin:sky --out x --set prefilter_size=4096x4096",
            "bake builtin:sky --out x --set dfg_size=8 --set dfg_size=9",
            // A limit that applies to no part is refused.
            "check-bake khronos/lut_ggx.png --environment builtin:sky --fail-above 0.1",
            "check-bake irradiance=khronos/diffuse.ktx2 --environment builtin:sky \
             --fail-between-above 0.1",
            "check-bake odd --environment builtin:sky",
        ],
    );
}

/// A frame with tables from a file equals the frame with our own tables of the same widths.
#[test]
fn frames_by_given_tables_equal_frames_by_our_own() {
    let Some(dir) = folder() else { return };
    let sizes = [
        "--set",
        "prefilter_size=64x64",
        "--set",
        "prefilter_level_count=4",
        "--set",
        "dfg_size=16",
    ];
    let render = |name: &str, tables: &[&str]| {
        let view = [
            "--environment",
            "builtin:gradient",
            "--method",
            "split-sum",
            "--alpha",
            "0.4",
            "--size",
            "32x32",
        ];
        ok(
            dir.path(),
            &[
                &[
                    "render",
                    "--out",
                    name,
                    "--diffuse",
                    "none",
                    "--masking",
                    "correlated",
                ],
                &view[..],
                tables,
            ]
            .concat(),
        );
        exr::read(&dir.path().join(name))
            .unwrap()
            .rgb
            .data
            .into_flattened()
    };
    for (engine, mapping) in [
        ("khronos", "linear"),
        ("filament", "quadratic"),
        ("bevy", "linear"),
    ] {
        ok(
            dir.path(),
            &[
                &["bake", "builtin:gradient", "--for", engine, "--out", engine],
                &sizes[..],
            ]
            .concat(),
        );
        let own = [
            "--prefilter-size",
            "64x64",
            "--prefilter-level-count",
            "4",
            "--level-mapping",
            mapping,
        ];
        let own = render("own.exr", &own);
        let theirs = render("theirs.exr", &["--prefiltered", &format!("file:{engine}")]);
        let off = own
            .iter()
            .zip(&theirs)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f32::max);
        let largest = own.iter().copied().fold(0.0, f32::max);
        assert!(off < 0.01 * largest, "{engine}: {off} of {largest}");
    }
}

#[test]
fn a_constant_map_is_its_own_bake() {
    let dir = tempfile::tempdir().unwrap();
    let map = RgbImage::filled(16, 8, [1.0; 3]);
    exr::write_rgba(
        &dir.path().join("x.exr"),
        &map,
        &GrayImage::filled(16, 8, 1.0),
        &[],
    )
    .unwrap();
    // A constant map is its own prefiltered map, at any width.
    std::fs::write(dir.path().join("own.toml"), "alphas = [0.3]\n").unwrap();
    let own = [
        "check-bake",
        "x.exr",
        "--preset",
        "own.toml",
        "--environment",
        "builtin:constant",
        "--json",
    ];
    let found: Value = serde_json::from_str(&ok(dir.path(), &own)).unwrap();
    let level = &found["levels"][0];
    assert!(
        level["alpha"] == 0.3 && level["relmse"].as_f64().unwrap() < 1e-12,
        "{found}"
    );
}
