//! Pictures of what lies between scene and image, against closed forms and the tables themselves.

use crate::harness::{request, with_pipeline};
use glam::{DVec3, Vec3};
use splitsum::base::names::Listed;
use splitsum::base::pixels::RgbImage;
use splitsum::instrument::brdf::MODELS;
use splitsum::instrument::environment::Environment;
use splitsum::instrument::environment::layout::LAYOUTS;
use splitsum::instrument::pipeline::{Intermediate, RenderRequest, Selection};
use splitsum::instrument::scene::{CameraKind, MaterialOverride, Scene};
use splitsum::instrument::shade::{Diffuse, Method};
use splitsum::instrument::tonemap::ToneCurve;
use std::collections::BTreeMap;
use std::sync::Arc;

const SIZE: [u32; 2] = [48, 32];
const CENTER: DVec3 = DVec3::new(1.0, 2.0, 3.0);
const RADIUS: f64 = 1.5;

fn sphere(environment: RgbImage) -> RenderRequest {
    let material = MaterialOverride {
        albedo: Some([0.75, 0.5, 0.25]),
        f0: Some([0.25; 3]),
        metallic: Some(0.5),
        alpha: Some(0.125),
        ..MaterialOverride::default()
    };
    let environment = Arc::new(Environment::from_image("test", environment));
    let mut scene = Scene::sphere().apply(&material);
    scene.spheres[0].center = CENTER;
    scene.spheres[0].radius = RADIUS;
    request(&environment, scene, CameraKind::Ortho, SIZE).shaded(|shading| {
        shading.method = Method::listed("split-sum");
        shading.diffuse = Diffuse::listed("sh9");
    })
}

fn grey(radiance: f32) -> RgbImage {
    RgbImage::filled(16, 8, [radiance; 3])
}

#[test]
fn attachments_are_the_material_and_the_exact_sphere() {
    with_pipeline(|pipeline| {
        let request = sphere(grey(1.0));
        let frame = pipeline.render(&request).unwrap();
        let mut image_of = |intermediate: Intermediate| {
            let image = pipeline
                .intermediate(&request, intermediate.into())
                .unwrap();
            assert_eq!(image.mask, frame.mask);
            image.values
        };
        let [position, normal] = [Intermediate::Position, Intermediate::Normal].map(&mut image_of);
        // Attachment 3 has mix(f0, albedo, metallic).
        let constants = [
            (Intermediate::Albedo, [0.75, 0.5, 0.25]),
            (Intermediate::F0, [0.5, 0.375, 0.25]),
            (Intermediate::Alpha, [0.125; 3]),
            (Intermediate::Metallic, [0.5; 3]),
            (Intermediate::Occlusion, [1.0; 3]),
        ]
        .map(|(intermediate, value)| (image_of(intermediate), value));
        for (pixel, covered) in frame.mask.data.iter().enumerate() {
            let [position, normal] =
                [&position, &normal].map(|image| Vec3::from_array(image.data[pixel]));
            let surface = CENTER.as_vec3() + RADIUS as f32 * normal;
            assert!((position - covered * surface).length() < 1e-5);
            assert!((normal.length() - covered).abs() < 1e-5);
            for (image, value) in &constants {
                assert_eq!(image.data[pixel], value.map(|channel| channel * covered));
            }
        }
    });
}

/// Opposite to a lamp nine coefficients fall below 0, where shading takes 0.
#[test]
fn irradiance_is_what_shading_reads() {
    with_pipeline(|pipeline| {
        let lamp = RgbImage::from_fn(16, 8, |x, y| [f32::from(u8::from([x, y] == [4, 2])); 3]);
        let [exact, texture] = ["sh9", "sh9-texture"].map(|diffuse| {
            let request =
                sphere(lamp.clone()).shaded(|shading| shading.diffuse = Diffuse::listed(diffuse));
            let selection = Selection::parse("irradiance").unwrap();
            pipeline.intermediate(&request, selection).unwrap().values
        });
        let brightest = exact.data.iter().map(|rgb| rgb[0]).fold(0.0, f32::max);
        let mut difference: f32 = 0.0;
        for (a, b) in exact.data.iter().zip(&texture.data) {
            assert!(a[0] >= 0.0 && b[0] >= 0.0, "{a:?} {b:?}");
            difference = difference.max((a[0] - b[0]).abs() / brightest);
        }
        // A lookup in the texture is not the evaluation, but nearly.
        assert!(difference > 0.0 && difference < 1e-2, "{difference}");
    });
}

#[test]
fn maps_of_constant_light_are_constant_and_a_lamp_keeps_its_place() {
    with_pipeline(|pipeline| {
        for layout in LAYOUTS {
            let with_diffuse = |environment: RgbImage, diffuse: &str| {
                sphere(environment).shaded(|shading| {
                    shading.precompute.layout = layout;
                    shading.precompute.prefilter_size = layout.prefilter_size;
                    shading.precompute.irradiance_size = layout.irradiance_size;
                    shading.diffuse = Diffuse::listed(diffuse);
                })
            };
            let cases = [
                ("sh9", "irradiance"),
                ("sh9-texture", "irradiance"),
                ("irradiance-map", "irradiance"),
                ("none", "prefiltered"),
                ("none", "prefiltered-2"),
            ];
            for (diffuse, name) in cases {
                let selection = Selection::parse(name).unwrap();
                assert_eq!(selection.to_string(), name);
                let request = with_diffuse(grey(0.5), diffuse);
                let image = pipeline.intermediate(&request, selection).unwrap();
                let covered = image.mask.data.iter().filter(|&&mask| mask == 1.0).count();
                assert!(
                    covered >= SIZE.iter().product::<u32>() as usize / 2,
                    "{name}"
                );
                for (rgb, mask) in image.values.data.iter().zip(&image.mask.data) {
                    assert!(
                        rgb.iter().all(|x| (x - 0.5 * mask).abs() < 2e-3),
                        "{name} {rgb:?}"
                    );
                }
            }
            // A lat-long of 48 x 24 pixels begins in row 4; the lamp covers texel (4, 2) of 16 x 8.
            let lamp = RgbImage::from_fn(16, 8, |x, y| [f32::from(u8::from([x, y] == [4, 2])); 3]);
            let request = with_diffuse(lamp, "none");
            let level = Selection::parse("prefiltered-0").unwrap();
            let image = pipeline.intermediate(&request, level).unwrap();
            let brightest = (0..image.values.data.len())
                .max_by(|a, b| {
                    let [a, b] = [a, b].map(|pixel| image.values.data[*pixel][0]);
                    a.total_cmp(&b)
                })
                .unwrap() as u32;
            let [x, y] = [brightest % SIZE[0], brightest / SIZE[0]];
            assert!(
                (12..15).contains(&x) && (10..13).contains(&y),
                "{}: {x}, {y}",
                layout.name
            );
        }
    });
}

