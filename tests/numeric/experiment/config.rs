//! Every fault of a file is reported at once, with its place and the nearest right name.

use splitsum::brdf::MODELS;
use splitsum::experiment::Plan;
use std::path::Path;

/// The faults of `text` as the file `e.toml`, one a line.
pub fn faults(text: &str, overrides: &[&str]) -> Vec<String> {
    let overrides: Vec<String> = overrides.iter().map(|o| o.to_string()).collect();
    match Plan::from_text(Path::new("e.toml"), text, &overrides) {
        Ok(_) => Vec::new(),
        Err(error) => error.to_string().lines().map(str::to_owned).collect(),
    }
}

/// `found` must hold the `expected` beginnings, in this order and no more.
pub fn assert_faults(found: &[String], expected: &[&str]) {
    assert_eq!(found.len(), expected.len(), "{found:#?}");
    for (found, expected) in found.iter().zip(expected) {
        assert!(found.starts_with(expected), "found {found:?}, expected {expected:?}");
    }
}

#[test]
fn many_faults_are_reported_in_one_go_with_line_and_column() {
    let models = MODELS.iter().map(|model| model.name()).collect::<Vec<_>>().join(", ");
    let text = r#"name = "x y"
colour = 1
size = [256]
seed = "one"
background = 1
camera = "orto"
scene = "spheers"
reference = { method = "referense", samples = 0, seed = 3 }
[axes]
environment = ["builtin:sky", "missing.hdr"]
brdf = ["gxx"]
method = []
alpha = [0.5, 1.4, 0, "rough"]
samples = [1, 2.5, 1]
rougness = [0.1]
contrast = 1
[[exclude]]
method = "splitsum"
[timing]
round = 3
rounds = 0
[precompute]
dfg_siz = 4
[[lights]]
kind = "directional"
position = [0, 1, 0]
"#;
    assert_faults(
        &faults(text, &[]),
        &[
            "e.toml:1:8: name: \"x y\" is not a name",
            "e.toml:2:1: colour is unknown",
            "e.toml:3:8: size: [256] is not a pair of whole numbers in [1, 16384]",
            "e.toml:4:8: seed: \"one\" is not a whole number",
            "e.toml:5:14: background: 1 is not true or false",
            "e.toml:6:10: camera: \"orto\" is not a camera; did you mean \"ortho\"?; expected one of ortho, perspective",
            "e.toml:7:9: scene \"spheers\"",
            "e.toml:8:24: reference.method: \"referense\" is not a method; did you mean \"reference\"?",
            "e.toml:8:47: reference.samples: 0 is outside [1, 16777216]",
            "e.toml:8:50: reference.seed is unknown",
            "e.toml:10:31: environment missing.hdr: no such file",
            &format!(
                "e.toml:11:9: axes.brdf: \"gxx\" is not a BRDF model; did you mean \"ggx\"?; expected one of {models}"
            ),
            "e.toml:12:10: axes.method: an axis needs at least one value",
            "e.toml:13:15: axes.alpha: 1.4 is outside (0, 1]",
            "e.toml:13:20: axes.alpha: 0 is outside (0, 1]",
            "e.toml:13:23: axes.alpha: \"rough\" is not a number in (0, 1]",
            "e.toml:14:15: axes.samples: 2.5 is not a whole number in [1, 16777216]",
            "e.toml:14:20: axes.samples: 1 is listed twice",
            "e.toml:15:1: axes.rougness is unknown",
            "e.toml:16:12: axes.contrast: 1 is not a list of values",
            "e.toml:17:1: exclude.why is missing",
            "e.toml:18:10: exclude.method: \"splitsum\" is not a method; did you mean \"split-sum\"?",
            "e.toml:20:1: timing.round is unknown; did you mean \"rounds\"?",
            "e.toml:21:10: timing.rounds: 0 is outside [1, 100000]",
            "e.toml:23:1: precompute.dfg_siz is unknown; did you mean \"dfg_size\"?",
            "e.toml:24:1: lights: needs kind = \"directional\" with direction",
        ],
    );
}

