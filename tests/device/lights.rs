//! Direct lights: every model, layer and compensation against f64; closed forms; and lights that
//! stand for a map against the reference under it.

use crate::brdf_twins::{factor, multiple, reflectance};
use crate::compare::{Tolerance, Worst, relative};
use crate::gltf_files::{load, sheet};
use crate::harness::{
    constant_environment, render_by_seeds, request, scene, with_gpu, with_pipeline,
};
use crate::methods::{Sight, radiance, sights};
use crate::symmetry::smooth_environment;
use crate::tables::dfg_table;
use glam::{DVec2, DVec3};
use serde_json::json;
use splitsum::base::math::equirect::direction_from_uv;
use splitsum::base::names::Listed;
use splitsum::base::pixels::Pixels;
use splitsum::instrument::brdf::{
    Brdf, Compensation, FresnelWeight, MODELS, MaskingShadowing, SheenVisibility, WidthLaw,
    f_schlick,
};
use splitsum::instrument::pipeline::{Frame, RenderRequest};
use splitsum::instrument::precompute::PrecomputeSettings;
use splitsum::instrument::precompute::dfg::reference::dfg;
use splitsum::instrument::scene::light::{Cone, Emitter, LightUnit};
use splitsum::instrument::scene::{CameraKind, Light, MaterialOverride, Scene};
use splitsum::instrument::shade::coat::{COAT_F0, COAT_RENDERERS, CoatLayering};
use splitsum::instrument::shade::lights::{diffuse, specular, weighted_diffuse};
use splitsum::instrument::shade::reference::Surface;
use splitsum::instrument::shade::{Diffuse, METHODS, Method};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// f32 of the device; narrow lobes amplify the rounding of their half vectors.
const ROUNDING: f64 = 2e-4;

fn light(emitter: Emitter, color: [f32; 3]) -> Light {
    Light {
        emitter,
        color,
        unit: LightUnit::Absolute,
        range: None,
    }
}

/// A light of each kind, of other colours; the last one has a range.
fn three_lights() -> Vec<Light> {
    let spot = Emitter::Spot {
        position: DVec3::new(1.5, 2.0, 3.0),
        direction: DVec3::new(-1.4, -1.6, -2.7).normalize(),
        cone: Cone {
            inner: 0.1,
            outer: 0.35,
        },
    };
    let point = Emitter::Point {
        position: DVec3::new(-1.5, 0.5, 1.5),
    };
    vec![
        Light::directional(DVec3::new(-0.3, -1.0, -0.8).normalize(), [3.0, 2.0, 1.0]),
        light(spot, [9.0, 30.0, 20.0]),
        Light {
            range: Some(4.0),
            ..light(point, [2.0, 1.0, 5.0])
        },
    ]
}

/// A request that shows direct lights alone: the environment is black.
fn under(lights: Vec<Light>, scene: Scene, size: u32) -> RenderRequest {
    let dark = constant_environment([0.0; 3]);
    let plain = request(
        &dark,
        scene.lit_by(lights),
        CameraKind::Perspective,
        [size; 2],
    );
    RenderRequest {
        reference_samples: 8,
        ..plain
    }
    .shaded(|s| (s.method, s.diffuse) = (Method::listed("reference"), Diffuse::listed("reference")))
}

fn plastic(alpha: f32) -> MaterialOverride {
    MaterialOverride {
        albedo: Some([0.8, 0.4, 0.2]),
        metallic: Some(0.25),
        alpha: Some(alpha),
        f0: Some([0.04, 0.05, 0.06]),
        ..MaterialOverride::default()
    }
}

