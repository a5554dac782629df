//! Faults of the device and of the Vulkan installation: each is provoked, and ends with its message
//! and exit code.
//!
//! `SPLITSUM_TEST_FAULTS` (`src/instrument/gpu/inject.rs`) makes a call fail as a driver would.
//! `SPLITSUM_TEST_LIMITS` (`src/instrument/gpu/emulation.rs`) emulates limits of hardware.

use super::end_to_end::folder;
use super::{assert_ends, command, ok, splitsum, stderr};
use std::path::Path;
use std::process::Output;

const FAULTS: &str = "SPLITSUM_TEST_FAULTS";

fn with_fault(dir: &Path, arguments: &[&str], fault: &str) -> Output {
    command(dir, arguments).env(FAULTS, fault).output().unwrap()
}

fn errors(dir: &Path, out: &str) -> Vec<u8> {
    std::fs::read(dir.join(out).join("errors.csv")).unwrap()
}

/// A small image.
const RENDER: [&str; 9] = [
    "render",
    "--size",
    "16x16",
    "--environment",
    "builtin:constant",
    "--method",
    "sampled",
    "--out",
    "x.exr",
];

#[test]
fn a_lost_device_ends_a_run_that_resumes_to_the_same_bytes() {
    let Some(dir) = folder() else { return };
    ok(dir.path(), &["run", "tiny.toml", "--out", "whole"]);
    // Early in the precompute, within a reference, between cells, and late.
    for submit in [1, 6, 23, 60, 120] {
        let out = format!("lost-{submit}");
        let arguments = ["run", "tiny.toml", "--out", &out];
        let output = with_fault(
            dir.path(),
            &arguments,
            &format!("submit:{submit}:device-lost"),
        );
        assert_ends(
            &output,
            75,
            &[
                "the device was lost",
                "run the same command again to continue",
            ],
        );
        ok(dir.path(), &arguments);
        assert!(
            errors(dir.path(), &out) == errors(dir.path(), "whole"),
            "lost at submission {submit}"
        );
    }
    let output = with_fault(dir.path(), &RENDER, "submit:2:device-lost");
    assert_ends(&output, 75, &["the device was lost during"]);
    assert!(!dir.path().join("x.exr").exists());
}

#[test]
fn memory_that_runs_out_fails_cells_and_a_later_run_finishes_them() {
    let Some(dir) = folder() else { return };
    ok(dir.path(), &["run", "tiny.toml", "--out", "whole"]);
    let arguments = ["run", "tiny.toml", "--out", "full"];
    let output = with_fault(dir.path(), &arguments, "allocate:90:memory-is-full");
    assert_ends(&output, 4, &["cells failed", "out of device memory"]);
    let table = String::from_utf8(errors(dir.path(), "full")).unwrap();
    assert!(table.lines().count() > 1, "what was done before is kept");
    // Failed cells take as long as cells that were never tried.
    let predicted = || {
        let plan = ok(
            dir.path(),
            &["plan", "tiny.toml", "--out", "full", "--json"],
        );
        serde_json::from_str::<serde_json::Value>(&plan).unwrap()["estimate"]["seconds"]
            .as_f64()
            .unwrap()
    };
    let before = predicted();
    std::fs::remove_dir_all(dir.path().join("full/failed")).unwrap();
    assert!(
        before > 0.0 && (predicted() / before - 1.0).abs() < 1e-9,
        "{before}"
    );
    ok(dir.path(), &arguments);
    assert!(errors(dir.path(), "full") == errors(dir.path(), "whole"));

    let output = with_fault(dir.path(), &RENDER, "allocate:8:memory-is-full");
    assert_ends(&output, 1, &["out of device memory for '"]);
    assert!(!dir.path().join("x.exr").exists());
    // If memory is short for a moment, the program frees the resources of earlier requests and goes
    // on.
    let output = with_fault(
        dir.path(),
        &["run", "tiny.toml", "--out", "short"],
        "allocate:90:out-of-memory",
    );
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(errors(dir.path(), "short") == errors(dir.path(), "whole"));
}

#[test]
fn images_too_large_for_any_device_are_refused_before_work() {
    let Some(dir) = folder() else { return };
    let huge = [
        "render",
        "--size",
        "16384x16384",
        "--environment",
        "builtin:constant",
        "--out",
        "x.exr",
    ];
    assert_ends(
        &splitsum(dir.path(), &huge),
        2,
        &["16384x16384 is too large for the device", "MiB"],
    );
    let huge = ["run", "tiny.toml", "--set", "size=16x16,16384x16383"];
    assert_ends(
        &splitsum(dir.path(), &huge),
        2,
        &["16384x16383 is too large for the device", "MiB"],
    );
    assert!(!dir.path().join("runs").exists() && !dir.path().join("x.exr").exists());
}