#[test]
fn columns_count_characters_not_bytes() {
    let text = "name = \"x\"\n[axes]\nf0 = [[0.5, 0.5, 0.5], \"é\", 1.5]\n";
    assert_faults(
        &faults(text, &[]),
        &["e.toml:3:24: axes.f0: \"é\" is not a colour", "e.toml:3:29: axes.f0: 1.5 is outside"],
    );
}

#[test]
fn a_parameter_is_fixed_or_swept_but_not_both_and_some_keys_must_be() {
    assert_faults(&faults("question = \"?\"\n", &[]), &["e.toml:1:1: axes is missing", "e.toml:1:1: name is missing"]);
    let text =
        "name = \"x\"\nscene = \"sphere\"\n[precompute]\ndfg_size = 8\n[axes]\ndfg_size = [8]\nscene = [\"sphere\"]\n";
    assert_faults(
        &faults(text, &[]),
        &["e.toml:2:1: scene is also an axis", "e.toml:4:1: precompute.dfg_size is also"],
    );
}

#[test]
fn an_orientation_is_one_of_the_set() {
    let text = "name = \"x\"\n[axes]\nenvironment_orientation = [0, 4095, 4096, -1, 1.5]\n";
    assert_faults(
        &faults(text, &[]),
        &[
            "e.toml:3:37: axes.environment_orientation: 4096 is outside [0, 4095]",
            "e.toml:3:43: axes.environment_orientation: -1 is outside [0, 4095]",
            "e.toml:3:47: axes.environment_orientation: 1.5 is not a whole number in [0, 4095]",
        ],
    );
}

#[test]
fn numbers_that_are_not_finite_are_outside_every_range() {
    let text = "name = \"x\"\n[axes]\nalpha = [nan]\nexposure = [inf]\nenvironment_scale = [-inf]\n";
    assert_faults(
        &faults(text, &[]),
        &[
            "e.toml:3:10: axes.alpha: nan is outside",
            "e.toml:4:13: axes.exposure: inf",
            "e.toml:5:22: axes.environment_scale: -inf",
        ],
    );
}

#[test]
fn overrides_replace_an_axis_and_are_checked_like_the_file() {
    let text = "name = \"x\"\n[axes]\nalpha = [0.1, 0.2]\n";
    assert_faults(
        &faults(text, &["alpha=2", "alfa=1", "nonsense", "samples=4,4", "brdf=ggx", "brdf=phong"]),
        &[
            "--set alfa: axes.alfa is unknown; did you mean \"alpha\"?",
            "--set alpha: axes.alpha: 2 is outside (0, 1]",
            "--set brdf: is set twice; give all values at once: --set brdf=v1,v2",
            "--set nonsense: is not axis=value",
            "--set samples: axes.samples: 4 is listed twice",
        ],
    );
    let plan = Plan::from_text(Path::new("e.toml"), text, &["alpha=0.5".into(), "f0=0.04,1:0.5:0".into()]).unwrap();
    let points: Vec<String> =
        plan.cells.iter().map(|c| format!("{} {}", c.point.get("alpha"), c.point.get("f0"))).collect();
    assert_eq!(points, ["0.5 0.04", "0.5 1:0.5:0"]);
}

#[test]
fn every_number_of_a_pair_or_colour_is_checked() {
    let text = "name = \"x\"\nsize = [0, 99999]\n[axes]\nf0 = [[2, 0.5, -1]]\n";
    assert_faults(
        &faults(text, &[]),
        &[
            "e.toml:2:8: size: 0 is outside [1, 16384]; 99999 is outside [1, 16384]",
            "e.toml:4:7: axes.f0: 2 is outside [0, 1]; -1 is outside [0, 1]",
        ],
    );
}

