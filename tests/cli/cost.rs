//! `splitsum cost` and the compiler for GPUs that the machine lacks. Without Mesa's RADV the tests
//! skip with a line.

use super::{assert_ends, command, ok};
use splitsum::base::names::Listed;
use splitsum::cost::child::{CompileFault, available, compile};
use splitsum::cost::family::Family;
use splitsum::cost::isa::Counts;
use splitsum::cost::pass::Pass;
use splitsum::experiment::axis::{LAYOUT, METHOD, Point};
use splitsum::instrument::brdf::MaskingShadowing;
use splitsum::instrument::environment::layout::{LAYOUTS, MapLayout};
use splitsum::instrument::gpu::{ShaderVariant, shader_names};
use splitsum::instrument::shade::{METHODS, Method};
use std::collections::BTreeSet;
use std::path::Path;

fn program() -> &'static Path {
    Path::new(env!("CARGO_BIN_EXE_splitsum"))
}

/// Families that the driver compiles for; without any, prints a line.
fn families() -> Vec<&'static Family> {
    match available(program()) {
        Ok(found) => found.into_iter().map(|(family, _)| family).collect(),
        Err(error @ CompileFault::NoRadv { .. }) => {
            eprintln!("skipped: {error}");
            Vec::new()
        }
        Err(error) => panic!("{error}"),
    }
}

fn counted(family: &'static Family, constants: [u32; 5]) -> Pass {
    let job = ShaderVariant::new("probe/counted.comp".to_owned(), &constants);
    let compiled = compile(program(), family, &[job]).unwrap();
    Pass::new(&compiled[0]).unwrap().unwrap()
}

fn job(method: &Method, layout: &MapLayout) -> ShaderVariant {
    let mut point = Point::default();
    (point[METHOD], point[LAYOUT]) = (method.name.into(), layout.name.into());
    point.settings().specular_variant()
}

#[test]
fn a_shader_of_known_size_is_counted_right() {
    for family in families() {
        let (name, more) = (family.name, |constants| counted(family, constants).counts);
        let base = more([1, 1, 1, 1, 1]);
        let lookups = |counts: Counts| [counts.bilinear, counts.trilinear, counts.quarter];
        assert_eq!(
            [base.outside, base.inside].map(lookups),
            [[1.0, 0.0, 0.0], [0.0, 1.0, 1.0]],
            "{name}"
        );
        assert_eq!(
            (base.other_loops, base.outside.memory_bytes),
            (0, 16.0),
            "{name}"
        );
        // Added products change the full-rate arithmetic at their place, and no other count.
        let products = more([4, 6, 1, 1, 1]);
        let alu = |counts: Counts, more: f64| Counts {
            alu: counts.alu + more,
            scalar: 0.0,
            ..counts
        };
        assert_eq!(alu(products.outside, 0.0), alu(base.outside, 3.0), "{name}");
        assert_eq!(alu(products.inside, 0.0), alu(base.inside, 5.0), "{name}");
        let many = more([1, 1, 3, 5, 1]);
        assert_eq!(
            [many.outside, many.inside].map(lookups),
            [[3.0, 0.0, 0.0], [0.0, 5.0, 1.0]],
            "{name}"
        );
        assert_eq!(more([1, 1, 1, 1, 4]).inside.quarter, 4.0, "{name}");
    }
}

/// A shader that a software driver accepts and AMD's compiler rejects would fail here first.
#[test]
fn every_compute_shader_compiles_for_every_family_and_twice_to_the_same_bytes() {
    for (turn, family) in families().into_iter().enumerate() {
        // Each shader and family has one masking; over all families each shader has every masking.
        let masking = |index: usize| ((index + turn) % MaskingShadowing::all().count()) as u32;
        let compute = shader_names()
            .filter(|name| name.contains(".comp"))
            .enumerate();
        let jobs: Vec<ShaderVariant> = compute
            .map(|(index, shader)| ShaderVariant::new(shader.to_owned(), &[masking(index)]))
            .collect();
        let compiled = compile(program(), family, &jobs).unwrap();
        assert_eq!(compiled.len(), jobs.len());
        for (job, compiled) in jobs.iter().zip(&compiled) {
            for stage in compiled {
                let text = stage.text("Assembly").unwrap_or_default();
                let counts = splitsum::cost::isa::count(text)
                    .unwrap_or_else(|error| panic!("{}: {}: {error}", family.name, job.shader));
                assert!(text.contains("s_endpgm"), "{}: {}", family.name, job.shader);
                let spilled = stage.statistic("Spilled VGPRs");
                assert_eq!(
                    spilled,
                    Some(0.0),
                    "{}: {}: {counts:?}",
                    family.name,
                    job.shader
                );
            }
        }
        // Not from a cache: the second child compiles again.
        let some: Vec<ShaderVariant> = jobs.iter().step_by(20).cloned().collect();
        let again = compile(program(), family, &some).unwrap();
        assert!(
            again.iter().eq(compiled.iter().step_by(20)),
            "{}",
            family.name
        );
    }
}