#[test]
fn every_model_matches_its_f64_twin() {
    with_pipeline(|pipeline| {
        let lights = three_lights();
        for model in MODELS {
            for masking in MaskingShadowing::all() {
                let name = format!("{} {masking:?}", model.name());
                // Tails of Beckmann's lobe underflow.
                let tolerance = Tolerance {
                    floor: 1e-12,
                    ..relative(ROUNDING)
                };
                let mut worst = Worst::new(name, tolerance);
                for alpha in [0.02, 0.3, 1.0] {
                    let sphere = scene("sphere", plastic(alpha));
                    let request = under(lights.clone(), sphere, 15).shaded(|s| {
                        (s.brdf, s.masking_shadowing) = (*model, *masking);
                        s.diffuse = Diffuse::listed("none");
                    });
                    let frame = pipeline.render(&request).unwrap();
                    for sight in sights(&request, 1) {
                        let expected = specular(&sight.surface, sight.position, &lights);
                        worst.add_rgb(radiance(&frame, sight.pixel), expected, || {
                            format!("alpha {alpha} {:?}", sight.pixel)
                        });
                    }
                }
                worst.check();
            }
        }
    });
}

#[test]
fn lobes_of_two_widths_match_their_f64_twin() {
    with_pipeline(|pipeline| {
        let lights = three_lights();
        for law in WidthLaw::all() {
            let mut worst = Worst::new(format!("{law:?}"), relative(ROUNDING));
            let material = MaterialOverride {
                anisotropy: Some(0.7),
                anisotropy_turn: Some(0.5),
                ..plastic(0.25)
            };
            let request = under(lights.clone(), scene("sphere", material), 15).shaded(|s| {
                s.widths = *law;
                s.diffuse = Diffuse::listed("none");
            });
            let frame = pipeline.render(&request).unwrap();
            for sight in sights(&request, 1) {
                let expected = specular(&sight.surface, sight.position, &lights);
                worst.add_rgb(radiance(&frame, sight.pixel), expected, || {
                    format!("{:?}", sight.pixel)
                });
            }
            worst.check();
        }
    });
}

/// The DFG table of a request on the device, and its mean albedo as shaders compute it.
struct Table {
    pixels: Pixels<DVec2>,
    settings: PrecomputeSettings,
    alpha: f64,
}

impl Table {
    fn pair(&self, cosine: f64) -> DVec2 {
        let axes = self.settings.dfg_axes;
        axes.lookup(&self.pixels, cosine, self.alpha)
    }

    fn albedo(&self, cosine: f64) -> f64 {
        self.pair(cosine).element_sum().min(1.0)
    }

    fn mean_albedo(&self) -> f64 {
        let node = |i: u32| (f64::from(i) + 0.5) / 64.0;
        (0..64)
            .map(|i| 2.0 * node(i) / 64.0 * self.albedo(node(i)))
            .sum()
    }
}

/// Both terms, with each compensation and each diffuse lobe.
#[test]
fn compensations_and_diffuse_lobes_match_their_f64_twins() {
    const ALPHA: f32 = 0.6;
    let lights = three_lights();
    with_gpu(|gpu| {
        with_pipeline(|pipeline| {
            for compensation in Compensation::all() {
                for inside in [false, true] {
                    let name = format!("{compensation:?} inside {inside}");
                    let mut worst = Worst::new(name, relative(2e-3));
                    let sphere = scene("sphere", plastic(ALPHA));
                    let request = under(lights.clone(), sphere, 13).shaded(|s| {
                        s.compensation = *compensation;
                        s.precompute = PrecomputeSettings::default();
                        if inside {
                            s.diffuse = Diffuse::listed("fresnel-inside");
                        }
                    });
                    let settings = request.shading.precompute;
                    let shading = &request.shading;
                    let table = Table {
                        pixels: dfg_table(gpu, shading.brdf, shading.masking_shadowing, &settings),
                        settings,
                        alpha: ALPHA.into(),
                    };
                    let frame = pipeline.render(&request).unwrap();
                    for sight in sights(&request, 1) {
                        let expected = both_terms(&sight, &lights, &table, *compensation, inside);
                        worst.add_rgb(radiance(&frame, sight.pixel), expected, || {
                            format!("{:?}", sight.pixel)
                        });
                    }
                    worst.check();
                }
            }
        });
    });
}