#[test]
fn level_biases_have_names_and_sequences_and_formats_are_checked() {
    let text = "name = \"x\"\n[axes]\nmethod = [\"split-sum\"]\nprefilter = [\"sampled\"]\nprefilter_lod_bias = [\"filament\", 0.5, \"khronos-sampler\"]\n";
    let plan = Plan::from_text(Path::new("e.toml"), text, &[]).unwrap();
    let biases: Vec<f32> =
        plan.cells.iter().map(|cell| plan.request(&cell.point).shading.precompute.prefilter_lod_bias).collect();
    assert_eq!(biases, [1.0, 0.5, 0.5 * (4.0 * std::f32::consts::PI).log2()]);
    let text = "name = \"x\"\n[axes]\nprefilter_lod_bias = [1, \"filament\", \"filamnt\", 17]\nsequence = [\"sobol\"]\n\
                storage_format = [\"f8\"]\nlod_bias = [\"filament\"]\nlevel_mapping = [\"cmgen\"]\nprefilter_weight = [\"cosin\"]\n\
                prefilter_level_count = [1]\n";
    assert_faults(
        &faults(text, &[]),
        &[
            "e.toml:3:26: axes.prefilter_lod_bias: 1 is listed twice",
            "e.toml:3:38: axes.prefilter_lod_bias: \"filamnt\" is not a level bias; did you mean \"filament\"?; expected a number in [-16, 16], or",
            "e.toml:3:49: axes.prefilter_lod_bias: 17 is outside [-16, 16]",
            "e.toml:4:13: axes.sequence: \"sobol\" is not a sequence",
            "e.toml:5:19: axes.storage_format: \"f8\" is not a storage format",
            "e.toml:6:13: axes.lod_bias: ",
            "e.toml:7:18: axes.level_mapping: \"cmgen\" is not a level mapping",
            "e.toml:8:21: axes.prefilter_weight: \"cosin\" is not a prefilter weight; did you mean \"cosine\"?",
            "e.toml:9:26: axes.prefilter_level_count: 1 is outside [2, 11]",
        ],
    );
}

/// The label of a row must be the number of samples that were drawn.
#[test]
fn a_reference_takes_whole_scrambles_only() {
    let with = |reference: u32, rest: &str| {
        format!("name = \"x\"\nreference = {{ samples = {reference} }}\n[axes]\nalpha = [0.2]\n{rest}")
    };
    let at_reference = "e.toml:2:25: reference.samples: 100 samples a pixel: the reference draws pairs in 4 scrambles, so \
                        multiples of 8; expected 96 or 104";
    assert_faults(&faults(&with(100, ""), &[]), &[at_reference]);
    let swept = "samples = [44, 64]\nmethod = [\"sampled\", \"reference\"]\n";
    let at_axis = "e.toml:5:12: samples of method reference: 44 samples a pixel";
    assert_faults(&faults(&with(64, swept), &[]), &[at_axis]);
    let excluded = "[[exclude]]\nmethod = \"reference\"\nsamples = 44\nwhy = \"whole pairs\"\n";
    assert_faults(&faults(&with(64, &format!("{swept}{excluded}")), &[]), &[]);
    // The count of the [reference] is that of the diffuse term beside another method, too, and of nothing where no term is its own.
    let diffuse = "diffuse = [\"reference\"]\n";
    let other = |diffuse: &str| {
        with(100, diffuse).replace("{ samples = 100 }", "{ samples = 100, method = \"none\", terms = \"cell\" }")
    };
    assert_faults(&faults(&other(diffuse), &[]), &["e.toml:2:25: reference.samples: 100 samples"]);
    assert_faults(&faults(&other("diffuse = [\"none\"]\n"), &[]), &[]);
}

#[test]
fn text_of_every_default_parses_back_to_the_same_value() {
    for axis in splitsum::experiment::axis::AXES {
        let value = (axis.default)();
        if value.to_string().is_empty() {
            continue;
        }
        assert_eq!(axis.kind.parse_text(&value.to_string()), Ok(value), "{}", axis.name);
    }
}

