//! Methods in files: the same code gives the same image, and its bindings determine its parameters.

use crate::harness::{golden_environment, lobe_sphere, request, with_pipeline};
use splitsum::base::names::Listed;
use splitsum::instrument::environment::layout::LAYOUTS;
use splitsum::instrument::gpu::names_read;
use splitsum::instrument::scene::CameraKind;
use splitsum::instrument::shade::pass::specular_shader;
use splitsum::instrument::shade::{METHODS, Method, from_file};
use std::path::Path;

/// The stated parameters of a listed method equal the parameters found in its compiled shader.
#[test]
fn a_shader_determines_the_parameters_of_its_method() {
    for method in METHODS.iter().filter(|method| method.has_pass()) {
        let shader = specular_shader(&LAYOUTS[0], method, splitsum::instrument::brdf::MODELS[0]);
        let found = from_file::of_names_read(
            *method,
            &names_read(&shader, from_file::FUNCTION).unwrap(),
            String::new(),
        );
        let facts = |m: &splitsum::instrument::shade::Method| {
            let points = [m.uses_samples, m.uses_point_set, m.uses_lod_bias];
            (points, [m.uses_prefiltered(), m.uses_dfg], m.tap_table)
        };
        assert_eq!(facts(&found), facts(method), "{}", method.name);
    }
}

/// A copy of a listed method's file is that method, bit for bit.
#[test]
fn a_copied_method_makes_the_same_image() {
    with_pipeline(|pipeline| {
        let folder = Path::new("shaders/shade/method");
        for name in ["split-sum", "sampled"] {
            let copy =
                from_file::load(&format!("file:{}.glsl", name.replace('-', "_")), folder).unwrap();
            let listed = Method::listed(name);
            let base = request(
                &golden_environment(),
                lobe_sphere(0.3),
                CameraKind::Ortho,
                [24, 24],
            );
            let mut frames = [listed, copy].map(|method| {
                pipeline
                    .render(&base.shaded(|s| (s.method, s.samples) = (method, 16)))
                    .unwrap()
                    .radiance
            });
            let [expected, found] = frames.each_mut();
            assert!(expected == found, "{name}");
        }
    });
}
