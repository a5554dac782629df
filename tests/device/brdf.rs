//! Every function of every BRDF model against its f64 twin.

use crate::compare::{Tolerance, Worst, absolute, relative};
use crate::harness::{Probe, rounded, rounded3, vec4, with_gpu, xyz};
use glam::{DVec2, DVec3};
use splitsum::base::math::sampling::{direction_from_polar, hammersley};
use splitsum::base::names::Listed;
use splitsum::instrument::brdf::{Brdf, MODELS, MaskingShadowing, f_schlick, g1, g2, reflect};
use splitsum::instrument::gpu::Gpu;
use std::f64::consts::TAU;

const ALPHAS: [f64; 8] = [0.001, 0.003, 0.01, 0.05, 0.2, 0.5, 0.85, 1.0];
const N_DOT_V: [f64; 6] = [0.001, 0.02, 0.15, 0.5, 0.9, 1.0];

/// A few roundings and one built-in `exp` or `log` of arguments up to 16, each with the error of
/// f32 in its argument.
const F32_LOBE: Tolerance = relative(4e-6);
/// Arithmetic only.
const F32: Tolerance = Tolerance {
    relative: 1e-6,
    floor: 1e-30,
};
/// Half vectors, in units of the lobe's width: sine and cosine of the azimuth are within 1.5e-7
/// (`sin_cos_turns`).
const F32_DIRECTION: Tolerance = relative(2e-6);

/// One item of the probe, as the f32 numbers that the shader gets.
struct Item {
    alpha: f64,
    v: DVec3,
    h: DVec3,
    n_dot_l: f64,
    xi: DVec2,
    l: DVec3,
}

const F0: DVec3 = DVec3::new(0.04, 0.5, 1.0);

fn items(model: &dyn Brdf) -> Vec<Item> {
    let mut items = Vec::new();
    for alpha in ALPHAS.map(rounded) {
        for n_dot_v in N_DOT_V {
            let count = 12;
            for i in 0..count {
                let xi = hammersley(i, count) + DVec2::new(0.0, 0.02);
                let sine = |cosine: f64| ((1.0 - cosine) * (1.0 + cosine)).sqrt();
                let v = direction_from_polar(sine(n_dot_v), n_dot_v, 0.7 * xi.y + 0.1);
                let h = model.sample_d(xi, alpha);
                // Every other item has its light in the lobe, the rest anywhere in the hemisphere.
                let l = if i % 2 == 0 {
                    reflect(v, h)
                } else {
                    direction_from_polar(sine(xi.y), xi.y, xi.x)
                };
                items.push(Item {
                    alpha,
                    v: rounded3(v),
                    h: rounded3(h),
                    // Includes cosines at and below 0, where masking is 0.
                    n_dot_l: rounded(1.1 * xi.x - 0.1),
                    xi: DVec2::new(rounded(xi.x), rounded(xi.y)),
                    l: rounded3(l),
                });
            }
        }
    }
    items
}

fn run(
    gpu: &Gpu,
    model: &dyn Brdf,
    masking: MaskingShadowing,
    items: &[Item],
) -> Vec<Vec<[f64; 4]>> {
    let inputs: Vec<[f32; 4]> = items
        .iter()
        .flat_map(|item| {
            let (sin_phi, cos_phi) = (TAU * item.xi.y).sin_cos();
            [
                vec4(item.v, item.alpha),
                vec4(item.h, item.n_dot_l),
                [item.xi.x, item.xi.y, cos_phi, sin_phi].map(|x| x as f32),
                vec4(F0, 0.0),
                vec4(item.l, 0.0),
            ]
        })
        .collect();
    let shader = format!("probe/brdf.comp:{}", model.name());
    Probe {
        shader: &shader,
        constants: &[masking as u32],
        inputs: 5,
        outputs: 8,
        ..Probe::default()
    }
    .run(gpu, &inputs)
}

impl Item {
    fn case(&self) -> String {
        format!(
            "alpha {} v {} h {} xi {}",
            self.alpha, self.v, self.h, self.xi
        )
    }
}