#[test]
fn the_dfg_table_is_shown_texel_by_texel() {
    with_pipeline(|pipeline| {
        let request = RenderRequest {
            size: [32, 32],
            ..sphere(grey(1.0))
        };
        let tables = pipeline.light_tables(&request, 1, &[]).unwrap();
        let image = pipeline
            .intermediate(&request, Intermediate::Dfg.into())
            .unwrap();
        let [width, height] = [tables.dfg.width, tables.dfg.height];
        for [x, y] in [[0, 0], [31, 0], [0, 31], [9, 20], [31, 31]] {
            let [a, b] = tables
                .dfg
                .get((2 * x + 1) * width / 64, (2 * y + 1) * height / 64);
            assert_eq!(image.values.get(x, y), [a, b, 0.0]);
        }
        let picture = image
            .picture(pipeline, ToneCurve::default(), [9; 3])
            .unwrap();
        let [a, b] = tables.dfg.get(width / 64, height / 64);
        let byte = |x: f32| (255.0 * x).round() as u8;
        assert_eq!(picture.get(0, 0), [byte(a), byte(b), 0]);
    });
}

#[test]
fn tables_that_a_method_does_not_read_are_refused() {
    let request = sphere(grey(1.0));
    let fault = |method: &str, diffuse: &str, show: &str| {
        let request = request.shaded(|shading| {
            shading.method = Method::listed(method);
            shading.diffuse = Diffuse::listed(diffuse);
        });
        Selection::parse(show).unwrap().fault(&request)
    };
    assert_eq!(fault("split-sum", "sh9", "prefiltered"), None);
    assert_eq!(fault("split-sum", "none", "dfg"), None);
    for (method, diffuse, show) in [
        ("sampled", "none", "prefiltered"),
        ("sampled", "none", "dfg"),
        ("split-sum", "none", "irradiance"),
        ("split-sum", "reference", "irradiance"),
        ("split-sum", "none", "prefiltered-9"),
    ] {
        assert!(
            fault(method, diffuse, show).is_some(),
            "{method} {diffuse} {show}"
        );
    }
    for wrong in ["prefiltered-", "prefiltered--1", "dfg-1", "mirror", ""] {
        assert!(Selection::parse(wrong).is_err(), "{wrong}");
    }
}

/// A run keeps one picture for all images with one key.
#[test]
fn pictures_with_one_key_have_one_value() {
    let ramp = RgbImage::from_fn(16, 8, |x, y| [x as f32, y as f32, 1.0]);
    let base = sphere(ramp);
    let material = MaterialOverride {
        alpha: Some(0.5),
        ..MaterialOverride::default()
    };
    let with_scene = |scene: Scene| RenderRequest {
        scene: Arc::new(scene),
        ..base.clone()
    };
    let requests = [
        base.clone(),
        // What no picture depends on.
        base.shaded(|s| (s.samples, s.point_set, s.environment_scale) = (3, 1, 2.0)),
        base.shaded(|s| s.method = Method::listed("sampled")),
        // What some depend on.
        base.shaded(|s| s.brdf = MODELS[1]),
        base.shaded(|s| s.diffuse = Diffuse::listed("irradiance-map")),
        base.shaded(|s| s.precompute.prefilter_level_count -= 1),
        base.shaded(|s| s.precompute.dfg_size /= 2),
        with_scene(base.scene.apply(&material)),
        RenderRequest {
            size: [32, 48],
            ..base.clone()
        },
        RenderRequest {
            environment: sphere(grey(1.0)).environment,
            ..base.clone()
        },
    ];
    with_pipeline(|pipeline| {
        let mut known: BTreeMap<String, RgbImage> = BTreeMap::new();
        for (index, request) in requests.iter().enumerate() {
            for selection in Selection::all(request) {
                let size = selection.fitted_size(request);
                let image = pipeline
                    .intermediate_of_size(request, selection, size)
                    .unwrap();
                let is_attachment = selection.intermediate.is_attachment();
                let wanted = if is_attachment { request.size } else { size };
                assert_eq!([image.values.width, image.values.height], wanted);
                let key = selection.key(request);
                let first = known.entry(key).or_insert_with(|| image.values.clone());
                assert!(*first == image.values, "{selection} of request {index}");
            }
        }
        let count = |name: &str| known.keys().filter(|key| key.starts_with(name)).count();
        // By scene and size; by environment and kind; by model, environment and levels; by model
        // and size.
        assert_eq!(count("normal "), 3);
        assert_eq!(count("irradiance "), 3);
        assert_eq!(count("prefiltered-1 "), 4);
        assert_eq!(count("dfg "), 3);
    });
}