/// Specular and diffuse radiance of a surface that is a quarter metal.
fn both_terms(
    sight: &Sight,
    lights: &[Light],
    table: &Table,
    compensation: Compensation,
    is_fresnel_inside: bool,
) -> DVec3 {
    let Surface { n, v, f0, .. } = sight.surface;
    let pair = table.pair(n.dot(v));
    let mean = table.mean_albedo();
    let factor = factor(compensation, FresnelWeight::Schlick, f0, pair, mean);
    let glossy = factor * specular(&sight.surface, sight.position, lights);
    let body = 0.75 * sight.albedo;
    if is_fresnel_inside {
        let transmitted = |l: DVec3| DVec3::ONE - f_schlick(f0, v.dot((v + l).normalize()));
        return glossy + body * weighted_diffuse(n, sight.position, lights, transmitted);
    }
    let transmitted =
        body * (DVec3::ONE - reflectance(compensation, FresnelWeight::Schlick, f0, pair, mean));
    let added = multiple(compensation, FresnelWeight::Schlick, f0, pair, mean);
    let weight = |l: DVec3| match compensation {
        Compensation::KullaConty => {
            let lost = (1.0 - table.albedo(n.dot(l).max(0.0))) / (1.0 - mean);
            transmitted + added * lost
        }
        _ => transmitted + added,
    };
    glossy + weighted_diffuse(n, sight.position, lights, weight)
}

/// The sum of sheen over the base, under a coat, for both visibilities, layerings and every
/// renderer of coats: direct lights are exact for each.
#[test]
fn layers_match_their_f64_twins() {
    const COLOR: [f32; 3] = [0.9, 0.5, 0.25];
    const SHEEN_ALPHA: f64 = 0.25;
    const COAT_ALPHA: f32 = 0.2;
    const WEIGHT: f64 = 0.75;
    let lights = three_lights();
    with_pipeline(|pipeline| {
        for (index, renderer) in COAT_RENDERERS.iter().enumerate() {
            let visibility = SheenVisibility::all().nth(index % 2).unwrap();
            let layering = CoatLayering::all().nth(index % 2).unwrap();
            let material = MaterialOverride {
                coat: Some(WEIGHT as f32),
                coat_alpha: Some(COAT_ALPHA),
                sheen_color: Some(COLOR),
                sheen_alpha: Some(SHEEN_ALPHA as f32),
                ..plastic(0.5)
            };
            let request = under(lights.clone(), scene("sphere", material), 11).shaded(|s| {
                (s.sheen_visibility, s.coat_layering) = (*visibility, *layering);
                (s.coat_renderer, s.method) = (renderer, Method::listed("split-sum"));
                s.diffuse = Diffuse::listed("sh9");
            });
            let frame = pipeline.render(&request).unwrap();
            let mut worst = Worst::new(renderer.name, relative(2e-3));
            for sight in sights(&request, 3) {
                let Surface {
                    model,
                    masking,
                    n,
                    v,
                    alpha,
                    f0,
                    ..
                } = sight.surface;
                let place = sight.position;
                let of = |alpha: f64| dfg(model, masking, n.dot(v), alpha);
                let base = of(alpha);
                let body = 0.75 * sight.albedo * (DVec3::ONE - f0 * base.f0_scale - base.f90_scale);
                let under =
                    specular(&sight.surface, place, &lights) + body * diffuse(n, place, &lights);
                let white = |model: &'static dyn Brdf, masking, alpha: f64| {
                    let lobe = Surface::new(model, masking, alpha, DVec3::ONE, [n, v]);
                    specular(&lobe, place, &lights)
                };
                let correlated = MaskingShadowing::Correlated;
                let color = DVec3::from_array(COLOR.map(f64::from));
                let albedo = dfg(visibility, correlated, n.dot(v), SHEEN_ALPHA).albedo();
                let cloth = color * white(visibility, correlated, SHEEN_ALPHA)
                    + (1.0 - color.x * albedo).max(0.0) * under;
                let coat = of(COAT_ALPHA.into());
                let fresnel = f_schlick(DVec3::splat(COAT_F0), n.dot(v)).x;
                let (lost, over) = match layering {
                    CoatLayering::Khr => {
                        (fresnel, fresnel * white(model, masking, COAT_ALPHA.into()))
                    }
                    CoatLayering::Albedo => {
                        let f0 = DVec3::splat(COAT_F0);
                        let lobe = Surface::new(model, masking, COAT_ALPHA.into(), f0, [n, v]);
                        let lost = COAT_F0 * coat.f0_scale + coat.f90_scale;
                        (lost, specular(&lobe, place, &lights))
                    }
                };
                let expected = (1.0 - WEIGHT * lost) * cloth + WEIGHT * over;
                worst.add_rgb(radiance(&frame, sight.pixel), expected, || {
                    format!("{visibility:?} {layering:?} {:?}", sight.pixel)
                });
            }
            worst.check();
        }
    });
}

