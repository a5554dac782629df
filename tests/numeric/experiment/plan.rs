//! Counts, ids and groups of plans.

use super::config::values;
use super::planned;
use crate::occluded::{OCCLUDED, occluded_scene};
use splitsum::bake::container::{Encoding, FORMATS, TEXELS};
use splitsum::base::pixels::RgbImage;
use splitsum::experiment::axis::{AXES, Axis, AxisId, Layer, Part, SCENE};
use splitsum::experiment::plan::Source;
use splitsum::experiment::value::Kind;
use splitsum::experiment::{Cell, Id, Plan};
use splitsum::instrument::environment::LoadOptions;
use splitsum::instrument::precompute::prefilter::LevelMapping;
use splitsum::run::timing;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

fn plan(text: &str) -> Plan {
    planned(text, &[]).unwrap_or_else(|error| panic!("{error}"))
}

const SWEEP: &str = r#"
name = "x"
[axes]
brdf = ["ggx", "phong"]
method = ["sampled", "split-sum"]
samples = [1, 4, 40]
alpha = [0.1, 0.5]
exposure = [1, 10]
"#;

fn by_point(plan: &Plan) -> BTreeMap<String, &Cell> {
    plan.cells
        .iter()
        .map(|cell| {
            let mut words: Vec<String> = plan
                .columns_of(cell)
                .iter()
                .map(|(n, v)| format!("{n}={v}"))
                .collect();
            words.sort();
            (words.join(" "), cell)
        })
        .collect()
}

#[test]
fn a_method_without_samples_collapses_the_samples_axis() {
    let plan = plan(SWEEP);
    // 2 models x 2 alphas x 2 exposures x (3 sample counts + 1).
    assert_eq!(plan.cells.len(), 32);
    assert_eq!(plan.collapsed, 16);
    for cell in &plan.cells {
        let is_split_sum = cell.point.get("method").to_string() == "split-sum";
        assert_eq!(
            cell.point.get("samples").to_string().is_empty(),
            is_split_sum
        );
    }
}

#[test]
fn an_exclusion_leaves_the_same_cells_as_the_collapse() {
    let text = format!(
        "{SWEEP}[[exclude]]\nmethod = \"split-sum\"\nsamples = [1, 40]\nwhy = \"none drawn\"\n\
         [[exclude]]\nmethod = \"split-sum\"\nsamples = 40\nwhy = \"idle\"\n"
    );
    let excluded = plan(&text);
    assert_eq!(excluded.excluded, [16, 0]);
    let place = text.matches('\n').count() - 3;
    let [warning] = &excluded.warnings()[..] else {
        panic!("{:?}", excluded.warnings())
    };
    assert!(
        warning.ends_with(&format!(
            ":{place}:1: the exclusion \"idle\" matches no combination"
        )),
        "{warning}"
    );
    assert_eq!(excluded.collapsed, 0);
    let ids = |plan: &Plan| plan.cells.iter().map(|c| c.id).collect::<BTreeSet<_>>();
    assert_eq!(ids(&excluded), ids(&plan(SWEEP)));
}

/// A value that `--set` removes is not a fault of the file, on any axis.
#[test]
fn an_exclusion_is_not_idle_by_set() {
    let text =
        format!("{SWEEP}[[exclude]]\nmethod = \"split-sum\"\nexposure = 1\nwhy = \"used\"\n");
    for set in ["method=sampled", "alpha=0.5"] {
        assert_eq!(planned(&text, &[set]).unwrap().warnings(), [""; 0], "{set}");
    }
}

#[test]
fn sample_counts_of_maps_by_harmonics_are_reported_as_idle() {
    let text = |by: &str| {
        format!(
            "name = \"x\"\n[axes]\nmethod = [\"split-sum\", \"sampled\"]\nalpha = [0.5]\nprefilter \
             = {by}\nprefilter_sample_count = [16, 64]\n"
        )
    };
    let warned = |by: &str| plan(&text(by)).warnings();
    let [warning] = &warned("[\"harmonic\"]")[..] else {
        panic!("{:?}", warned("[\"harmonic\"]"))
    };
    assert!(
        warning.starts_with(
            "e.toml:6:27: prefilter_sample_count: its 2 values give one cell: \
                                 no method of the experiment uses it (samples per texel of a \
                                 sampled"
        ),
        "{warning}"
    );
    assert!(warned("[\"sampled\"]").is_empty() && warned("[\"harmonic\", \"sampled\"]").is_empty());
}

