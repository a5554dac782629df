//! Names of axes: a second name is another way to write values of the first.

use super::planned;
use splitsum::experiment::axis::{ALPHA, F0};
use splitsum::experiment::value::{ALPHA_MIN, Value};
use splitsum::experiment::{Id, Plan};

fn plan(axes: &str, set: &[&str]) -> Plan {
    planned(&format!("name = \"x\"\n[axes]\n{axes}\n"), set)
        .unwrap_or_else(|error| panic!("{error}"))
}

fn ids(plan: &Plan) -> Vec<Id> {
    plan.cells.iter().map(|cell| cell.id).collect()
}

#[test]
fn perceptual_roughness_makes_the_cells_of_its_square() {
    let alphas = plan("alpha = [0.01, 0.09, 0.25, 0.49, 1]", &[]);
    let roughnesses = plan("perceptual_roughness = [0.1, 0.3, 0.5, 0.7, 1]", &[]);
    assert_eq!(
        (ids(&roughnesses), &roughnesses.hash),
        (ids(&alphas), &alphas.hash)
    );
    // The narrowest lobe, the command line, an exclusion and a zip.
    let narrowest = plan("perceptual_roughness = [0.0316227766016838]", &[]);
    assert_eq!(narrowest.cells[0].point[ALPHA].number(), ALPHA_MIN);
    assert_eq!(
        ids(&plan("alpha = [0.3]", &["perceptual_roughness=0.1,0.3"])),
        ids(&alphas)[..2]
    );
    let excluded =
        "alpha = [0.01, 0.09, 0.25]\n[[exclude]]\nperceptual_roughness = 0.5\nwhy = \"too wide\"";
    assert_eq!(ids(&plan(excluded, &[])), ids(&alphas)[..2]);
    let zipped = "perceptual_roughness = [0.1, 0.3]\nmetallic = [0, 1]\n[[zip]]\naxes = \
                  [\"perceptual_roughness\", \"metallic\"]";
    assert_eq!(plan(zipped, &[]).cells.len(), 2);
}

#[test]
fn an_index_makes_the_cells_of_its_f0() {
    // By ((1 - n)/(1 + n))², by hand: 1.5 is 1/25, 3 is 1/4, 1 is 0.
    let indices = plan("ior = [1.5, 3, 1]", &[]);
    assert_eq!(ids(&indices), ids(&plan("f0 = [0.04, 0.25, 0]", &[])));
    assert_eq!(ids(&plan("f0 = [1]", &["ior=1.5,3,1"])), ids(&indices));
    let by_channel = plan("ior = [[1.5, 3, 1]]", &[]);
    assert_eq!(
        by_channel.cells[0].point[F0],
        Value::Color([0.04, 0.25, 0.0])
    );
    let label = |text: &str| {
        let plan = plan(text, &[]);
        plan.label(&plan.cells[0])
    };
    // f32 holds neither 1.33 nor its F0.
    assert_eq!(label("ior = [1.33, 1.4]"), "ior=1.33");
    assert_eq!(label("f0 = [0.04, 0.25]"), "f0=0.04");
}

#[test]
fn cells_are_labelled_by_the_name_that_the_experiment_uses() {
    let labels = |text: &str, set: &[&str]| {
        let plan = plan(text, set);
        plan.cells
            .iter()
            .map(|cell| plan.label(cell))
            .collect::<Vec<_>>()
    };
    let rough = ["perceptual_roughness=0.3", "perceptual_roughness=0.5"];
    assert_eq!(labels("perceptual_roughness = [0.3, 0.5]", &[]), rough);
    assert_eq!(
        labels("alpha = [1]", &["perceptual_roughness=0.3,0.5"]),
        rough
    );
    assert_eq!(
        labels("alpha = [0.09, 0.25]", &[]),
        ["alpha=0.09", "alpha=0.25"]
    );
}

/// A method in a file is identified by its text: a renamed file keeps its cells; a changed file
/// loses its cells but no reference.
#[test]
fn a_method_in_a_file_counts_by_its_text() {
    let dir = tempfile::tempdir().unwrap();
    let text = "#include \"lib/split_sum.glsl\"\nvec3 specular_radiance(Surface s) { return \
                reflectance(s); }\n";
    let changed = text.replace("reflectance(s)", "2.0 * reflectance(s)");
    for (name, text) in [("a.glsl", text), ("b.glsl", text), ("c.glsl", &changed)] {
        std::fs::write(dir.path().join(name), text).unwrap();
    }
    let cell = |name: &str| {
        let text =
            format!("name = \"x\"\n[axes]\nmethod = [\"file:{name}\"]\nsamples = [1, 2, 4]\n");
        let plan = Plan::from_text(&dir.path().join("e.toml"), &text, &[])
            .unwrap_or_else(|error| panic!("{error}"));
        // It reads no sample count: three counts are one cell.
        assert_eq!(plan.cells.len(), 1);
        plan.cells[0].clone()
    };
    let [a, b, c] = ["a.glsl", "b.glsl", "c.glsl"].map(cell);
    assert_eq!((&a.radiance, &a.reference), (&b.radiance, &b.reference));
    assert_eq!(a.reference, c.reference);
    assert_ne!(a.radiance, c.radiance);
}