#[test]
fn a_vulkan_installation_without_its_parts_is_reported() {
    let dir = tempfile::tempdir().unwrap();
    let refused = |variable: &str, value: &Path, parts: &[&str]| {
        let mut command = command(dir.path(), &RENDER);
        if variable != "LD_LIBRARY_PATH" {
            command
                .env("VK_DRIVER_FILES", value)
                .env("VK_ICD_FILENAMES", value);
        } else {
            command.env(variable, value);
        }
        assert_ends(&command.output().unwrap(), 2, parts);
        assert!(!dir.path().join("x.exr").exists());
    };
    // A loader without a driver, with a broken driver file, and with a driver whose library is
    // missing.
    refused(
        "VK_DRIVER_FILES",
        Path::new("/nonexistent"),
        &["found no device", "VK_DRIVER_FILES"],
    );
    let manifest = |name: &str, text: &str| {
        let path = dir.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    refused(
        "VK_DRIVER_FILES",
        &manifest("garbage.json", "{"),
        &["Vulkan loader", "VK_DRIVER_FILES"],
    );
    let absent = r#"{"file_format_version": "1.0.0", "ICD": {"library_path": "/nonexistent.so", "api_version": "1.3.0"}}"#;
    refused(
        "VK_DRIVER_FILES",
        &manifest("absent.json", absent),
        &["found no device"],
    );
    // No loader: a text file with the name of the library hides the real one.
    #[cfg(target_os = "linux")]
    {
        let libraries = dir.path().join("libraries");
        std::fs::create_dir(&libraries).unwrap();
        std::fs::write(libraries.join("libvulkan.so.1"), "no library").unwrap();
        refused(
            "LD_LIBRARY_PATH",
            &libraries,
            &["no Vulkan loader", "libvulkan"],
        );
    }
}

/// A driver below the minimum: the real driver behind a layer (`layer.c`) that removes a feature.
#[cfg(target_os = "linux")]
#[test]
fn a_driver_below_the_minimum_is_named_with_its_missing_feature() {
    let Some(dir) = folder() else { return };
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cli/layer.c");
    let library = dir.path().join("layer.so");
    let compiler = std::process::Command::new("cc")
        .args(["-shared", "-fPIC", "-O1", "-o"])
        .arg(&library)
        .arg(source)
        .status();
    if !compiler.is_ok_and(|status| status.success()) {
        eprintln!("skipped: there is no C compiler for the layer");
        return;
    }
    let manifest = format!(
        r#"{{"file_format_version": "1.1.2", "layer": {{"name": "VK_LAYER_SPLITSUM_old_driver", "type": "INSTANCE",
        "library_path": {library:?}, "api_version": "1.3.0", "implementation_version": "1", "description": "test"}}}}"#
    );
    std::fs::write(dir.path().join("layer.json"), manifest).unwrap();
    let run = |fault: &str, arguments: &[&str]| {
        command(dir.path(), arguments)
            .env("VK_LAYER_PATH", dir.path())
            .env("VK_INSTANCE_LAYERS", "VK_LAYER_SPLITSUM_old_driver")
            .env("SPLITSUM_TEST_DRIVER", fault)
            .output()
            .unwrap()
    };
    for (fault, lacks) in [
        ("1.2", "lacks Vulkan 1.3 (it offers 1.2.0)"),
        ("no-synchronization2", "lacks synchronization2"),
    ] {
        assert_ends(
            &run(fault, &RENDER),
            2,
            &["device '", lacks, "which splitsum needs"],
        );
        let arguments = ["run", "tiny.toml", "--out", "out"];
        assert_ends(&run(fault, &arguments), 2, &[lacks]);
        assert!(!dir.path().join("out").exists() && !dir.path().join("x.exr").exists());
    }
    // The layer alone removes nothing.
    assert!(run("", &RENDER).status.success());
}

const LIMITS: &str = "SPLITSUM_TEST_LIMITS";

/// Renders a picture under a limit; an empty limit is none.
fn limited(dir: &Path, limit: &str, out: &str, flags: &str) -> Output {
    let arguments: Vec<&str> = flags.split_whitespace().chain(["--out", out]).collect();
    command(dir, &arguments)
        .env(LIMITS, limit)
        .output()
        .unwrap()
}

/// The relMSE between two pictures, to the digits that `compare` prints.
fn relmse(dir: &Path, picture: &str, reference: &str) -> f64 {
    let table = ok(dir, &["compare", picture, reference]);
    let row = table.lines().find(|line| line.contains(" relmse "));
    row.and_then(|row| row.split('|').nth(2)?.trim().parse().ok())
        .unwrap_or_else(|| panic!("{table}"))
}

/// The limits that shaders emulate. A sphere is drawn without the vertices of a mesh, so that their
/// grid moves nothing here.
const SHADER_LIMITS: [&str; 7] = [
    "texel-weights",
    "texel-weights-down",
    "level-fractions",
    "cube-seams",
    "cube-corners",
    "half-lookups",
    "elementary",
];

#[test]
fn each_emulated_limit_moves_a_picture_a_little_and_unknown_ones_are_refused() {
    let Some(dir) = folder() else { return };
    let flags = "render --size 32x32 --method split-sum --alpha 0.25";
    let render = |limit: &str| limited(dir.path(), limit, &format!("limit-{limit}.exr"), flags);
    assert_ends(&render("texel-wights"), 2, &[LIMITS, "texel-weights"]);
    assert!(render("").status.success());
    for limit in SHADER_LIMITS {
        assert!(render(limit).status.success(), "{limit}");
        let moved = relmse(dir.path(), &format!("limit-{limit}.exr"), "limit-.exr");
        assert!(0.0 < moved && moved < 1e-8, "{limit}: {moved}");
    }
}