#[test]
fn metals_that_an_albedo_of_0_makes_black_are_reported() {
    let warned = |scene: &str, axes: &str| {
        let text = format!(
            "name = \"x\"\n[axes]\nscene = [\"{scene}\"]\nalpha = [0.2, 0.5]\nalbedo = [0, \
             0.5]\n{axes}"
        );
        plan(&text).warnings()
    };
    let [warning] = &warned("spheres", "")[..] else {
        panic!("{:?}", warned("spheres", ""))
    };
    assert!(
        warning.starts_with("e.toml:5:11: albedo: 0 makes the metals of spheres black"),
        "{warning}"
    );
    assert!(warned("spheres", "metallic = [0]\n").is_empty() && warned("sphere", "").is_empty());
}

#[test]
fn ids_do_not_depend_on_the_order_of_axes_values_or_keys() {
    let reordered = r#"
seed = 1
[axes]
exposure = [10, 1]
alpha = [0.5, 0.1]
samples = [40, 1, 4]
method = ["split-sum", "sampled"]
brdf = ["phong", "ggx"]
"#;
    let (a, b) = (plan(SWEEP), plan(&format!("name = \"x\"{reordered}")));
    let (a, b) = (by_point(&a), by_point(&b));
    assert_eq!(a.len(), 32);
    assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>());
    for (key, cell) in &a {
        assert_eq!(cell.id, b[key].id, "{key}");
    }
}

#[test]
fn ids_depend_on_everything_that_determines_pixels() {
    let of = |head: &str, options: &LoadOptions| {
        // The diffuse term is a reference: its settings change the image.
        let axes = "[axes]\nalpha = [0.1]\ndiffuse = [\"reference\"]";
        let (head, table) = if head.starts_with('[') {
            ("", head)
        } else {
            (head, "")
        };
        let (text, path) = (
            format!("name = \"x\"\n{head}\n{axes}\n{table}\n"),
            Path::new("e.toml"),
        );
        let plan = Plan::from_source(&Source::new(path, &text, &[]), options)
            .unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(plan.cells.len(), 1);
        [plan.cells[0].id, plan.cells[0].radiance]
    };
    let plain = LoadOptions::default();
    let mut ids = BTreeSet::from(of("", &plain));
    let heads = [
        "seed = 2",
        "size = [8, 8]",
        "camera = \"perspective\"",
        "background = true",
        "antialias = true",
        "orbit = [30, 20, 2]",
        "orbit = [0, 20, 2]",
        "orbit = [0, 0, 2]",
        "orbit = [0, 0, 3]",
        "scene = \"spheres\"",
        "reference = { samples = 64 }",
        "reference.relative_error = 0.5",
        "precompute = { dfg_size = 8 }",
    ];
    for head in heads {
        assert!(
            of(head, &plain).into_iter().all(|id| ids.insert(id)),
            "{head} changes no id"
        );
    }
    // The same name with other content.
    let other = LoadOptions {
        builtin_size: [32, 16],
        ..LoadOptions::default()
    };
    assert!(
        of("", &other).into_iter().all(|id| ids.insert(id)),
        "the light changes no id"
    );
    let ladder = |samples: u32| {
        let axes = "scene = [\"design\"]\nmethod = [\"split-sum\"]\ndiffuse = [\"none\"]\nsize = \
                    [[64, 64]]";
        plan(&format!(
            "name = \"x\"\n[axes]\n{axes}\n[ladder]\nsamples = {samples}\n"
        ))
        .cells[0]
            .id
    };
    assert!(
        ids.insert(ladder(64)) && ids.insert(ladder(128)),
        "samples of the ladder change no id"
    );
    assert!(
        !ids.insert(of("question = \"another\"", &plain)[0]),
        "the question changes an id"
    );
}