#[test]
fn values_that_do_not_go_together_are_named_at_the_one_to_change() {
    let text = "name = \"x\"\n[precompute]\nprefilter_size = [16, 16]\n[axes]\nmethod = [\"split-sum\", \"sampled\"]\n\
                prefilter_level_count = [2, 5]\n";
    assert_faults(
        &faults(text, &[]),
        &[
            "e.toml:6:29: prefilter_level_count is 5, but a prefilter_size of 16x16 halves to 1 texels on its short side in the \
           last level; expected at least 4 there: at most 3 levels",
        ],
    );
    // A method that needs no map does not mind.
    assert_faults(&faults(&text.replace("\"split-sum\", ", ""), &[]), &[]);
    let text = "name = \"x\"\n[precompute]\nprefilter_size = [16, 8]\n[axes]\nmethod = [\"split-sum\"]\n";
    assert_faults(
        &faults(text, &[]),
        &["e.toml:3:1: prefilter_size is 16x8; the faces of layout cube are square: 8x8"],
    );
    assert_faults(
        &faults("name = \"x\"\n[axes]\nmethod = [\"split-sum\"]\n", &["prefilter_level_count=7"]),
        &["--set prefilter_level_count: prefilter_level_count is 7, but a prefilter_size of 128x128 halves to 2"],
    );
}

#[test]
fn what_has_no_steps_is_refused_under_ladder() {
    let of = |keys: &str, axes: &str| {
        let text =
            format!("name = \"x\"\n{keys}[ladder]\n[axes]\nscene = [\"design\"]\nmethod = [\"split-sum\"]\n{axes}\n");
        faults(&text, &[])
    };
    assert_faults(&of("", ""), &[]);
    for (keys, axes, fault) in [
        ("", "diffuse = [\"sh9\", \"zh3\"]", "e.toml:6:19: diffuse: [ladder] has no steps for zh3"),
        ("", "compensation = [\"turquin\"]", "e.toml:6:17: compensation: [ladder] has no steps for turquin"),
        ("", "diffuse = [\"none\"]\nalpha = [0.001]", "e.toml:7:10: alpha: 0.001 is too narrow for [ladder]"),
        ("size = [1, 1]\n", "", "e.toml:2:8: size: 1x1 has 1 pixels; [ladder] needs at least 64"),
    ] {
        let found = of(keys, axes);
        assert!(found.len() == 1 && found[0].starts_with(fault), "{fault}: found {found:?}");
    }
    // Terms beside the scene `design` have no steps to tell.
    assert_faults(&faults("name = \"x\"\n[ladder]\n[axes]\nscene = [\"sphere\"]\ndiffuse = [\"zh3\"]\n", &[]), &[]);
}

#[test]
fn a_comma_between_the_parameters_of_a_formula_ends_no_value() {
    let text = "name = \"x\"\n[axes]\nalpha = [0.1]\n";
    let set = "environment=builtin:cap:half_angle_deg=10,radiance=100,builtin:sky,builtin:constant";
    let plan = Plan::from_text(Path::new("e.toml"), text, &[set.to_owned()]).unwrap();
    let names: Vec<String> = plan.cells.iter().map(|c| c.point.get("environment").to_string()).collect();
    assert_eq!(names, ["builtin:cap:half_angle_deg=10,radiance=100", "builtin:sky", "builtin:constant"]);
}