/// A Lambert surface of albedo a under irradiance E shows a E cos / π; a point light of intensity I
/// at distance d gives E = I / d²; a spot falls off to its edge. The test has its own formulas.
#[test]
fn closed_forms() {
    let albedo = [0.5f32, 0.25, 1.0];
    let body = MaterialOverride {
        albedo: Some(albedo),
        metallic: Some(0.0),
        ..MaterialOverride::default()
    };
    let position = DVec3::new(0.5, 1.0, 3.0);
    let axis = DVec3::new(-0.4, -0.9, -2.2).normalize();
    let (inner, outer) = (0.08f64, 0.2f64);
    let cone = Cone { inner, outer };
    let direction = axis;
    let sun = DVec3::new(1.0, 2.0, 3.0).normalize();
    let color = [4.0f32, 5.0, 6.0];
    let cases = [
        ("directional", Light::directional(-sun, color)),
        ("point", light(Emitter::Point { position }, color)),
        (
            "spot",
            light(
                Emitter::Spot {
                    position,
                    direction,
                    cone,
                },
                color,
            ),
        ),
        (
            "range",
            Light {
                range: Some(2.6),
                ..light(Emitter::Point { position }, color)
            },
        ),
    ];
    with_pipeline(|pipeline| {
        for (name, light) in cases {
            let request = under(vec![light], scene("sphere", body), 41);
            let request = request.shaded(|s| s.method = Method::listed("none"));
            let frame = pipeline.render(&request).unwrap();
            // Next to the edge of a cone the rounding of positions counts.
            let tolerance = Tolerance {
                floor: 1e-7,
                ..relative(1e-4)
            };
            let mut worst = Worst::new(name, tolerance);
            let mut shares = [0u32; 3];
            for sight in sights(&request, 1) {
                let to_light = position - sight.position;
                let distance = to_light.length();
                let l = to_light / distance;
                let (l, share) = match name {
                    "directional" => (sun, 1.0),
                    "point" => (l, 1.0 / distance.powi(2)),
                    "range" => {
                        let window = (1.0 - (distance / 2.6).powi(4)).max(0.0);
                        (l, window / distance.powi(2))
                    }
                    _ => {
                        let cosine = (-l).dot(axis);
                        let edge = (cosine - outer.cos()) / (inner.cos() - outer.cos());
                        let edge = edge.clamp(0.0, 1.0).powi(2);
                        shares[if edge == 0.0 {
                            0
                        } else if edge == 1.0 {
                            2
                        } else {
                            1
                        }] += 1;
                        (l, edge / distance.powi(2))
                    }
                };
                let cosine = sight.surface.n.dot(l).max(0.0);
                let expected = DVec3::from_array(
                    [0, 1, 2]
                        .map(|c| f64::from(albedo[c]) / PI * f64::from(color[c]) * share * cosine),
                );
                worst.add_rgb(radiance(&frame, sight.pixel), expected, || {
                    format!("{:?}", sight.pixel)
                });
            }
            worst.check();
            let has_all = name != "spot" || shares.iter().all(|count| *count > 10);
            assert!(has_all, "pixels out of, at and in the cone: {shares:?}");
        }
    });
}