/// The steps lead from the reference to the textbook's split sum on the scene of statistics.
#[test]
fn only_the_textbooks_split_sum_has_steps() {
    let methods = "method = [\"split-sum\", \"split-sum-two\", \"sampled\"]";
    let plan = plan(&format!(
        "name = \"x\"\n[axes]\nscene = [\"design\", \"sphere\"]\n{methods}\nsamples = [8]\ndiffuse = \
         [\"none\"]\nsize = [[64, 64]]\n[ladder]\nsamples = 128\n"
    ));
    for cell in &plan.cells {
        let [scene, method] = ["scene", "method"].map(|axis| cell.point.get(axis).text());
        let expected = (scene == "design" && method == "split-sum").then_some(128);
        assert_eq!(plan.ladder_of(&cell.point), expected, "{scene} {method}");
    }
    assert_eq!(plan.cells.len(), 6);
}

/// Two values of an axis have two cells each. They have two references if the axis distinguishes
/// cases; else one reference judges both. Tables without a coat and sheen have the columns that
/// they had before both.
#[test]
fn layers_are_columns_only_where_they_are_named() {
    let names = |text: &str| -> Vec<&str> {
        plan(text)
            .columns
            .iter()
            .map(|axis| AXES[*axis].name)
            .collect()
    };
    let is_layer = |name: &&str| name.starts_with("coat") || name.starts_with("sheen");
    let layers = |text: &str| names(text).into_iter().filter(is_layer).count();
    let named = [
        "",
        "coat = [1]\ncoat_alpha = [0.1]\n",
        "sheen_color = [1]\nsheen_lookup = [\"three\"]\n",
    ];
    assert_eq!(
        named.map(|more| layers(&format!("{SWEEP}{more}"))),
        [0, 2, 2]
    );
}

#[test]
fn the_reference_inherits_the_axes_of_cases_alone() {
    let folder = occluded_scene();
    let occluded = format!("scene = [{:?}]\n", folder.path().join(OCCLUDED));
    // Tables of files are tested elsewhere.
    let is_file =
        |axis: &&Axis| axis.part == Part::Table && matches!(axis.kind, Kind::NameOrFile { .. });
    let axes = AXES
        .iter()
        .filter(|axis| ![Part::Method, Part::Count].contains(&axis.part) && !is_file(axis));
    for axis in axes {
        let values = match &axis.kind {
            Kind::Input if axis.name == AXES[SCENE].name => "\"sphere\", \"spheres\"".to_owned(),
            Kind::Input => "\"builtin:sky\", \"builtin:studio\"".to_owned(),
            Kind::Pair { .. } => "[64, 64], [128, 128]".to_owned(),
            Kind::Count { .. } => "2, 3".to_owned(),
            Kind::Name { names, .. } | Kind::NameOrList { names, .. } => names()[..2]
                .iter()
                .map(|name| format!("{name:?}"))
                .collect::<Vec<_>>()
                .join(", "),
            _ => "0.25, 0.5".to_owned(),
        };
        // Sample counts matter if the tables are sampled.
        let by = if axis.name == "prefilter" {
            ""
        } else {
            "prefilter = [\"sampled\"]\n"
        };
        let layer = axis.layer.map_or(String::new(), |layer| {
            let value = if layer == Layer::Frames { 2 } else { 1 };
            format!("{} = [{value}]\n", layer.name())
        });
        let lights = if Layer::Lights.has(AxisId::find(axis.name).unwrap()) {
            "[[lights]]\nkind = \"directional\"\ndirection = [0, -1, 0]\n"
        } else {
            ""
        };
        // These depend on another value, too.
        let more = match axis.name {
            "ema_factor" => "accumulation = [\"ema\"]\n",
            "motion_deg" => "motion = [\"light\"]\n",
            "specular_occlusion" => &occluded,
            _ => "",
        };
        let plan = plan(&format!(
            "name = \"x\"\n{lights}[axes]\n{by}{layer}{more}{} = [{values}]\nmethod = \
             [\"sampled\", \"split-sum\", \"split-sum-bent\"]\nsamples = [4]\n\
                 diffuse = [\"irradiance-map\"]\n",
            axis.name
        ));
        assert!(
            plan.cells.len() > 2,
            "{}: {} cells",
            axis.name,
            plan.cells.len()
        );
        let references: BTreeSet<_> = plan.cells.iter().map(|cell| &cell.reference).collect();
        assert_eq!(
            references.len(),
            if axis.part == Part::Case { 2 } else { 1 },
            "{}",
            axis.name
        );
        for cell in plan.cells.iter().filter(|_| axis.part == Part::Case) {
            assert_eq!(
                plan.reference_point(&cell.point).get(axis.name),
                cell.point.get(axis.name)
            );
        }
    }
}

