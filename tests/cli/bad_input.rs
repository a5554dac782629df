//! Bad input ends with one clear message, the promised exit code and no output. None of it needs a device.

use super::{assert_ends, command, entries, splitsum, stderr, stdout};
use splitsum::pixels::{GrayImage, RgbImage, exr};
use std::process::Command;

/// Runs in an empty folder and checks the exit code, parts of the message, and that nothing was written.
fn assert_refused(arguments: &[&str], code: i32, parts: &[&str]) {
    let dir = tempfile::tempdir().unwrap();
    let output = splitsum(dir.path(), arguments);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {message}");
    for part in parts {
        assert!(message.contains(part), "{arguments:?}: no {part:?} in {message:?}");
    }
    assert!(entries(dir.path()).is_empty(), "{arguments:?} left {:?}", entries(dir.path()));
}

#[test]
fn a_wrong_value_names_flag_value_and_expectation() {
    assert_refused(&["render", "--alpha", "1.4", "--out", "x.png"], 2, &["--alpha", "1.4 is outside (0, 1]"]);
    // It would be shaded as 0.001 and labelled 0.0005.
    assert_refused(&["render", "--alpha", "0.0005", "--out", "x.png"], 2, &["--alpha", "0.0005 is below 0.001"]);
    assert_refused(&["render", "--size", "256x", "--out", "x.png"], 2, &["--size", "\"256x\" is not WxH"]);
    assert_refused(&["render", "--f0", "1,2", "--out", "x.png"], 2, &["--f0", "[1, 2] is not a colour"]);
    assert_refused(&["render", "--ior", "0.5", "--out", "x.png"], 2, &["--ior", "0.5 is outside [1, 10]"]);
    assert_refused(
        &["render", "--samples", "many", "--out", "x.png"],
        2,
        &["--samples", "\"many\" is not a whole number"],
    );
    assert_refused(
        &["render", "--light", "spot:0,0,1:1,1,1", "--out", "x.png"],
        2,
        &["--light", "is not a kind of light; expected one of directional, point"],
    );
    assert_refused(
        &["render", "--light", "directional:0,0,0:1,1,1", "--out", "x.png"],
        2,
        &["direction must not be zero"],
    );
}

/// A flag that would change nothing is a misunderstanding, and so is a count that the reference would round.
#[test]
fn a_flag_without_effect_is_refused() {
    let render = |flags: &[&str], parts: &[&str]| assert_refused(&[&["render"], flags].concat(), 2, parts);
    render(
        &["--method", "split-sum", "--samples", "40", "--lod-bias", "1", "--exposure", "2", "--out", "x.exr"],
        &[
            "--samples: has no effect with method split-sum and diffuse sh9",
            "--lod-bias: has no effect",
            "--exposure: has no effect on an .exr",
        ],
    );
    render(&["--relative-error", "0.1", "--out", "x.exr"], &["--relative-error: has no effect: method sampled"]);
    let counts = "44 samples a pixel";
    render(
        &["--method", "reference", "--samples", "44", "--out", "x.exr"],
        &["--samples: ", counts, "expected 40 or 48"],
    );
    let diffuse = ["--method", "split-sum", "--diffuse", "reference", "--samples", "44", "--out", "x.exr"];
    render(&diffuse, &["--samples: ", counts, "expected 40 or 48"]);
}

/// A minus must not turn a value into an unknown flag.
#[test]
fn a_negative_value_is_a_value() {
    let out_of_range = |command: &[&str], flag: &str, range: &str| {
        let arguments = [command, &[flag, "-1", "--out", "x.png"]].concat();
        assert_refused(&arguments, 2, &[flag, &format!("-1 is outside {range}")]);
    };
    out_of_range(&["render"], "--alpha", "(0, 1]");
    out_of_range(&["render"], "--samples", "[1, ");
    out_of_range(&["render"], "--metallic", "[0, 1]");
    assert_refused(
        &["compare", "a.exr", "b.exr", "--environment-mean", "0"],
        2,
        &["--environment-mean", "0 is outside (0, "],
    );
    assert_refused(&["compare", "a.exr", "b.exr", "--exposure", "-1"], 2, &["--exposure", "-1 is outside (0, "]);
    assert_refused(&["run", "e.toml", "--device", "-1"], 2, &["--device", "\"-1\": "]);
    assert_refused(&["bake", "builtin:sky", "--out", "baked", "--device", "-1"], 2, &["--device", "\"-1\": "]);
}