/// Lights of a map: one for each texel, with its radiance times its solid angle.
fn lights_of_map(width: u32, height: u32, radiance: impl Fn(DVec3) -> [f32; 3]) -> Vec<Light> {
    let mut lights = Vec::new();
    for y in 0..height {
        let [top, bottom] = [y, y + 1].map(|row| PI * f64::from(row) / f64::from(height));
        let solid_angle = TAU / f64::from(width) * (top.cos() - bottom.cos());
        for x in 0..width {
            let uv = DVec2::new(
                (f64::from(x) + 0.5) / f64::from(width),
                (f64::from(y) + 0.5) / f64::from(height),
            );
            let l = direction_from_uv(uv);
            let color = radiance(l).map(|channel| (f64::from(channel) * solid_angle) as f32);
            lights.push(Light::directional(-l, color));
        }
    }
    lights
}

fn relative_rms(found: &Frame, expected: &Frame) -> f64 {
    let mut sums = [0.0; 2];
    let pixels = found.radiance.data.iter().zip(&expected.radiance.data);
    for ((found, expected), mask) in pixels.zip(&expected.mask.data) {
        for c in 0..3 {
            let off = f64::from(found[c] - expected[c]) * f64::from(*mask);
            sums[0] += off * off;
            sums[1] += f64::from(expected[c]).powi(2) * f64::from(*mask);
        }
    }
    (sums[0] / sums[1]).sqrt()
}

/// One directional light for each texel of a 64x32 map gives the image of the reference under it.
/// They differ by the size of a texel, so more at half the size, and by the reference's noise.
#[test]
fn lights_of_a_map_give_its_image() {
    let environment = smooth_environment();
    let map = |l: DVec3| environment.radiance(l).as_vec3().to_array();
    with_pipeline(|pipeline| {
        for model in MODELS {
            let sphere = scene("sphere", plastic(0.4));
            let plain = request(&environment, sphere.clone(), CameraKind::Ortho, [15; 2]);
            let plain = RenderRequest {
                reference_samples: 1 << 14,
                ..plain
            }
            .shaded(|s| {
                s.brdf = *model;
                s.method = Method::listed("reference");
                s.diffuse = Diffuse::listed("reference");
            });
            let reference = render_by_seeds(pipeline, &plain);
            let off = [16, 32].map(|height| {
                let lit = sphere.lit_by(lights_of_map(2 * height, height, map));
                let dark = RenderRequest {
                    environment: constant_environment([0.0; 3]),
                    scene: Arc::new(lit),
                    ..plain.clone()
                };
                relative_rms(&pipeline.render(&dark).unwrap(), &reference)
            });
            println!("{}: {off:?} of the integral", model.name());
            assert!(off[1] < 1e-3 && off[1] < 0.6 * off[0], "{off:?}");
        }
    });
}

/// 4,096 lights of radiance 1 are a furnace: a white surface that loses no light shows 1.
#[test]
fn the_lights_of_a_constant_map_are_a_furnace() {
    // Equal areas: rows of equal height, staggered columns.
    const SIDE: u32 = 64;
    let lights: Vec<Light> = (0..SIDE * SIDE)
        .map(|i| {
            let z = 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(SIDE * SIDE);
            let azimuth = TAU * (f64::from(i) * 0.618_033_988_749_895).fract();
            let across = (1.0 - z * z).sqrt();
            let l = DVec3::new(across * azimuth.cos(), z, across * azimuth.sin());
            let solid_angle = 2.0 * TAU / f64::from(SIDE * SIDE);
            Light::directional(-l, [solid_angle as f32; 3])
        })
        .collect();
    with_pipeline(|pipeline| {
        for model in MODELS {
            for compensation in Compensation::all() {
                let material = MaterialOverride {
                    alpha: Some(0.6),
                    f0: Some([1.0; 3]),
                    albedo: Some([0.0; 3]),
                    ..MaterialOverride::default()
                };
                let request = under(lights.clone(), scene("sphere", material), 9).shaded(|s| {
                    (s.brdf, s.compensation) = (*model, *compensation);
                    // No albedo above 1, which only the scaling could correct.
                    s.masking_shadowing = MaskingShadowing::SmithExact;
                });
                let frame = pipeline.render(&request).unwrap();
                let (mut worst, mut lost) = (0.0f64, 0.0f64);
                for sight in sights(&request, 1) {
                    let off = radiance(&frame, sight.pixel).x - 1.0;
                    worst = worst.max(off.abs());
                    lost = lost.max(-off);
                }
                let case = format!("{} {compensation:?}: off by {worst}", model.name());
                println!("{case}");
                match compensation {
                    Compensation::None => assert!(lost > 0.02, "{case}"),
                    _ => assert!(worst < 5e-3, "{case}"),
                }
            }
        }
    });
}

