//! Bad input ends with one clear message, the documented exit code and no output. No test needs a
//! device.

use super::cases::Cases;
use super::{
    assert_ends, assert_refusals, command, golden, published, refusal, splitsum, stderr, stdout,
};
use splitsum::base::pixels::{GrayImage, RgbImage, exr};
use std::path::Path;
use std::process::Command;

pub(super) fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    files
        .iter()
        .for_each(|(name, text)| std::fs::write(dir.path().join(name), text).unwrap());
    dir
}

/// All cases run in one folder, which has the files of every case.
#[test]
fn wrong_commands_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let write = |name: &str, size: [u32; 2], color: f32, alpha: f32| {
        let rgb = RgbImage::filled(size[0], size[1], [color; 3]);
        let alpha = GrayImage::filled(size[0], size[1], alpha);
        exr::write_rgba(&dir.path().join(name), &rgb, &alpha, &[]).unwrap();
    };
    write("a.exr", [4, 2], 1.0, 0.5);
    write("m.exr", [4, 2], 0.25, 1.0);
    write("x.exr", [16, 8], 1.0, 1.0);
    write("large.exr", [8192, 1025], 0.5, 1.0);
    for name in ["folder.exr", "empty"] {
        std::fs::create_dir(dir.path().join(name)).unwrap();
    }
    let map = "env_analytic.exr";
    std::fs::copy(golden().join(map), dir.path().join(map)).unwrap();
    published(dir.path(), "run");
    std::fs::write(published(dir.path(), "emptied").join("errors.csv"), "").unwrap();
    let groups = Cases::folder("refused");
    for group in &groups {
        group.unpack(dir.path());
    }
    let mut failures = Vec::new();
    for group in groups {
        failures.extend(group.check(
            |command| refusal(dir.path(), command),
            |found, kept| (found != kept).then(|| format!("found:\n{found}\nkept:\n{kept}")),
        ));
    }
    assert!(failures.is_empty(), "{}", failures.join("\n\n"));
}

/// Deep nesting of any kind ends in a message, not in a stack overflow.
#[test]
fn deep_nesting_is_a_fault() {
    const DEPTH: usize = 20_000;
    let dir = tempfile::tempdir().unwrap();
    let pairs = [("[", "]"), ("{a=", "}"), ("[{a=", "}]")];
    let values = pairs
        .map(|(open, close)| format!("alpha = {}1{}", open.repeat(DEPTH), close.repeat(DEPTH)));
    let unclosed = pairs.map(|(open, _)| format!("alpha = {}", open.repeat(DEPTH)));
    let keys = [
        format!("{}a = 1", "a.".repeat(DEPTH)),
        format!("[{}a]", "a.".repeat(DEPTH)),
    ];
    for line in values.into_iter().chain(unclosed).chain(keys) {
        std::fs::write(
            dir.path().join("e.toml"),
            format!("name = \"e\"\n[axes]\n{line}\n"),
        )
        .unwrap();
        let output = splitsum(dir.path(), &["plan", "e.toml"]);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{line:.40}: {message}");
        assert!(
            message.contains("nested deeper than 80 levels") || message.contains("is not closed"),
            "{message}"
        );
    }
}

#[test]
fn list_prints_every_name() {
    let dir = tempfile::tempdir().unwrap();
    use splitsum::instrument::precompute::prefilter;
    let text = stdout(&splitsum(dir.path(), &["list"]));
    let names = splitsum::experiment::axis::AXES
        .iter()
        .map(|axis| axis.name);
    let names = names.chain(
        splitsum::instrument::shade::METHODS
            .iter()
            .map(|method| method.name),
    );
    let names = names.chain(
        splitsum::base::math::sequence::SEQUENCES
            .iter()
            .map(|sequence| sequence.name),
    );
    let names = names.chain(
        prefilter::level_bias::LEVEL_BIASES
            .iter()
            .map(|bias| bias.name),
    );
    let names = names.chain(prefilter::LEVEL_MAPPINGS.iter().map(|mapping| mapping.name));
    let names = names.chain(prefilter::WEIGHTS.iter().map(|weight| weight.name));
    let names = names.chain(
        splitsum::instrument::metrics::METRICS
            .iter()
            .map(|metric| metric.name),
    );
    for name in names {
        assert!(text.contains(&format!("| {name} ")), "{name} is not listed");
    }
}