/// The value alone does not say which of three files holds it.
#[test]
fn compare_names_the_mask() {
    let dir = tempfile::tempdir().unwrap();
    let write = |name: &str, color: f32, alpha: f32| {
        let (rgb, alpha) = (RgbImage::filled(4, 2, [color; 3]), GrayImage::filled(4, 2, alpha));
        exr::write_rgba(&dir.path().join(name), &rgb, &alpha, &[]).unwrap();
    };
    write("a.exr", 1.0, 0.5);
    write("m.exr", 0.25, 1.0);
    let message = |arguments: &[&str]| {
        let output = splitsum(dir.path(), &[&["compare", "a.exr", "a.exr"], arguments].concat());
        assert_eq!(output.status.code(), Some(2));
        stderr(&output)
    };
    let by_alpha = message(&[]);
    assert!(by_alpha.contains("masked by the alpha channel of a.exr: the mask has value 0.5"), "{by_alpha}");
    let by_file = message(&["--mask", "m.exr"]);
    assert!(by_file.contains("masked by --mask m.exr: the mask has value 0.25"), "{by_file}");
}

#[test]
fn an_unknown_name_brings_the_nearest_one() {
    assert_refused(&["render", "--method", "splitsum", "--out", "x.png"], 2, &["did you mean \"split-sum\"?"]);
    assert_refused(&["render", "--brdf", "beckman", "--out", "x.png"], 2, &["did you mean \"beckmann\"?"]);
    assert_refused(&["render", "--environment", "builtin:ski", "--out", "x.png"], 2, &["sky"]);
    assert_refused(&["render", "--scene", "sphear", "--out", "x.png"], 2, &["sphere"]);
    assert_refused(&["rendr"], 2, &["render"]);
    assert_refused(&["list", "metrix"], 2, &["metrics"]);
}

#[test]
fn inputs_that_are_missing_are_all_named_at_once() {
    let arguments = ["render", "--environment", "no.hdr", "--scene", "no.obj", "--out", "x.png"];
    assert_refused(&arguments, 2, &["no.hdr", "no.obj"]);
    assert_refused(&["compare", "a.exr", "b.exr"], 2, &["a.exr"]);
    assert_refused(&["run", "no.toml"], 2, &["no.toml", "expected an experiment file"]);
}

#[test]
fn a_file_in_the_place_of_a_folder_is_told() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("errors.csv"), "").unwrap();
    let published = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("results/timing");
    let published = published.to_str().unwrap();
    for (arguments, what) in [
        (vec!["answers", "errors.csv"], "expected the folder of a run"),
        (vec!["report", "errors.csv"], "expected the folder of a run"),
        (vec!["answers", published, "--publish", "errors.csv"], "expected a folder of published runs"),
    ] {
        let output = splitsum(dir.path(), &arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", stderr(&output));
        let message = stderr(&output);
        assert!(message.starts_with("errors.csv: is a file; ") && message.contains(what), "{arguments:?}: {message}");
        assert_eq!(message.trim().lines().count(), 1, "{message}");
    }
}

#[test]
fn settings_that_do_not_go_together_are_refused() {
    let message = &["--set: prefilter_level_count is 9, but a prefilter_size of 128x128", "at most 6 levels"];
    assert_refused(&["bake", "builtin:sky", "--out", "baked", "--set", "prefilter_level_count=9"], 2, message);
}

#[test]
fn the_output_is_checked_before_work() {
    assert_refused(&["render", "--out", "x.jpg"], 2, &["x.jpg ends in neither .exr nor .png"]);
    assert_refused(&["render", "--out", "no/x.png"], 2, &["there is no folder no"]);
    // A folder that takes no files even from root, and a folder in the place of the file.
    #[cfg(target_os = "linux")]
    assert_refused(&["render", "--out", "/proc/x.png"], 2, &["--out", "cannot write to the folder /proc"]);
    let dir = tempfile::tempdir().unwrap();
    std::fs::create_dir(dir.path().join("x.exr")).unwrap();
    assert_ends(
        &splitsum(dir.path(), &["render", "--out", "x.exr"]),
        2,
        &["--out: x.exr is a folder; expected a file"],
    );
}

