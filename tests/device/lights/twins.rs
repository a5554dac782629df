//! Direct lights of every model, layer and compensation against f64.

use super::{ROUNDING, plastic, three_lights, under};
use crate::compare::{Tolerance, Worst, relative};
use crate::compensation_twins::{factor, multiple, reflectance};
use crate::harness::{scene, with_gpu, with_pipeline};
use crate::methods::{Sight, radiance, sights};
use crate::tables::dfg_table;
use glam::{DVec2, DVec3};
use splitsum::base::names::Listed;
use splitsum::base::pixels::Pixels;
use splitsum::instrument::brdf::{
    Brdf, Compensation, FresnelWeight, MODELS, MaskingShadowing, SheenVisibility, WidthLaw,
    f_schlick,
};
use splitsum::instrument::precompute::PrecomputeSettings;
use splitsum::instrument::precompute::dfg::reference::dfg;
use splitsum::instrument::scene::{Light, MaterialOverride};
use splitsum::instrument::shade::coat::{COAT_F0, COAT_RENDERERS, CoatLayering};
use splitsum::instrument::shade::lights::{diffuse, specular, weighted_diffuse};
use splitsum::instrument::shade::reference::Surface;
use splitsum::instrument::shade::{Diffuse, Method};

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