#[test]
fn the_command_prints_and_writes_its_counts() {
    if families().is_empty() {
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    let arguments = [
        "cost",
        "--method",
        "split-sum",
        "--method",
        "sampled",
        "--family",
        "navi21",
    ];
    let text = ok(
        dir.path(),
        &[&arguments[..], &["--out", "costs.csv"]].concat(),
    );
    assert!(
        text.contains("nothing was executed or timed") && text.contains("Radeon RX 6800 XT"),
        "{text}"
    );
    assert_eq!(text, ok(dir.path(), &arguments));
    let mut rows = csv::Reader::from_path(dir.path().join("costs.csv")).unwrap();
    let headers = rows.headers().unwrap().clone();
    let column = |name: &str| headers.iter().position(|known| known == name).unwrap();
    let rows: Vec<csv::StringRecord> = rows.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 2);
    let number = |row: &csv::StringRecord, name: &str| row[column(name)].parse::<f64>().unwrap();
    for row in &rows {
        // A map and a table, or a lookup a sample.
        let is_sampled = &row[column("method")] == "sampled";
        let lookups = ["outside_bilinear", "outside_trilinear", "inside_trilinear"]
            .map(|name| number(row, name));
        assert_eq!(
            lookups,
            if is_sampled {
                [0.0, 0.0, 1.0]
            } else {
                [1.0, 1.0, 0.0]
            }
        );
        let shown = format!("{} ", number(row, "outside_alu"));
        assert!(
            text.lines()
                .any(|line| line.contains(&row[column("method")]) && line.contains(&shown)),
            "{text}"
        );
    }
}

/// If the hardware filters maps, the unfiltered texels outside the loop are the g-buffer's
/// position, normal and F0. Buffer traffic is the radiance, a vec4 of 32-bit floats, read and
/// written.
#[test]
fn a_pass_reads_and_writes_as_in_its_code() {
    for family in families() {
        let methods = METHODS
            .iter()
            .filter(|method| method.has_pass() && !method.name.starts_with("ladder"));
        let jobs: Vec<ShaderVariant> = methods.map(|method| job(method, &LAYOUTS[0])).collect();
        for (job, compiled) in jobs.iter().zip(compile(program(), family, &jobs).unwrap()) {
            let counts = Pass::new(&compiled).unwrap().unwrap().counts.outside;
            assert_eq!(
                [counts.unfiltered, counts.memory_bytes],
                [3.0, 32.0],
                "{}: {}",
                family.name,
                job.shader
            );
        }
    }
}

/// Options compile what they name. A method in a file with the text of a built-in method has its
/// code. Sampling has other code for each masking.
#[test]
fn options_compile_what_they_name() {
    if families().is_empty() {
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(
        dir.path().join("own.glsl"),
        include_str!("../../shaders/shade/method/split_sum.glsl"),
    )
    .unwrap();
    let rows = |arguments: &[&str]| -> Vec<csv::StringRecord> {
        ok(
            dir.path(),
            &[&["cost", "--out", "costs.csv"], arguments].concat(),
        );
        let mut rows = csv::Reader::from_path(dir.path().join("costs.csv")).unwrap();
        rows.records().map(Result::unwrap).collect()
    };
    let both = rows(&[
        "--method",
        "split-sum,file:own.glsl",
        "--level-mapping",
        "quadratic",
    ]);
    let code = |row: &csv::StringRecord| row.iter().skip(5).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(code(&both[0]), code(&both[1]));
    assert_eq!(
        [&both[0][7], &both[1][4]],
        ["level_mapping=quadratic", "file:own.glsl"]
    );
    // For ggx, separable and smith-exact masking are the same function.
    let counts = |masking: &&str| {
        let rows = rows(&[
            "--method",
            "sampled",
            "--brdf",
            "beckmann",
            "--masking",
            masking,
        ]);
        rows[0]
            .iter()
            .skip(8)
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let maskings = MaskingShadowing::names();
    let distinct: BTreeSet<Vec<String>> = maskings.iter().map(counts).collect();
    assert_eq!(distinct.len(), maskings.len(), "{distinct:?}");
}

#[test]
fn bad_names_and_a_missing_compiler_are_reported() {
    let dir = tempfile::tempdir().unwrap();
    let mut blind = command(dir.path(), &["cost"]);
    blind
        .env("VK_DRIVER_FILES", "/nonexistent")
        .env("VK_ICD_FILENAMES", "/nonexistent");
    assert_ends(
        &blind.output().unwrap(),
        2,
        &["RADV", "mesa-vulkan-drivers", "VK_DRIVER_FILES"],
    );
}