#[test]
fn an_experiment_with_faults_lists_them_with_places() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("e.toml"), "name = \"e\"\n[axes]\nalpha = [0.5, 1.4]\nbrdv = [\"ggx\"]\n").unwrap();
    for command in ["run", "plan"] {
        let output = splitsum(dir.path(), &[command, "e.toml"]);
        assert_eq!(output.status.code(), Some(2));
        let message = stderr(&output);
        assert!(message.contains("e.toml:3:15: axes.alpha: 1.4 is outside (0, 1]"), "{message}");
        assert!(message.contains("e.toml:4:1: axes.brdv is unknown; did you mean \"brdf\"?"), "{message}");
        assert_eq!(entries(dir.path()), ["e.toml"]);
    }
}

/// Deep nesting of any kind ends in a message, not in an overflow of the stack.
#[test]
fn deep_nesting_is_a_fault() {
    const DEPTH: usize = 20_000;
    let dir = tempfile::tempdir().unwrap();
    let pairs = [("[", "]"), ("{a=", "}"), ("[{a=", "}]")];
    let values = pairs.map(|(open, close)| format!("alpha = {}1{}", open.repeat(DEPTH), close.repeat(DEPTH)));
    let unclosed = pairs.map(|(open, _)| format!("alpha = {}", open.repeat(DEPTH)));
    let keys = [format!("{}a = 1", "a.".repeat(DEPTH)), format!("[{}a]", "a.".repeat(DEPTH))];
    for line in values.into_iter().chain(unclosed).chain(keys) {
        std::fs::write(dir.path().join("e.toml"), format!("name = \"e\"\n[axes]\n{line}\n")).unwrap();
        let output = splitsum(dir.path(), &["plan", "e.toml"]);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{line:.40}: {message}");
        assert!(message.contains("nested deeper than 80 levels") || message.contains("is not closed"), "{message}");
    }
}

/// Values that do not go together do not hide a question that cannot be answered.
#[test]
fn what_is_asked_and_what_is_set_are_judged_together() {
    let dir = tempfile::tempdir().unwrap();
    let text = "name = \"x\"\nasks = [\"tables\"]\nreference = { method = \"reference\", samples = 64 }\n[axes]\nalpha = [0.5]\nmethod = [\"reference\"]\nsamples = [7]\n";
    std::fs::write(dir.path().join("x.toml"), text).unwrap();
    let parts = ["x.toml:2:9: asks: \"tables\" cannot be answered", "x.toml:7:12: samples of method reference"];
    assert_ends(&splitsum(dir.path(), &["plan", "x.toml"]), 2, &parts);
}

#[test]
fn an_empty_plan_has_its_own_exit_code() {
    let dir = tempfile::tempdir().unwrap();
    let text = "name = \"e\"\n[axes]\nalpha = [0.5]\n[[exclude]]\nalpha = 0.5\nwhy = \"nothing is left\"\n";
    std::fs::write(dir.path().join("e.toml"), text).unwrap();
    for command in ["run", "plan"] {
        let output = splitsum(dir.path(), &[command, "e.toml"]);
        assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
        assert_eq!(entries(dir.path()), ["e.toml"]);
    }
}

#[test]
fn commands_that_are_not_built_say_so() {
    #[cfg(not(feature = "view"))]
    assert_refused(&["view", "x"], 2, &["splitsum view: built without", "--features view"]);
}