/// Every method gets the light that the reference gets, and no noise by it.
#[test]
fn the_same_light_for_every_method() {
    with_pipeline(|pipeline| {
        let sphere = scene("sphere", plastic(0.4));
        let lit = Arc::new(sphere.lit_by(three_lights()));
        let plain = request(
            &smooth_environment(),
            sphere,
            CameraKind::Perspective,
            [9; 2],
        );
        let plain = RenderRequest {
            reference_samples: 64,
            background: true,
            ..plain
        };
        let alone = under(three_lights(), scene("sphere", plastic(0.4)), 9);
        let alone = pipeline.render(&alone).unwrap();
        for method in METHODS.iter().filter(|method| !method.is_none()) {
            let request = plain.shaded(|s| {
                (s.method, s.diffuse) = (method, Diffuse::listed("sh9"));
                s.samples = 8;
                // Settings of tables do not change the light.
                s.precompute.dfg_size = 32;
            });
            let lit = RenderRequest {
                scene: lit.clone(),
                ..request.clone()
            };
            let [dark, lit] = [&request, &lit].map(|request| pipeline.render(request).unwrap());
            assert_eq!(dark.standard_error, lit.standard_error, "{}", method.name);
            let mut worst = Worst::new(method.name, relative(1e-6));
            for pixel in 0..lit.radiance.data.len() {
                for c in 0..3 {
                    let sum = dark.radiance.data[pixel][c] + alone.radiance.data[pixel][c];
                    worst.add(lit.radiance.data[pixel][c].into(), sum.into(), || {
                        format!("pixel {pixel}")
                    });
                }
            }
            worst.check();
        }
    });
}

/// A directional light of a glTF file shines along the -z axis of its node.
#[test]
fn a_light_of_a_file_lights_its_scene() {
    let mut model = sheet();
    model["materials"] = json!([{
        "doubleSided": true,
        "pbrMetallicRoughness": { "metallicFactor": 0.0, "baseColorFactor": [0.5, 0.5, 0.5, 1.0] }
    }]);
    model["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    model["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "directional", "color": [1.0, 0.5, 0.25], "intensity": 3.0 }
    ] } });
    // A turn by 60 degrees about +y: -z becomes (-sin 60, 0, -cos 60).
    let (sin, cos) = (PI / 6.0).sin_cos();
    model["nodes"] = json!([{ "mesh": 0 }, {
        "rotation": [0.0, sin, 0.0, cos],
        "scale": [2.0, 3.0, 4.0],
        "extensions": { "KHR_lights_punctual": { "light": 0 } }
    }]);
    model["scenes"] = json!([{ "nodes": [0, 1] }]);
    let scene = load(&model).unwrap();
    let lights = scene.lights.clone();
    let request = under(lights, scene, 21).shaded(|s| s.method = Method::listed("none"));
    let l = DVec3::new((PI / 3.0).sin(), 0.0, (PI / 3.0).cos());
    with_pipeline(|pipeline| {
        let frame = pipeline.render(&request).unwrap();
        let mut worst = Worst::new("file", relative(1e-4));
        for sight in sights(&request, 1) {
            let cosine = sight.surface.n.dot(l).max(0.0);
            let expected = DVec3::new(3.0, 1.5, 0.75) * (0.5 / PI * cosine);
            worst.add_rgb(radiance(&frame, sight.pixel), expected, || {
                format!("{:?}", sight.pixel)
            });
        }
        worst.check();
    });
}