#[test]
fn a_cell_without_a_term_has_a_reference_without_it() {
    let plan = plan(
        "name = \"x\"\n[axes]\nmethod = [\"none\"]\ndiffuse = \
         [\"none\", \"sh9\", \"irradiance-map\"]\n",
    );
    let [nothing, sh9, map] = &plan.cells[..] else {
        panic!("{} cells", plan.cells.len())
    };
    assert_ne!(nothing.reference, sh9.reference);
    assert_eq!(sh9.reference, map.reference);
    let reference = plan.reference_point(&sh9.point);
    assert_eq!(reference.get("method").to_string(), "none");
    assert_eq!(reference.get("diffuse").to_string(), "reference");
    assert_eq!(plan.request(&sh9.point).reference_samples, 4096);
}

#[test]
fn with_all_terms_a_cell_without_one_is_judged_against_the_complete_image() {
    let text = "name = \"x\"\nreference = { terms = \"all\" }\n[axes]\nmethod = \
                [\"none\", \"split-sum\"]\n";
    let plan = plan(text);
    assert_eq!(plan.groups().len(), 1);
    assert_eq!(
        plan.reference_point(&plan.cells[0].point)
            .get("method")
            .to_string(),
        "reference"
    );
}

#[test]
fn axes_that_a_method_ignores_make_no_cells() {
    let cells = |axes: &str| plan(&format!("name = \"x\"\n[axes]\n{axes}\n")).cells.len();
    let counts = "dfg_size = [8, 16]\nprefilter_sample_count = [1, 2, 3]\nirradiance_sample_count \
                  = [[4, 4], [8, 8]]";
    // The convolution takes no samples.
    assert_eq!(
        cells(&format!(
            "method = [\"split-sum\"]\ndiffuse = [\"none\"]\n{counts}"
        )),
        2
    );
    assert_eq!(
        cells(&format!(
            "method = [\"none\"]\ndiffuse = [\"irradiance-map\"]\n{counts}"
        )),
        1
    );
    let tables = format!("{counts}\nprefilter = [\"sampled\"]");
    assert_eq!(
        cells(&format!(
            "method = [\"sampled\"]\ndiffuse = [\"none\"]\n{tables}"
        )),
        1
    );
    assert_eq!(
        cells(&format!(
            "method = [\"sampled\"]\ndiffuse = [\"sh9\"]\n{tables}"
        )),
        2
    );
    assert_eq!(
        cells(&format!(
            "method = [\"split-sum\"]\ndiffuse = [\"none\"]\n{tables}"
        )),
        2 * 3
    );
    assert_eq!(
        cells(&format!(
            "method = [\"none\"]\ndiffuse = [\"irradiance-map\"]\n{tables}"
        )),
        2
    );
    assert_eq!(
        cells("method = [\"sampled-unfiltered\", \"split-sum\"]\nlod_bias = [-1, 0, 1]"),
        2
    );
}

#[test]
fn powers_of_two_are_a_range() {
    let of = |axis: &str, range: &str| {
        values(
            &plan(&format!("name = \"x\"\n[axes]\n{axis} = {range}\n")),
            axis,
        )
    };
    assert_eq!(
        of("samples", "{ pow2 = [0, 4] }"),
        ["1", "2", "4", "8", "16"]
    );
    assert_eq!(
        of("exposure", "{ pow2 = [-2, 1] }"),
        ["0.25", "0.5", "1", "2"]
    );
}

#[test]
fn ranges_have_equal_steps_or_equal_ratios() {
    let of = |axis: &str, range: &str| {
        values(
            &plan(&format!("name = \"x\"\n[axes]\n{axis} = {range}\n")),
            axis,
        )
    };
    assert_eq!(
        of("exposure", "{ logspace = [0.01, 1, 5] }"),
        ["0.01", "0.0316228", "0.1", "0.316228", "1"]
    );
    assert_eq!(of("samples", "{ logspace = [1, 64, 3] }"), ["1", "8", "64"]);
    assert_eq!(
        of("contrast", "{ linspace = [0.5, 1.5, 4] }"),
        ["0.5", "0.833333", "1.16667", "1.5"]
    );
    // Ends keep all their digits.
    assert_eq!(
        of("lod_bias", "{ linspace = [-1.23456789, 1.23456789, 3] }"),
        ["-1.23456789", "0", "1.23456789"]
    );
    assert_eq!(of("f0", "{ linspace = [0, 1, 3] }"), ["0", "0.5", "1"]);
}