#[test]
fn list_prints_every_name() {
    let dir = tempfile::tempdir().unwrap();
    use splitsum::precompute::prefilter;
    let text = stdout(&splitsum(dir.path(), &["list"]));
    let names = splitsum::experiment::axis::AXES.iter().map(|axis| axis.name);
    let names = names.chain(splitsum::shade::METHODS.iter().map(|method| method.name));
    let names = names.chain(splitsum::math::sequence::SEQUENCES.iter().map(|sequence| sequence.name));
    let names = names.chain(prefilter::level_bias::LEVEL_BIASES.iter().map(|bias| bias.name));
    let names = names.chain(prefilter::LEVEL_MAPPINGS.iter().map(|mapping| mapping.name));
    let names = names.chain(prefilter::WEIGHTS.iter().map(|weight| weight.name));
    let names = names.chain(splitsum::metrics::METRICS.iter().map(|metric| metric.name));
    for name in names {
        assert!(text.contains(&format!("| {name} ")), "{name} is not listed");
    }
}

#[test]
fn images_that_are_too_large_to_compare_are_refused_with_the_figure() {
    let dir = tempfile::tempdir().unwrap();
    let channels = ["R", "G", "B"].map(|name| (name.to_owned(), splitsum::pixels::GrayImage::filled(8192, 1025, 0.5)));
    splitsum::pixels::exr::write_channels(&dir.path().join("x.exr"), channels.to_vec()).unwrap();
    let output = splitsum(dir.path(), &["compare", "x.exr", "x.exr"]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    let message = stderr(&output);
    assert!(message.contains("x.exr: 8192x1025 pixels need 1441 MiB of memory"), "{message}");
}

#[test]
fn every_experiment_of_the_project_has_a_plan() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("experiments");
    let elsewhere = tempfile::tempdir().unwrap();
    let mut count = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        // What is asked here needs no probe, so the plan sees no device.
        let mut command = command(elsewhere.path(), &["plan", path.to_str().unwrap(), "--json"]);
        command.env("VK_DRIVER_FILES", "/nonexistent").env("VK_ICD_FILENAMES", "/nonexistent");
        let output = command.output().unwrap();
        assert!(output.status.success(), "{}: {}", path.display(), stderr(&output));
        let plan: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let cells = plan["cells"].as_array().unwrap().len();
        match path.file_stem().unwrap().to_str().unwrap() {
            // 5 sample counts and the split sum; of the design 2 lights, 3 models and 5 widths, of the shader ball 2 lights and
            // 2 widths at 3 exposures and 2 contrasts.
            "quick" => assert_eq!(cells, (2 * 3 * 5 + 2 * 2 * 3 * 2) * 6),
            // 6 exposures and 2 further contrasts, each with 3 models of 2 methods at 4 sample counts, the split sum and none.
            "source-document-0" => assert_eq!(cells, 8 * 3 * (2 * 4 + 2)),
            _ => assert!(cells > 0),
        }
        assert_eq!(plan["excluded"].as_array().unwrap().iter().filter(|e| e["count"] == 0).count(), 0);
        count += 1;
    }
    assert!(count >= 4);
}

#[test]
fn a_run_without_a_device_leaves_nothing_behind() {
    let dir = tempfile::tempdir().unwrap();
    let text = "name = \"x\"\nquestion = \"?\"\nsize = [8, 8]\n[axes]\nenvironment = [\"builtin:constant\"]\nmethod = [\"split-sum\"]\n";
    std::fs::write(dir.path().join("x.toml"), text).unwrap();
    let mut blind = command(dir.path(), &["run", "x.toml", "--out", "out"]);
    blind.env("VK_DRIVER_FILES", "/nonexistent").env("VK_ICD_FILENAMES", "/nonexistent");
    assert_ends(&blind.output().unwrap(), 2, &["Vulkan"]);
    assert!(!dir.path().join("out").exists());

    std::fs::write(dir.path().join("file"), "").unwrap();
    assert_ends(&splitsum(dir.path(), &["run", "x.toml", "--out", "file"]), 2, &["file: is a file; expected a folder"]);
}

