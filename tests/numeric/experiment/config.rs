//! Experiment files: every fault is reported at once with its place, and correct files load.

use super::planned;
use crate::snapshot::{assert_snapshot, without_lists};
use splitsum::experiment::Plan;
use splitsum::experiment::axis::{ALPHA, AXES};

/// The faults of `text` as the file `e.toml`, one a line.
fn faults(text: &str, set: &[&str]) -> Vec<String> {
    match planned(text, set) {
        Ok(_) => Vec::new(),
        Err(error) => error.to_string().lines().map(without_lists).collect(),
    }
}

/// An experiment with these axes, which begin in line 3.
fn axes(lines: &str) -> String {
    format!("name = \"x\"\n[axes]\n{lines}\n")
}

/// An experiment of the scene `design` with `[ladder]`. Its own axes begin in line 6, or one later
/// after a key.
fn ladder(key: &str, lines: &str) -> String {
    format!(
        "name = \"x\"\n{key}[ladder]\n[axes]\nscene = [\"design\"]\nmethod = \
         [\"split-sum\"]\n{lines}\n"
    )
}

fn asking(asks: &str) -> String {
    format!("asks = {asks}\nname = \"x\"\n[axes]\nmethod = [\"split-sum\"]\n")
}

/// An experiment of two alphas and two sample counts, with an exclusion in line 7.
fn excluding(condition: &str) -> String {
    axes(&format!(
        "alpha = [0.1, 0.5]\nsamples = [1, 16]\nmethod = \
         [\"sampled\"]\n[[exclude]]\n{condition}\nwhy = \"w\""
    ))
}

/// An experiment whose `[reference]` has this many samples.
fn judged(reference: &str, lines: &str) -> String {
    format!(
        "name = \"x\"\nreference = {{ samples = {reference} }}\n[axes]\nalpha = [0.2]\n{lines}\n"
    )
}

const MANY: &str = r#"name = "x y"
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
"#;
const ZIPS: &str = "[[zip]]\naxes = [\"alpha\", \"samples\"]\n";
const DEEP: &str = "[precompute]\nprefilter_size = [16, 16]\n[axes]\nmethod = [\"split-sum\"]\n";