#[test]
fn a_zipped_axis_may_repeat_a_value_if_the_rows_differ() {
    let axes = "brdf = [\"ggx\", \"phong\"]\nalpha = [0.1, 0.1, 0.2]\nsamples = [1, 2, 2]";
    let plan = plan(&format!(
        "name = \"x\"\n[axes]\n{axes}\n[[zip]]\naxes = [\"alpha\", \"samples\"]\n"
    ));
    assert_eq!(values(&plan, "samples").join(" "), "1 2 2 1 2 2");
}

#[test]
fn methods_are_timed_in_one_block_despite_axes_of_only_one() {
    // Without a diffuse term only the split sum reads tables, so only the split sum has a storage
    // format.
    let text = format!(
        "{SWEEP}diffuse = [\"none\"]\nstorage_format = [\"f32\", \"f16\"]\n[timing]\nrounds = 5\n"
    );
    let plan = plan(&text);
    let jobs = timing::jobs(&plan);
    let frames = jobs.iter().filter(|job| job.phase == timing::FRAME);
    let mut blocks: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for job in frames {
        let words =
            ["brdf", "method", "samples", "storage_format"].map(|name| job.axes[name].as_str());
        blocks.entry(&job.block).or_default().push(words.join(" "));
    }
    // One block a model: three sample counts and two formats.
    assert_eq!(blocks.len(), 2, "{blocks:?}");
    for members in blocks.values() {
        assert_eq!(members.len(), 5, "{members:?}");
        assert!(
            members.iter().any(|m| m.contains("split-sum"))
                && members.iter().any(|m| m.contains("sampled 40"))
        );
    }
}

#[test]
fn a_reference_under_test_shares_no_points_with_the_one_that_judges_it() {
    let text = "name = \"x\"\nseed = 7\nreference = { samples = 64 }\n[axes]\nmethod = \
                [\"reference\", \"sampled\"]\nsamples = [64]\n";
    let plan = plan(text);
    let [under_test, sampled] = &plan.cells[..] else {
        panic!("{} cells", plan.cells.len())
    };
    let judge = plan.reference_request(&plan.reference_point(&under_test.point));
    let request = plan.request(&under_test.point);
    assert_eq!(
        (judge.shading.method.name, judge.reference_samples),
        (request.shading.method.name, request.reference_samples)
    );
    assert_ne!(judge.seed, request.seed);
    assert_ne!(
        Some(&under_test.radiance),
        under_test.reference.as_ref(),
        "both must not share one image"
    );
    assert_eq!((judge.seed, plan.request(&sampled.point).seed), (7, 7));
}

/// A row of method `reference` states its own samples; the reference that it is compared with may
/// stop earlier.
#[test]
fn a_reference_under_test_does_not_stop_by_itself() {
    let text = |error: &str| {
        format!(
            "name = \"x\"\nreference = {{ samples = 4096{error} }}\n[axes]\nmethod = \
             [\"reference\", \"sampled\"]\nsamples = [64, 128]\ndiffuse = [\"reference\"]\n"
        )
    };
    let (stopping, fixed) = (plan(&text(", relative_error = 0.05")), plan(&text("")));
    for (cell, same) in stopping.cells.iter().zip(&fixed.cells) {
        let is_under_test = cell.point.get("method").text() == "reference";
        let request = stopping.request(&cell.point);
        assert_eq!(request.reference_error, (!is_under_test).then_some(0.05));
        assert_eq!(
            request.reference_samples,
            if is_under_test {
                request.shading.samples
            } else {
                4096
            }
        );
        // The image of a reference under test is the same in both cases, and so is its name.
        assert_eq!(cell.radiance == same.radiance, is_under_test);
        let judge = stopping.reference_request(&stopping.reference_point(&cell.point));
        assert_eq!(judge.reference_error, Some(0.05));
        assert_ne!(cell.reference, same.reference);
    }
}