#[test]
fn answers_of_a_run_whose_table_was_emptied_are_refused_and_stay() {
    let dir = tempfile::tempdir().unwrap();
    let published = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("results/timing");
    for name in ["provenance.json", "experiment.toml", "errors.csv", "environments.csv", "summary.md"] {
        std::fs::copy(published.join(name), dir.path().join(name)).unwrap();
    }
    let answers = || splitsum(dir.path(), &["answers", "."]);
    assert_eq!(answers().status.code(), Some(0));
    let summary = std::fs::read(dir.path().join("summary.md")).unwrap();
    std::fs::write(dir.path().join("errors.csv"), "").unwrap();
    let output = answers();
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("./errors.csv: the file is empty"), "{}", stderr(&output));
    assert_eq!(stderr(&output).trim().lines().count(), 1, "{}", stderr(&output));
    assert_eq!(std::fs::read(dir.path().join("summary.md")).unwrap(), summary);
}

/// Devices and pipes in the place of files never end, or never begin.
#[cfg(unix)]
#[test]
fn what_is_no_regular_file_is_refused_at_once() {
    let dir = tempfile::tempdir().unwrap();
    let made = Command::new("mkfifo").arg(dir.path().join("pipe")).status();
    assert!(made.is_ok_and(|status| status.success()), "mkfifo");
    for path in ["pipe", "/dev/zero"] {
        for arguments in [&["plan", path][..], &["run", path], &["integrate", path], &["compare", path, path]] {
            let output = splitsum(dir.path(), arguments);
            let message = stderr(&output);
            assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
            assert!(message.contains(path) && message.contains("not a regular file"), "{arguments:?}: {message}");
        }
    }
    // What the shell opened is read.
    let script = "printf 'brdf,alpha,n_dot_v\\nggx,0.5,0.5\\n' | \"$0\" integrate /dev/stdin --kind dfg";
    let output = Command::new("sh").args(["-c", script, env!("CARGO_BIN_EXE_splitsum")]).output().unwrap();
    assert!(output.status.success() && stdout(&output).contains("ggx,0.5,0.5,0.67"), "{}", stderr(&output));
}

/// A process that may not have the memory of a map says so; it is not aborted.
#[cfg(target_os = "linux")]
#[test]
fn memory_that_is_not_to_be_had_is_told() {
    let dir = tempfile::tempdir().unwrap();
    // 8192 x 4096 texels by runs, 48 kB: 384 MiB as floats.
    let row = [0x80, 0x80, 0x80, 0x81, 1, 1, 1, 0xff, 1, 1, 1, 0x1f];
    let header = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4096 +X 8192\n";
    std::fs::write(dir.path().join("large.hdr"), [&header[..], &row.repeat(4096)].concat()).unwrap();
    let script = "ulimit -v 400000; exec \"$0\" render --environment large.hdr --out x.png";
    let mut command = Command::new("sh");
    command.current_dir(dir.path()).args(["-c", script, env!("CARGO_BIN_EXE_splitsum")]);
    let output = command.output().unwrap();
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("large.hdr: not enough memory for its 33554432 pixels (384 MiB)"), "{message}");
}

/// A method in a file that does not compile, or is not there: its line, before anything is rendered.
#[test]
fn a_faulty_method_names_its_line() {
    let dir = tempfile::tempdir().unwrap();
    let cases = [
        (
            "vec3 specular_radiance(Surface s) {\n    return nothing;\n}\n",
            "my.glsl:2: 'nothing' : undeclared identifier",
        ),
        ("#include \"lib/no_such.glsl\"\n", "my.glsl:1: there is no lib/no_such.glsl to include"),
        ("vec3 reflected(Surface s) { return s.f0; }\n", "'specular_radiance' : no matching overloaded function found"),
    ];
    let experiment = "name = \"x\"\n[axes]\nmethod = [\"split-sum\", \"file:my.glsl\"]\n";
    std::fs::write(dir.path().join("e.toml"), experiment).unwrap();
    for (text, message) in cases {
        std::fs::write(dir.path().join("my.glsl"), text).unwrap();
        assert_ends(&splitsum(dir.path(), &["render", "--method-shader", "my.glsl", "--out", "x.exr"]), 2, &[message]);
        assert_ends(&splitsum(dir.path(), &["plan", "e.toml"]), 2, &["e.toml:3:", message]);
    }
    std::fs::remove_file(dir.path().join("my.glsl")).unwrap();
    assert_ends(&splitsum(dir.path(), &["plan", "e.toml"]), 2, &["e.toml:3:", "my.glsl: "]);
}