#[test]
fn every_fault_is_reported_with_its_place() {
    let set = [
        "alpha=2",
        "alfa=1",
        "nonsense",
        "samples=4,4",
        "brdf=ggx",
        "brdf=phong",
    ];
    let cases: Vec<(&str, String, &[&str])> = vec![
        ("many at once", MANY.to_owned(), &[]),
        (
            "columns count characters",
            axes("f0 = [[0.5, 0.5, 0.5], \"é\", 1.5]"),
            &[],
        ),
        ("missing keys", "question = \"?\"\n".to_owned(), &[]),
        (
            "fixed and swept",
            "name = \"x\"\nscene = \"sphere\"\n[precompute]\ndfg_size = 8\n[axes]\ndfg_size = \
             [8]\nscene = [\"sphere\"]\n"
                .to_owned(),
            &[],
        ),
        (
            "orientations of the set",
            axes("environment_orientation = [0, 4095, 4096, -1, 1.5]"),
            &[],
        ),
        (
            "not finite",
            axes("alpha = [nan]\nexposure = [inf]\nenvironment_scale = [-inf]"),
            &[],
        ),
        ("--set", axes("alpha = [0.1, 0.2]"), &set),
        (
            "pairs and colours",
            "name = \"x\"\nsize = [0, 99999]\n[axes]\nf0 = [[2, 0.5, -1]]\n".to_owned(),
            &[],
        ),
        (
            "names of settings",
            axes(
                "prefilter_lod_bias = [1, \"filament\", \"filamnt\", 17]\nsequence = \
                 [\"sobol\"]\nstorage_format = [\"f8\"]\n\
                 lod_bias = [\"filament\"]\nlevel_mapping = [\"cmgen\"]\nprefilter_weight = \
                 [\"cosin\"]\nprefilter_level_count = [1]",
            ),
            &[],
        ),
        ("whole scrambles of the judge", judged("100", ""), &[]),
        (
            "whole scrambles",
            judged(
                "64",
                "samples = [44, 64]\nmethod = \
                                          [\"sampled\", \"reference\"]",
            ),
            &[],
        ),
        (
            "whole scrambles of the diffuse term",
            judged(
                "100, method = \"none\", terms = \"cell\"",
                "diffuse = [\"reference\"]",
            ),
            &[],
        ),
        (
            "levels of small maps",
            format!("name = \"x\"\n{DEEP}prefilter_level_count = [2, 5]\n"),
            &[],
        ),
        (
            "square faces",
            format!("name = \"x\"\n{DEEP}").replace("[16, 16]", "[16, 8]"),
            &[],
        ),
        (
            "levels by --set",
            axes("method = [\"split-sum\"]"),
            &["prefilter_level_count=7"],
        ),
        (
            "ladder of compensation",
            ladder("", "compensation = [\"turquin\"]"),
            &[],
        ),
        (
            "ladder of anisotropy",
            ladder("", "anisotropy = [0.5]"),
            &[],
        ),
        (
            "anisotropy of one width",
            axes("brdf = [\"phong\"]\nanisotropy = [0, 0.5]"),
            &[],
        ),
        (
            "anisotropy by a fit",
            axes("masking = [\"schlick\"]\nanisotropy = [0.5]"),
            &[],
        ),
        (
            "ladder of narrow lobes",
            ladder("", "diffuse = [\"none\"]\nalpha = [0.001]"),
            &[],
        ),
        ("ladder of few views", ladder("size = [1, 1]\n", ""), &[]),
        (
            "ranges",
            axes(
                "alpha = { pow2 = [-1, 1] }\nsamples = { pow2 = [3, 1] }\nbrdf = { pow2 = [0, 1] \
                 }\n\
                 exposure = { pow2 = [0, 1, 3] }\ncontrast = { pow = [1, 2] }",
            ),
            &[],
        ),
        (
            "ranges by a count",
            axes(
                "alpha = { logspace = [0, 1, 9] }\nf0 = { linspace = [0, 1, 1] }\nexposure = { \
                 linspace = [2, 1, 5] }\ncontrast = { logspace = [0.1, 1] }\nmetallic = { \
                 linspace = [0, 2, 3] }\nsamples = { logspace = [1, 8, 20] }\nlod_bias = { \
                 linspace = [-1, 1, 3.5] }\nbrdf = { linspace = [1, 2, 3] }\ncoat = { logspace = \
                 [0.1, inf, 3] }\nior = { logspace = 3 }",
            ),
            &[],
        ),
        (
            "an index",
            axes("ior = [0.9, 101, \"glass\", [1.5, 1.6]]\nf0 = [0.04]"),
            &[],
        ),
        (
            "one slip in a range",
            axes(
                "alpha = { pow2 = [-1, 0], stopp = 2 }\n[[exclude]]\nalpha = \
                                      0.1\nwhy = 3",
            ),
            &[],
        ),
        (
            "zips",
            axes(&format!(
                "alpha = [0.1, 0.2]\nsamples = [1, 2, 3]\n{ZIPS}[[zip]]\naxes = \
                 [\"alpha\", \"f0\"]\n[[zip]]\naxes = [\"alhpa\"]"
            )),
            &[],
        ),
        (
            "one slip in a zip",
            axes(&format!(
                "alpha = [0.1, 2]\nsamples = [1, 2]\n{ZIPS}[[zip]]\naxes = \
                           [\"contrast\", \"exposre\"]"
            )),
            &[],
        ),
        (
            "keys written twice",
            "name = \"x\"\n[[zip]]\naxes = [\"alpha\", \"f0\"]\n[axes]\nmethod = \
             [\"split-sum\"]\nprefilter_level_count = [9]\n\
             alpha = [0.1]\nf0 = [0.1]\n[timing]\nrounds = 0\nrounds = 3\n[axes]\nbrdf = \
             [\"ggx\"]\n"
                .to_owned(),
            &[],
        ),
        (
            "too many pixels",
            axes("alpha = [0.1]\nsize = [[64, 64], [16384, 16384]]"),
            &[],
        ),
        ("excluded alpha", excluding("alpha = 0.05"), &[]),
        ("one excluded count", excluding("samples = [16, 3]"), &[]),
        ("excluded method", excluding("method = \"split-sum\""), &[]),
        (
            "asks and metric",
            asking("[\"a\", 1, \"a\"]\nmetric = \"flop\""),
            &[],
        ),
        (
            "asks by",
            asking(
                "[{ question = \"a\", by = \"apha\" }, { by = \"f0\" }, { question = 1, \
                            rows = 2 }]",
            ),
            &[],
        ),
        (
            "two names of one axis",
            axes("alpha = [0.5]\nperceptual_roughness = [0.5]"),
            &[],
        ),
        (
            "two names in --set",
            axes("alpha = [0.5]"),
            &["alpha=0.1", "perceptual_roughness=0.5"],
        ),
        (
            "roughness out of range",
            axes("perceptual_roughness = [0.5, 0, 1.5]"),
            &[],
        ),
        (
            "excluded by the other name",
            axes(
                "perceptual_roughness = [0.5, 1]\n[[exclude]]\nperceptual_roughness = 0.25\nwhy \
                  = \"?\"",
            ),
            &[],
        ),
        (
            "a bare roughness",
            "name = \"x\"\nroughness = 0.5\n[axes]\nroughness = [0.5]\n[[exclude]]\nroughness = \
             1\nwhy = \"?\"\n"
                .to_owned(),
            &["roughness=0.5"],
        ),
        (
            "open [",
            axes("alpha = [0.5,\nmethod = [\"split-sum\"]"),
            &[],
        ),
        (
            "the first of two open",
            axes("alpha = [0.5\nsize = { a = 3"),
            &[],
        ),
        (
            "a missing file is not a formula",
            axes(
                "environment = \
                                                  [\"sky.hdr\", \"maps/sky\", \"studio.exr\", \"studi\"]",
            ),
            &[],
        ),
        (
            "an approximation as judge",
            "name = \"x\"\nreference = { method = \"split-sum\" \
                                       }\n[axes]\nalpha = [0.5]\n"
                .to_owned(),
            &[],
        ),
    ];
    let messages: Vec<String> = cases
        .iter()
        .map(|(title, text, set)| {
            let found = faults(text, set);
            assert!(!found.is_empty(), "{title}: no fault");
            format!("# {title}\n{}", found.join("\n"))
        })
        .collect();
    assert_snapshot("experiments_with_faults", &messages.join("\n"));
}