#[test]
fn distributions_masking_and_fresnel() {
    with_gpu(|gpu| {
        for model in MODELS {
            let items = items(*model);
            for &masking in MaskingShadowing::all() {
                let worst = |what: &str, tolerance| {
                    Worst::new(format!("{} {masking:?} {what}", model.name()), tolerance)
                };
                let mut d = worst("d", F32_LOBE);
                let mut g = worst("g1", F32);
                let mut g_pair = worst("g2", F32);
                let mut fresnel = worst("f", F32);
                let mut eval = worst(
                    "eval",
                    Tolerance {
                        relative: 8e-6,
                        floor: 1e-30,
                    },
                );
                for (item, out) in items.iter().zip(run(gpu, *model, masking, &items)) {
                    let g1 = |cosine: f64| g1(*model, cosine, item.alpha, masking);
                    d.add(out[0][0], model.d(item.h, item.alpha), || item.case());
                    g.add(out[0][1], g1(item.v.z), || item.case());
                    g.add(out[0][2], g1(item.n_dot_l), || {
                        format!("n_dot_l {} {}", item.n_dot_l, item.case())
                    });
                    g_pair.add(
                        out[0][3],
                        g2(*model, item.v.z, item.n_dot_l, item.alpha, masking),
                        || item.case(),
                    );
                    let f = f_schlick(F0, item.v.dot(item.h));
                    fresnel.add_rgb(xyz(out[5]), f, || item.case());
                    // `eval` with the given h, not with the h of the rounded v and l: at alpha
                    // 0.001 that rounding makes 1e-4.
                    let dg = model.d(item.h, item.alpha)
                        * g2(*model, item.v.z, item.l.z, item.alpha, masking);
                    let expected = if item.l.z > 0.0 {
                        f * dg / (4.0 * item.v.z * item.l.z)
                    } else {
                        DVec3::ZERO
                    };
                    eval.add_rgb(xyz(out[6]), expected, || item.case());
                }
                [d, g, g_pair, fresnel, eval]
                    .into_iter()
                    .for_each(Worst::check);
            }
        }
    });
}

/// The shader draws the same direction as its twin, with its density; and the weight of light that
/// is 1 everywhere.
#[test]
fn samples_and_their_densities() {
    with_gpu(|gpu| {
        for model in MODELS {
            let items = items(*model);
            let worst =
                |what: &str, tolerance| Worst::new(format!("{} {what}", model.name()), tolerance);
            let mut sample = worst("sample_d across", F32_DIRECTION);
            let mut upright = worst("sample_d along n", F32_DIRECTION);
            let mut lobe = worst("lobe across", F32_DIRECTION);
            let mut pdf = worst("pdf_h", F32_LOBE);
            // Slopes are in units of alpha; Beckmann's inversion becomes flat at the last visible
            // slope.
            let mut visible_slope = worst("visible slope", absolute(4e-6));
            let mut visible_pdf = worst(
                "pdf_visible_l",
                Tolerance {
                    relative: 8e-6,
                    floor: 1e-30,
                },
            );
            let mut visible_own = worst("pdf_visible_l of its sample", relative(8e-6));
            let mut vndf_slope = worst("vndf slope", absolute(2e-5));
            let mut vndf_pdf = worst("pdf_vndf_l of its sample", relative(1e-5));
            let mut ratio = worst("d_over_pdf", relative(1e-5));
            for (item, out) in
                items
                    .iter()
                    .zip(run(gpu, *model, MaskingShadowing::Separable, &items))
            {
                let h = model.sample_d(item.xi, item.alpha);
                let across = |h: DVec3| DVec3::new(h.x, h.y, 0.0);
                sample.add_vector(across(xyz(out[1])), across(h), || item.case());
                lobe.add_vector(across(xyz(out[2])), across(h), || item.case());
                upright.add(out[1][2], h.z, || item.case());
                upright.add(out[2][2], h.z, || item.case());
                pdf.add(out[2][3], model.d(h, item.alpha) * h.z, || item.case());

                let in_alpha = |h: DVec3| across(h) / (h.z * item.alpha);
                let off = |sampled: DVec3, expected: DVec3| {
                    (in_alpha(sampled) - in_alpha(expected)).length()
                        / (1.0 + in_alpha(expected).length())
                };
                let (sampled, expected) = (
                    xyz(out[3]),
                    model.sample_visible(item.xi, item.v, item.alpha.into()),
                );
                visible_slope.add(off(sampled, expected), 0.0, || {
                    format!("{sampled} for {expected}, {}", item.case())
                });
                visible_pdf.add(
                    out[4][0],
                    model.pdf_visible_l(item.v, item.h, item.alpha.into()),
                    || item.case(),
                );
                visible_own.add(
                    out[4][1],
                    model.pdf_visible_l(item.v, sampled, item.alpha.into()),
                    || item.case(),
                );

                let (sampled, expected) = (
                    xyz(out[7]),
                    model.sample_vndf(item.xi, item.v, item.alpha.into()),
                );
                vndf_slope.add(off(sampled, expected), 0.0, || {
                    format!("{sampled} for {expected}, {}", item.case())
                });
                let density = model.pdf_vndf_l(item.v, sampled, item.alpha.into());
                vndf_pdf.add(out[4][2], density, || item.case());
                let expected = model.d(sampled, item.alpha) / (4.0 * item.v.z * density);
                ratio.add_within(out[4][3], expected, exp2_error(expected), || item.case());
            }
            let of_d = [sample, upright, lobe, pdf];
            let of_visible = [
                visible_slope,
                visible_pdf,
                visible_own,
                vndf_slope,
                vndf_pdf,
                ratio,
            ];
            of_d.into_iter().chain(of_visible).for_each(Worst::check);
        }
    });
}

/// Vulkan lets exp2(x), and so a small number by pow, be off by 3 + 2 |x| units in the last place.
fn exp2_error(value: f64) -> f64 {
    if value > 0.0 {
        (3.0 + 2.0 * value.log2().abs()) * value * 2f64.powi(-23)
    } else {
        0.0
    }
}