#[test]
fn ranges_and_zips_are_checked() {
    let text = "name = \"x\"\n[axes]\nalpha = { linspace = [0.5, 2, 4] }\nsamples = { pow2 = [3, 1] }\nbrdf = { pow2 = [0, 1] }\n\
                exposure = { logspace = [0, 1, 3] }\ncontrast = { linspaces = [1, 2, 3] }\n";
    assert_faults(
        &faults(text, &[]),
        &[
            "e.toml:3:9: axes.alpha: 1.5 is outside (0, 1]",
            "e.toml:3:9: axes.alpha: 2.0 is outside (0, 1]",
            "e.toml:4:11: axes.samples: pow2 = [3, 1]; expected two powers, ascending",
            "e.toml:5:8: axes.brdf: a range needs an axis of numbers",
            "e.toml:6:12: axes.exposure: logspace needs two numbers above 0",
            "e.toml:7:14: axes.contrast.linspaces is unknown; did you mean \"linspace\"?",
        ],
    );
    let text = "name = \"x\"\n[axes]\nalpha = [0.1, 0.2]\nsamples = [1, 2, 3]\n[[zip]]\naxes = [\"alpha\", \"samples\"]\n\
                [[zip]]\naxes = [\"alpha\", \"f0\"]\n[[zip]]\naxes = [\"alhpa\"]\n";
    assert_faults(
        &faults(text, &[]),
        &[
            "e.toml:6:1: zip: alpha has 2 values, samples has 3 values; expected as many for each",
            "e.toml:8:1: zip: alpha is listed twice",
            "e.toml:8:1: zip: f0 is not in [axes]",
            "e.toml:10:1: zip: needs axes = [...] with at least two axes",
            "e.toml:10:9: zip.axes: \"alhpa\" is not an axis; did you mean \"alpha\"?",
        ],
    );
    // A slip in a name or a value is one fault, not a second one about numbers of axes or values.
    let text = "name = \"x\"\n[axes]\nalpha = [0.1, 2]\nsamples = [1, 2]\n[[zip]]\naxes = [\"alpha\", \"samples\"]\n\
                [[zip]]\naxes = [\"contrast\", \"exposre\"]\n";
    assert_faults(
        &faults(text, &[]),
        &[
            "e.toml:3:15: axes.alpha: 2 is outside",
            "e.toml:8:1: zip: contrast is not in [axes]",
            "e.toml:8:21: zip.axes: \"exposre\" is not an axis; did you mean \"exposure\"?",
        ],
    );
}

#[test]
fn a_key_that_stands_twice_hides_no_other_fault() {
    let text = "name = \"x\"\n[[zip]]\naxes = [\"alpha\", \"f0\"]\n[axes]\nmethod = [\"split-sum\"]\nprefilter_level_count = [9]\n\
                alpha = [0.1]\nf0 = [0.1]\n[timing]\nrounds = 0\nrounds = 3\n[axes]\nbrdf = [\"ggx\"]\n";
    assert_faults(
        &faults(text, &[]),
        &[
            "e.toml:6:26: prefilter_level_count is 9, but",
            "e.toml:10:10: timing.rounds: 0 is outside [1, 100000]",
            "e.toml:11:1: not TOML: the key rounds is written twice",
            "e.toml:12:2: not TOML: the key axes is written twice",
        ],
    );
}

#[test]
fn images_that_no_device_holds_are_faults_and_those_that_some_refuse_are_warned_of() {
    let text = "name = \"x\"\n[axes]\nalpha = [0.1]\nsize = [[64, 64], [16384, 16384]]\n";
    assert_faults(&faults(text, &[]), &["e.toml:4:19: size: 16384x16384 has 268435456 pixels; at most 268435455 fit"]);
    let warnings = |text: &str| Plan::from_text(Path::new("e.toml"), text, &[]).unwrap().warnings();
    // 16 bytes a pixel: 2896 squared are the last below 2^27 bytes.
    let text = "name = \"x\"\nsize = [2897, 2897]\n[axes]\nalpha = [0.1]\n";
    let [warning] = &warnings(text)[..] else { panic!("{:?}", warnings(text)) };
    assert!(warning.starts_with("e.toml:2:8: size: 2897x2897 needs a buffer of 128 MiB"), "{warning}");
    assert!(warnings(&text.replace("2897", "2896")).is_empty());
}

#[test]
fn one_slip_is_one_fault() {
    let text =
        "name = \"x\"\n[axes]\nalpha = { linspace = [0.1, 1, 3], stopp = 2 }\n[[exclude]]\nalpha = 0.1\nwhy = 3\n";
    assert_faults(
        &faults(text, &[]),
        &[
            "e.toml:3:35: axes.alpha.stopp is unknown; expected one of linspace, logspace, pow2",
            "e.toml:6:7: exclude.why: 3 is not text",
        ],
    );
}