#[test]
fn correct_experiments_have_no_faults() {
    let swept = "samples = [44, 64]\nmethod = [\"sampled\", \"reference\"]\n";
    for (text, set) in [
        // Excluded cells are not drawn, and without a diffuse term nothing reads the reference's
        // count.
        (judged("64", &format!("{swept}[[exclude]]\nmethod = \"reference\"\nsamples = 44\nwhy \
                                = \"pairs\"")), None),
        (judged("100, method = \"none\", terms = \"cell\"", "diffuse = [\"none\"]"), None),
        // A method that reads no map ignores its levels.
        (format!("name = \"x\"\n{DEEP}prefilter_level_count = [5]\n").replace("split-sum", "sampled"), None),
        (ladder("", ""), None),
        // Only the scene `design` has steps.
        ("name = \"x\"\n[ladder]\n[axes]\nscene = [\"sphere\"]\ndiffuse = [\"fresnel-inside\"]\n".to_owned(), None),
        // Values that `--set` removed, or that are in other rows.
        (excluding("samples = 16"), Some("samples=1,4")),
        (excluding("exposure = 1"), Some("exposure=2,4")),
        (excluding("exposure = 4"), Some("exposure=2,4")),
        ("name = \"x\"\nreference = { method = \"none\" }\n[axes]\nalpha = [0.5]\n".to_owned(), None),
    ] {
        assert_eq!(faults(&text, set.as_slice()), [""; 0], "{text}");
    }
}

pub fn values(plan: &Plan, axis: &str) -> Vec<String> {
    plan.cells
        .iter()
        .map(|cell| cell.point.get(axis).to_string())
        .collect()
}

