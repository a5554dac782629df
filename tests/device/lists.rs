//! The shader folders and the Rust lists name the same things: adding one without the other fails here.

use splitsum::brdf::MODELS;
use splitsum::gpu::{BRDF_STEMS, DIFFUSE_STEMS, METHOD_STEMS, has_shader};
use splitsum::shade::{DIFFUSE, METHODS};
use std::collections::BTreeSet;

/// Names without a file of their own: nothing is shaded, or shade/reference.comp does it.
const WITHOUT_FILE: [&str; 2] = ["none", "reference"];

fn assert_same(what: &str, files: &[&'static str], names: impl Iterator<Item = &'static str>) {
    let names: Vec<_> = names.filter(|name| !WITHOUT_FILE.contains(name)).collect();
    let set = |list: &[&'static str]| list.iter().copied().collect::<BTreeSet<_>>();
    assert_eq!(set(files), set(&names), "{what}: shader files against the Rust list");
    assert_eq!((set(files).len(), set(&names).len()), (files.len(), names.len()), "{what}: a name twice");
}

#[test]
fn every_listed_name_has_its_shader_and_every_shader_is_listed() {
    assert_same("brdf", BRDF_STEMS, MODELS.iter().map(|model| model.name()));
    assert_same("method", METHOD_STEMS, METHODS.iter().map(|method| method.name));
    assert_same("diffuse", DIFFUSE_STEMS, DIFFUSE.iter().map(|diffuse| diffuse.name));
}

#[test]
fn every_model_has_every_permutation() {
    for model in MODELS {
        for entry in [
            "probe/brdf.comp",
            "precompute/dfg.comp",
            "precompute/prefilter.comp",
            "shade/lights.comp",
            "shade/specular.comp:sampled",
            "shade/reference.comp:specular",
            "shade/reference_resolve.comp:specular",
        ] {
            let name = format!("{entry}:{}", model.name());
            assert!(has_shader(&name), "{name}");
        }
    }
}