/// An exclusion by a value that no cell has leaves nothing out: a slip. Values that `--set` took away, or that stand beside others, are none.
#[test]
fn an_excluded_value_that_the_axis_does_not_have_is_a_fault() {
    let text = |condition: &str| {
        format!(
            "name = \"x\"\n[axes]\nalpha = [0.1, 0.5]\nsamples = [1, 16]\nmethod = [\"sampled\"]\n[[exclude]]\n{condition}\nwhy = \"w\"\n"
        )
    };
    for (condition, fault) in [
        ("alpha = 0.05", "e.toml:7:9: exclude.alpha: the axis has no value 0.05; it has 0.1, 0.5"),
        ("samples = [15, 3]", "e.toml:7:12: exclude.samples: the axis has no value 15; it has 1, 16"),
        ("method = \"split-sum\"", "e.toml:7:10: exclude.method: the axis has no value \"split-sum\"; it has sampled"),
        // Not swept: all cells have the one value.
        ("exposure = 5", "e.toml:7:12: exclude.exposure: the axis has no value 5; it has 1"),
    ] {
        let found = faults(&text(condition), &[]);
        assert!(found.iter().any(|line| line == fault), "{found:#?}");
    }
    assert_faults(&faults(&text("samples = [16, 3]"), &[]), &[]);
    assert_faults(&faults(&text("samples = 16"), &["samples=1,4"]), &[]);
    assert_faults(&faults(&text("exposure = 1"), &["exposure=2,4"]), &[]);
    assert_faults(&faults(&text("exposure = 4"), &["exposure=2,4"]), &[]);
    let plan = splitsum::experiment::Plan::from_text(std::path::Path::new("e.toml"), &text("samples = [16, 3]"), &[]);
    let warnings = plan.unwrap().warnings();
    assert_eq!(warnings, ["e.toml:7:16: exclude.samples: the axis has no value 3; it has 1, 16"]);
}

#[test]
fn a_point_light_stands_outside_of_every_sphere() {
    let text = |scene: &str, position: &str| {
        format!(
            "name = \"x\"\nscene = \"{scene}\"\n[axes]\nalpha = [0.5]\n\
             [[lights]]\nkind = \"point\"\nposition = {position}\ncolor = 1\n"
        )
    };
    let fault =
        "e.toml:5:1: lights: the point light at (0, 0.5, 0) is inside a sphere of scene sphere (centre (0, 0, 0)";
    assert_faults(&faults(&text("sphere", "[0, 0.5, 0]"), &[]), &[fault]);
    assert_faults(&faults(&text("sphere", "[0, 1, 0]"), &[]), &["e.toml:5:1: lights: the point light at (0, 1, 0)"]);
    assert_faults(&faults(&text("sphere", "[0, 1.001, 0]"), &[]), &[]);
    assert_faults(&faults(&text("plane", "[0, 0.5, 0]"), &[]), &[]);
    let directional = text("sphere", "[0, 0.5, 0]").replace("point", "directional").replace("position", "direction");
    assert_faults(&faults(&directional, &[]), &[]);
}

/// A column of zipped axes is one combination: values may stand twice in a row, but not the whole column.
#[test]
fn zipped_rows_may_repeat_values() {
    let text = |samples: &str| {
        format!(
            "name = \"x\"\nsize = [8, 8]\nreference = {{ samples = 32 }}\n[axes]\nmethod = [\"sampled\"]\ndiffuse = [\"none\"]\n\
             alpha = [0.1, 0.1, 0.2]\nsamples = {samples}\n[[zip]]\naxes = [\"alpha\", \"samples\"]\n"
        )
    };
    let plan = crate::run::runs::plan(&text("[1, 2, 2]"));
    let told = |axis: &str| -> Vec<String> {
        let axis = splitsum::experiment::axis::index_of(axis).unwrap();
        plan.cells.iter().map(|cell| cell.point[axis].to_string()).collect()
    };
    assert_eq!((told("alpha").join(" "), told("samples").join(" ")), ("0.1 0.1 0.2".to_owned(), "1 2 2".to_owned()));
}