fn plan(text: &str, set: &[&str]) -> Plan {
    planned(text, set).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn asks_have_a_metric_and_rows_and_change_no_cell() {
    let text = "name = \"x\"\n[axes]\nmethod = [\"split-sum\"]\n";
    let asks = "asks = [\"error\", { question = \"effect\", by = \"perceptual_roughness\" \
                }]\nmetric = \"flip\"\n";
    let (plain, asking) = (plan(text, &[]), plan(&format!("{asks}{text}"), &[]));
    assert_eq!(
        (plain.config.asks.len(), plain.config.metric),
        (0, splitsum::instrument::metrics::HEADLINE)
    );
    let asked: Vec<_> = asking
        .config
        .asks
        .iter()
        .map(|ask| (&*ask.question, ask.by.as_ref().map(|by| by.0)))
        .collect();
    assert_eq!(
        (asked, asking.config.metric),
        (vec![("error", None), ("effect", Some(ALPHA))], "flip")
    );
    // Questions are not part of the rows.
    assert_eq!(asking.hash, plain.hash);
}

#[test]
fn overrides_replace_an_axis() {
    let replaced = plan(
        &axes("alpha = [0.1, 0.2]"),
        &["alpha=0.5", "f0=0.04,1:0.5:0"],
    );
    assert_eq!(
        [values(&replaced, "alpha"), values(&replaced, "f0")],
        [["0.5", "0.5"], ["0.04", "1:0.5:0"]]
    );
    // A comma between parameters of a formula does not end a value.
    let set = "environment=builtin:cap:half_angle_deg=10,radiance=100,builtin:sky,builtin:constant";
    let names = values(&plan(&axes("alpha = [0.1]"), &[set]), "environment");
    assert_eq!(
        names,
        [
            "builtin:cap:half_angle_deg=10,radiance=100",
            "builtin:sky",
            "builtin:constant"
        ]
    );
}

#[test]
fn level_biases_have_names() {
    let lines = "method = [\"split-sum\"]\nprefilter = [\"sampled\"]\nprefilter_lod_bias = \
                 [\"filament\", 0.5, \"khronos-sampler\"]";
    let plan = plan(&axes(lines), &[]);
    let biases: Vec<f32> = plan
        .cells
        .iter()
        .map(|cell| {
            plan.request(&cell.point)
                .shading
                .precompute
                .prefilter_lod_bias
        })
        .collect();
    assert_eq!(
        biases,
        [1.0, 0.5, 0.5 * (4.0 * std::f32::consts::PI).log2()]
    );
}

#[test]
fn text_of_every_default_parses_back_to_the_same_value() {
    for axis in &AXES {
        let value = (axis.default)();
        if !value.to_string().is_empty() {
            assert_eq!(
                axis.kind.parse_text(&value.to_string()),
                Ok(value),
                "{}",
                axis.name
            );
        }
    }
}

#[test]
fn probable_slips_are_warnings() {
    let warnings = |text: &str| plan(text, &[]).warnings();
    // 16 bytes a pixel: 2896 squared is the largest image below 2^27 bytes.
    let text = "name = \"x\"\nsize = [2897, 2897]\n[axes]\nalpha = [0.1]\n";
    let [warning] = &warnings(text)[..] else {
        panic!("{:?}", warnings(text))
    };
    assert!(
        warning.starts_with("e.toml:2:8: size: 2897x2897 needs a buffer of 128 MiB"),
        "{warning}"
    );
    assert!(warnings(&text.replace("2897", "2896")).is_empty());
    // An axis that reaches no pixel, and one of a coat without a coat.
    let idle = |lines: &str| warnings(&format!("name = \"x\"\n[axes]\n{lines}\n")).join("\n");
    assert!(
        idle("metallic = [1]\nf0 = [0.04, 1]")
            .contains("f0: its 2 values give the same image: every surface")
    );
    assert!(
        idle("coat_alpha = [0.1, 0.2]")
            .contains("coat_alpha: its 2 values give one cell: no surface has a coat")
    );
    assert!(
        idle("anisotropy_widths = [\"gltf\", \"kulla\"]").contains("no surface is anisotropic")
    );
    assert!(idle("metallic = [0]\nf0 = [0.04, 1]\ncoat = [1]\ncoat_alpha = [0.1, 0.2]").is_empty());
}