#[test]
fn every_experiment_of_the_project_has_a_plan() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("experiments");
    let elsewhere = tempfile::tempdir().unwrap();
    let mut count = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        // The plan needs no probe, so it opens no device.
        let mut command = command(
            elsewhere.path(),
            &["plan", path.to_str().unwrap(), "--json"],
        );
        command
            .env("VK_DRIVER_FILES", "/nonexistent")
            .env("VK_ICD_FILENAMES", "/nonexistent");
        let output = command.output().unwrap();
        assert!(
            output.status.success(),
            "{}: {}",
            path.display(),
            stderr(&output)
        );
        let plan: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let cells = plan["cells"].as_array().unwrap().len();
        match path.file_stem().unwrap().to_str().unwrap() {
            // The design has 5 sample counts and the split sum, for 2 lights, 3 models and 5
            // widths. The shader ball has 2 lights and 2 widths at 3 exposures and 2 contrasts.
            "quick" => assert_eq!(cells, (2 * 3 * 5 + 2 * 2 * 3 * 2) * 6),
            // 6 exposures and 2 further contrasts, each with 3 models, 2 methods at 4 sample
            // counts, the split sum and none.
            "source-document-0" => assert_eq!(cells, 8 * 3 * (2 * 4 + 2)),
            _ => assert!(cells > 0),
        }
        assert_eq!(
            plan["excluded"]
                .as_array()
                .unwrap()
                .iter()
                .filter(|e| e["count"] == 0)
                .count(),
            0
        );
        count += 1;
    }
    assert!(count >= 4);
}

#[test]
fn a_run_without_a_device_leaves_nothing_behind() {
    let dir = tempfile::tempdir().unwrap();
    let text = "name = \"x\"\nquestion = \"?\"\nsize = [8, 8]\n[axes]\nenvironment = \
                [\"builtin:constant\"]\nmethod = [\"split-sum\"]\n";
    std::fs::write(dir.path().join("x.toml"), text).unwrap();
    let mut blind = command(dir.path(), &["run", "x.toml", "--out", "out"]);
    blind
        .env("VK_DRIVER_FILES", "/nonexistent")
        .env("VK_ICD_FILENAMES", "/nonexistent");
    assert_ends(&blind.output().unwrap(), 2, &["Vulkan"]);
    assert!(!dir.path().join("out").exists());
}

/// A device or a pipe never ends, or never begins.
#[cfg(unix)]
#[test]
fn files_that_are_not_regular_are_refused_at_once() {
    let dir = tempfile::tempdir().unwrap();
    let made = Command::new("mkfifo").arg(dir.path().join("pipe")).status();
    assert!(made.is_ok_and(|status| status.success()), "mkfifo");
    let commands = [
        "plan pipe",
        "run pipe",
        "integrate pipe",
        "compare pipe pipe",
        "plan /dev/zero",
        "integrate /dev/zero",
    ];
    assert_refusals("files_that_are_not_regular", dir.path(), &commands);
    // A pipe opened by the shell is read.
    let script =
        "printf 'brdf,alpha,n_dot_v\\nggx,0.5,0.5\\n' | \"$0\" integrate /dev/stdin --kind dfg";
    let output = Command::new("sh")
        .args(["-c", script, env!("CARGO_BIN_EXE_splitsum")])
        .output()
        .unwrap();
    assert!(
        output.status.success() && stdout(&output).contains("ggx,0.5,0.5,0.67"),
        "{}",
        stderr(&output)
    );
}

/// A process without enough memory for a map reports it and is not aborted.
#[cfg(target_os = "linux")]
#[test]
fn a_failed_allocation_is_reported() {
    let dir = tempfile::tempdir().unwrap();
    // 8192 x 4096 texels by runs, 48 kB: 384 MiB as floats.
    let row = [0x80, 0x80, 0x80, 0x81, 1, 1, 1, 0xff, 1, 1, 1, 0x1f];
    let header = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4096 +X 8192\n";
    std::fs::write(
        dir.path().join("large.hdr"),
        [&header[..], &row.repeat(4096)].concat(),
    )
    .unwrap();
    let script = "ulimit -v 400000; exec \"$0\" render --environment large.hdr --out x.png";
    let mut command = Command::new("sh");
    command
        .current_dir(dir.path())
        .args(["-c", script, env!("CARGO_BIN_EXE_splitsum")]);
    let output = command.output().unwrap();
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(
        message.contains("large.hdr: not enough memory for its 33554432 pixels (384 MiB)"),
        "{message}"
    );
}