#[test]
fn tables_of_other_tools_count_by_their_content() {
    let dir = tempfile::tempdir().unwrap();
    // A cube of 8 levels as KTX 1, of one colour. Unity reads 7.
    let bake = |name: &str, value: f32| {
        let levels = [128, 64, 32, 16, 8, 4, 2, 1]
            .map(|side| vec![RgbImage::filled(side, side, [value; 3]); 6]);
        let (texel, format) = (
            &TEXELS[0],
            FORMATS
                .iter()
                .find(|format| format.extension == "ktx")
                .unwrap(),
        );
        let encoding = Encoding {
            texel,
            levels: &levels,
            keys: &[],
            is_packed: false,
        };
        std::fs::write(dir.path().join(name), (format.write)(&encoding)).unwrap();
    };
    bake("a.ktx", 1.0);
    let path = dir.path().join("e.toml");
    let text = |file: &str| {
        format!(
            "name = \"x\"\n[axes]\nprefiltered = [\"own\", \"file:{file}#unity\"]\nmethod = \
             [\"split-sum\", \"sampled\"]\n\
             prefilter_size = [[64, 64], [128, 128]]\n"
        )
    };
    let ids = |file: &str| -> Vec<Id> {
        Plan::from_text(&path, &text(file), &[])
            .unwrap()
            .cells
            .into_iter()
            .map(|cell| cell.id)
            .collect()
    };
    let plan = Plan::from_text(&path, &text("a.ktx"), &[]).unwrap();
    // Our own map at two sizes, the given map at its own size, and a method that reads none.
    assert_eq!(plan.cells.len(), 4);
    let theirs = plan
        .cells
        .iter()
        .find(|cell| cell.point.get("prefiltered").to_string() == "file:a.ktx#unity")
        .unwrap();
    let settings = plan.request(&theirs.point).shading.precompute;
    assert_eq!(
        (
            settings.prefilter_size,
            settings.prefilter_level_count,
            settings.level_mapping.name
        ),
        ([128, 128], 7, "unity")
    );
    assert!(
        plan.reference_request(&plan.reference_point(&theirs.point))
            .given
            .prefiltered
            .is_none()
    );
    let first = ids("a.ktx");
    bake("b.ktx", 1.0);
    assert_eq!(ids("b.ktx"), first);
    bake("a.ktx", 2.0);
    let changed = first
        .iter()
        .zip(&ids("a.ktx"))
        .filter(|(a, b)| a != b)
        .count();
    assert_eq!(changed, 1);
    let error = Plan::from_text(&path, &text("c.ktx"), &[])
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("e.toml:3:23: ") && error.contains("c.ktx: cannot be read"),
        "{error}"
    );
}

/// A list of levels is one value of the axis, in every place that takes it.
#[test]
fn level_mapping_takes_a_list_of_roughnesses() {
    const LIST: &str = "0.08:0.3:1";
    let list = LevelMapping::of_list(&[0.08, 0.3, 1.0]).unwrap();
    let mappings = |text: &str, set: &[&str]| {
        let plan = planned(text, set).unwrap();
        let of_cell = |cell: &Cell| {
            let name = cell.point.get("level_mapping").to_string();
            (name, plan.request(&cell.point).shading.precompute)
        };
        plan.cells.iter().map(of_cell).collect::<Vec<_>>()
    };
    let sweep = "name = \"x\"\n[axes]\nmethod = [\"split-sum\"]\nprefilter_level_count = [3]\n";
    let written = format!("{sweep}level_mapping = [\"linear\", [0.08, 0.30, 1]]\n");
    let whole = format!("{sweep}[precompute]\nlevel_mapping = [0.08, 0.3, 1.0]\n");
    for (cells, expected) in [
        (mappings(&written, &[]), &["linear", LIST][..]),
        (mappings(&whole, &[]), &[LIST][..]),
        (
            mappings(sweep, &[&format!("level_mapping={LIST}")]),
            &[LIST][..],
        ),
        (
            mappings(sweep, &[&format!("level_mapping=unity,{LIST}")]),
            &["unity", LIST][..],
        ),
    ] {
        let names: Vec<&str> = cells.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, expected);
        let (_, settings) = cells.last().unwrap();
        assert_eq!(settings.level_mapping, list);
        assert!((settings.level_mapping.alpha_from_mip(0.0, 3) - 0.0064).abs() < 1e-12);
    }
}