/// Weights of texels and of levels add up to one under every limit.
#[test]
fn constant_light_stays_constant_under_every_limit() {
    let Some(dir) = folder() else { return };
    let flags = "render --size 32x32 --method split-sum --alpha 0.8 --environment builtin:constant";
    assert!(limited(dir.path(), "", "plain.exr", flags).status.success());
    for limit in SHADER_LIMITS {
        let out = format!("{limit}.exr");
        assert!(limited(dir.path(), limit, &out, flags).status.success());
        // The DFG table holds no halves: rounding its lookups moves every value by up to 2^-11.
        let most = if limit == "half-lookups" { 1e-6 } else { 1e-10 };
        let moved = relmse(dir.path(), &out, "plain.exr");
        assert!(moved < most, "{limit}: {moved}");
    }
}

/// Vulkan leaves the contents of new memory undefined; a software driver's are mostly 0.
#[test]
fn no_picture_shows_memory_that_nobody_wrote() {
    let Some(dir) = folder() else { return };
    for method in [
        "split-sum --diffuse irradiance-map",
        "split-sum-two --diffuse sh9",
        "sampled --samples 8",
        "reference --samples 64",
    ] {
        let flags = format!("render --size 32x32 --alpha 0.25 --method {method}");
        let pictures = ["", "undefined-memory"].map(|limit| {
            let out = format!("memory-{limit}.exr");
            let ended = limited(dir.path(), limit, &out, &flags);
            assert!(ended.status.success(), "{method}: {ended:?}");
            out
        });
        let moved = relmse(dir.path(), &pictures[1], &pictures[0]);
        assert!(moved == 0.0, "{method}: {moved}");
    }
}

/// The sums of a reference are eight times as large as its image: a device whose storage buffers
/// hold the image shows its shaders the sums in parts.
#[test]
fn a_reference_needs_no_buffer_larger_than_its_image() {
    let Some(dir) = folder() else { return };
    let flags = "render --alpha 0.25 --method reference --samples 64 --size";
    // Sums of 4.5 MiB and an image of 0.6.
    let pictures = ["", "small-buffers"].map(|limit| {
        let out = format!("parts-{limit}.exr");
        let ended = limited(dir.path(), limit, &out, &format!("{flags} 191x193"));
        assert!(ended.status.success(), "{ended:?}");
        out
    });
    assert_eq!(relmse(dir.path(), &pictures[1], &pictures[0]), 0.0);
    let large = limited(
        dir.path(),
        "small-buffers",
        "x.exr",
        &format!("{flags} 1024x512"),
    );
    assert_ends(&large, 2, &["needs a buffer of 8 MiB", "4 MiB"]);
}

/// What a GPU's filter does to the gain of two lookups over one: within a twentieth, as published
/// ratios are compared. Open seams are left out: Vulkan asks for closed ones.
#[test]
fn the_gain_of_two_lookups_holds_under_the_limits_of_filters() {
    let Some(dir) = folder() else { return };
    let flags = |method: &str| {
        format!(
            "render --size 48x48 --environment builtin:studio --diffuse none --metallic 1 --albedo 1 \
             --alpha 0.25 --method {method}"
        )
    };
    let reference = limited(
        dir.path(),
        "",
        "truth.exr",
        &flags("reference --samples 1024"),
    );
    assert!(reference.status.success(), "{reference:?}");
    let ratio = |limit: &str| {
        let [one, two] = ["split-sum", "split-sum-two"].map(|method| {
            let out = format!("{method}-{limit}.exr");
            let ended = limited(dir.path(), limit, &out, &flags(method));
            assert!(ended.status.success(), "{limit}: {ended:?}");
            relmse(dir.path(), &out, "truth.exr")
        });
        two / one
    };
    let exact = ratio("");
    assert!(exact < 0.9, "no gain to keep: {exact}");
    for limit in SHADER_LIMITS
        .into_iter()
        .filter(|limit| *limit != "cube-seams")
    {
        let limited = ratio(limit);
        println!("{limit}: {limited} for {exact}");
        assert!(
            (limited / exact - 1.0).abs() < 0.05,
            "{limit}: {limited} for {exact}"
        );
    }
}

/// With square roots as coarse as Vulkan allows, the DFG table had texels that were not numbers
/// beside grazing views, which every table lookup there returned.
#[test]
fn coarse_square_roots_leave_no_hole_in_the_dfg_table() {
    let Some(dir) = folder() else { return };
    let flags = "render --scene design --environment builtin:constant --size 64x64 --diffuse none \
                 --metallic 1 --albedo 1 --alpha 0.4 --method split-sum --out coarse.exr";
    let arguments: Vec<&str> = flags.split_whitespace().collect();
    let rendered = command(dir.path(), &arguments)
        .env(LIMITS, "elementary")
        .output()
        .unwrap();
    assert!(rendered.status.success(), "{rendered:?}");
}
