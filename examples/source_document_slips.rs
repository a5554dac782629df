//! Computes the numbers of docs/source-documents.md: what each slip of a printed formula does to one
//! quantity.

use glam::{DVec2, DVec3};
use splitsum::base::color::srgb_encode;
use splitsum::base::math::equirect::{direction_from_uv, uv_from_direction};
use splitsum::base::math::frame::Frame;
use splitsum::base::math::sampling::hammersley;
use splitsum::base::math::spherical_harmonics::{basis, irradiance};
use splitsum::instrument::brdf::{
    Brdf, Ggx, MaskingShadowing, Phong, Widths, alpha_from_perceptual_roughness,
    exponent_from_alpha, f_schlick, g2, pdf_d_l, reflect,
};
use splitsum::instrument::precompute::dfg::reference::{Dfg, dfg};
use splitsum::instrument::shade::printed_lobe_alpha;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

fn main() {
    println!("document,quantity,printed_value,correct_value");
    for Slip { document, figure } in slips() {
        let [printed, correct] = (figure.values)();
        println!("{document},\"{}\",{printed},{correct}", figure.quantity);
    }
    let count = slips().filter(|slip| slip.figure.changes_light()).count();
    println!(
        "# {count} of {} slips change light by more than 2 %",
        slips().count()
    );
}

/// A slip of a document, by the quantity that shows it.
pub struct Slip {
    pub document: u32,
    pub figure: &'static Figure,
}

/// One quantity by the printed and by the correct formula.
pub struct Figure {
    pub quantity: &'static str,
    /// Whether light is proportional to it; others are angles, levels and exponents.
    is_light: bool,
    /// Computes it as printed and correctly; NaN if undefined.
    pub values: fn() -> [f64; 2],
}

const fn light(quantity: &'static str, values: fn() -> [f64; 2]) -> Figure {
    Figure {
        quantity,
        is_light: true,
        values,
    }
}

const fn other(quantity: &'static str, values: fn() -> [f64; 2]) -> Figure {
    Figure {
        quantity,
        is_light: false,
        values,
    }
}

impl Figure {
    /// Whether the slip changes light by more than 2 %, which is visible side by side.
    pub fn changes_light(&self) -> bool {
        let [printed, correct] = (self.values)();
        self.is_light && (printed / correct).ln().abs() > 1.02f64.ln()
    }
}

/// Lists every slip in the order of the page.
pub fn slips() -> impl Iterator<Item = Slip> {
    let documents = [(0, &DOCUMENT_0[..]), (1, &DOCUMENT_1), (4, &DOCUMENT_4)];
    documents
        .into_iter()
        .flat_map(|(document, figures)| figures.iter().map(move |figure| Slip { document, figure }))
}

static DOCUMENT_0: [Figure; 14] = [
    other("Phong's exponent at r = 0.5", || {
        let alpha = alpha_from_perceptual_roughness(0.5);
        [exponent_from_alpha(0.5), exponent_from_alpha(alpha)]
    }),
    light("albedo of Phong, alpha 1, n·v 0.01", || {
        [MaskingShadowing::Separable, MaskingShadowing::SmithExact]
            .map(|masking| dfg(&Phong, masking, 0.01, 1.0).albedo())
    }),
    light("albedo, alpha 0.1, n·v 0.1", || {
        let masking = |cosine: f64| 2.0 / (1.0 + (1.0 + 0.01 + tan_squared(cosine)).sqrt());
        [
            albedo_with_g2(0.1, 0.1, |n_dot_l| masking(0.1) * masking(n_dot_l)),
            albedo(0.1, 0.1),
        ]
    }),
    light("reflectance of a mirror, f0 0.04, v = n", fresnel_twice),
    light("Kd, f0 0.04, alpha 1, n·v 0.1", diffuse_share),
    light("albedo, alpha 0.5, n·v 1", || {
        let printed = mean_over_d(&Ggx, 0.5, 1.0, |_, l| separable_g2(0.5, 1.0, l.z) / 4.0);
        [printed, albedo(0.5, 1.0)]
    }),
    light("albedo, alpha 0.1, n·v 1", || {
        [printed_estimator_in_furnace(0.1, 1.0), albedo(0.1, 1.0)]
    }),
    light("albedo, alpha 0.1, n·v 0.1", || {
        let printed = mean_over_d(&Ggx, 0.1, 0.1, |m, l| {
            separable_g2(0.1, 0.1, l.z) * m.z / (4.0 * l.z * 0.1)
        });
        [printed, albedo(0.1, 0.1)]
    }),
    light("albedo of Phong, alpha 0.5, n·v 0.5", || {
        let drawn_alpha = printed_lobe_alpha(&Phong, 0.5);
        let printed = mean_over_d(&Phong, drawn_alpha, 0.5, |m, l| {
            let g = g2(&Phong, 0.5, l.z, 0.5, MaskingShadowing::Separable);
            g * view(0.5).dot(m) / (0.5 * m.z)
        });
        let correct = dfg(&Phong, MaskingShadowing::Separable, 0.5, 0.5).albedo();
        [printed, correct]
    }),
    other("levels too coarse, v = n, equator", || {
        // Both levels share W H/N.
        let p_l = pdf_d_l(&Ggx, DVec3::Z, DVec3::Z, Widths::from(0.1));
        let texel_share = p_l * 2.0 * PI * PI;
        [0.5 * (texel_share / Ggx.d(DVec3::Z, 0.1)).log2(), 0.0]
    }),
    other("rotation against its own uv, degrees", || {
        [printed_direction, direction_from_uv].map(rotation_against_uv)
    }),
    light("irradiance of a point light at its peak", || {
        let lamp = basis(DVec3::Z).map(DVec3::splat);
        [irradiance(&lamp, DVec3::Z).x, 1.0]
    }),
    other("largest error, 8-bit steps", || {
        let error = |code: u8| {
            let decoded = (f64::from(code) / 255.0).powf(2.2) as f32;
            (f64::from(srgb_encode(decoded)) * 255.0 - f64::from(code)).abs()
        };
        [(0..=255).map(error).fold(0.0, f64::max), 0.0]
    }),
    light("display value of 0.5, contrast 1", || {
        [2.2, 1.0 / 2.2].map(|exponent| 0.5f64.powf(exponent))
    }),
];

static DOCUMENT_1: [Figure; 11] = [
    light("reflectance of a mirror, f0 0.04, v = n", fresnel_twice),
    light("mean of 1, N = 40", || [41.0 / 40.0, 1.0]),
    light("E/π of radiance 1, 100 x 100 points", || {
        let step = FRAC_PI_2 / 100.0;
        let theta = (0..100).map(|row| f64::from(row) * step);
        let rows: f64 = theta.map(|theta| theta.cos() * theta.sin()).sum();
        let correct = PI / 100.0 * rows;
        [correct * step * (TAU / 100.0), correct]
    }),
    other(
        "length of the cross product at up = -z, which is normalised",
        || [DVec3::Z, DVec3::NEG_Y].map(|front| DVec3::NEG_Z.cross(front).length()),
    ),
    other(
        "azimuth against the sampler's, w = 512, i = 0, degrees",
        || [0.5 / 512.0 * 360.0, 0.0],
    ),
    light("A, alpha 0.25, n·v 0.1", || {
        let pair = pair(0.25, 0.1);
        [(1.0 - fresnel(0.0, 0.1)) * pair.albedo(), pair.f0_scale]
    }),
    other(
        "G1(v)/n·v in the first column, alpha 0.25, width 32",
        || [0.0, 0.5 / 32.0].map(|n_dot_v| Ggx.g1(n_dot_v, 0.25) / n_dot_v),
    ),
    light("albedo read, perceptual roughness 0.25, n·v 0.5", || {
        [1.0 - 0.25, 0.25].map(|r| albedo(alpha_from_perceptual_roughness(r), 0.5))
    }),
    light(
        "second factor, f0 0.04, alpha 0.25, n·v 0.1, correlated",
        || {
            let pair = dfg(&Ggx, MaskingShadowing::Correlated, 0.1, 0.25);
            [fresnel(0.04, 0.1), 0.04].map(|f| reflectance(&pair, f))
        },
    ),
    other("perceptual roughness read for 0.5, 10 levels", || {
        let last_level = 10.0 - 1.0;
        [10.0, last_level].map(|levels| 0.5 * levels / last_level)
    }),
    light("albedo, k = (r + 1)²/8, alpha 0.01, n·v 0.1", || {
        let k = (0.01f64.sqrt() + 1.0).powi(2) / 8.0;
        let masking = |cosine: f64| cosine / (cosine * (1.0 - k) + k);
        [
            albedo_with_g2(0.01, 0.1, |n_dot_l| masking(0.1) * masking(n_dot_l)),
            albedo(0.01, 0.1),
        ]
    }),
];

static DOCUMENT_4: [Figure; 9] = [
    light("specular albedo, f0 0.04, alpha 0.5, n·v 0.5", || {
        // G twice, and no F.
        let g = |n_dot_l: f64| separable_g2(0.5, 0.5, n_dot_l);
        [
            albedo_with_g2(0.5, 0.5, |n_dot_l| g(n_dot_l).powi(2)),
            reflectance(&pair(0.5, 0.5), 0.04),
        ]
    }),
    light("albedo of both, c 1, f0 0.04, alpha 0.25, n·v 0.1", || {
        [1.0 + reflectance(&pair(0.25, 0.1), 0.04), 1.0]
    }),
    other("weight at 60 degrees over that at 0, alpha 0.5", || {
        // v = n; the n·l of V's denominator is 0.5.
        let masking = Ggx.g1(0.5, 0.5);
        [masking / 0.5, masking]
    }),
    light("A + B, alpha 0.01, n·v 0.1", || {
        let printed = mean_over_d(&Ggx, 0.01, 0.1, |_, l| {
            separable_g2(0.01, 0.1, l.z) / (4.0 * l.z * 0.1)
        });
        [printed, albedo(0.01, 0.1)]
    }),
    light("albedo read with swapped axes, r 0.5, n·v 0.1", || {
        [[0.1, 0.5], [0.5, 0.1]]
            .map(|[r, n_dot_v]| albedo(alpha_from_perceptual_roughness(r), n_dot_v))
    }),
    light("∫ cos/π over the hemisphere, V = 2π", || [TAU, 1.0]),
    light("integral over θ and φ, alpha 0.5", || {
        const STEPS: u32 = 10_000;
        let step = FRAC_PI_2 / f64::from(STEPS);
        let over_theta: f64 = (0..STEPS)
            .map(|row| step * density_of_theta((f64::from(row) + 0.5) * step))
            .sum();
        [TAU * over_theta, over_theta]
    }),
    other("C(45 degrees), alpha 1", || {
        let (sin, cos) = FRAC_PI_4.sin_cos();
        let alpha_squared = 1.0f64;
        let k = alpha_squared - 1.0;
        let printed = alpha_squared / (cos * cos * k * k + k) - 1.0 / k;
        [printed, sin * sin / (sin * sin + alpha_squared * cos * cos)]
    }),
    light(
        "k_D as 1 - F(n·v), f0 0.04, alpha 1, n·v 0.1",
        diffuse_share,
    ),
];

/// A specular term that multiplies F twice, in documents 0 and 1.
fn fresnel_twice() -> [f64; 2] {
    let f = fresnel(0.04, 1.0);
    [f * f, f]
}

/// The share of the diffuse term as 1 - F(n·v), in documents 0 and 4.
fn diffuse_share() -> [f64; 2] {
    [
        1.0 - fresnel(0.04, 0.1),
        1.0 - reflectance(&pair(1.0, 0.1), 0.04),
    ]
}

/// `p(θ)` of document 4, alpha 0.5.
fn density_of_theta(theta: f64) -> f64 {
    let (sin, cos) = theta.sin_cos();
    2.0 * 0.25 * cos * sin / ((0.25 - 1.0) * cos * cos + 1.0).powi(2)
}

/// Document 0's direction of a texel.
fn printed_direction(uv: DVec2) -> DVec3 {
    let (phi, theta) = (TAU * (0.5 - uv.x), PI * uv.y);
    DVec3::new(
        phi.cos() * theta.sin(),
        phi.sin() * theta.sin(),
        theta.cos(),
    )
}

/// The angle, in degrees, of the rotation from a direction to the direction of its uv, from the
/// trace of its matrix.
fn rotation_against_uv(direction: fn(DVec2) -> DVec3) -> f64 {
    let trace: f64 = DVec3::AXES
        .iter()
        .map(|axis| direction(uv_from_direction(*axis)).dot(*axis))
        .sum();
    (0.5 * (trace - 1.0)).clamp(-1.0, 1.0).acos().to_degrees()
}

/// Document 0's specular sum in a white furnace, of many directions in the lobe about the mirror
/// direction.
fn printed_estimator_in_furnace(alpha: f64, n_dot_v: f64) -> f64 {
    let mirror = Frame::from_normal(reflect(view(n_dot_v), DVec3::Z));
    let weight = |xi| {
        let l = mirror.to_world(Ggx.sample_d(xi, printed_lobe_alpha(&Ggx, alpha)));
        separable_g2(alpha, n_dot_v, l.z) / (4.0 * n_dot_v)
    };
    mean(weight)
}

/// Directional albedo of GGX with another G2, by n·l: the mean of `G2 v·m / (n·v n·m)` over m of
/// density D n·m.
fn albedo_with_g2(alpha: f64, n_dot_v: f64, g2: impl Fn(f64) -> f64) -> f64 {
    let v = view(n_dot_v);
    mean_over_d(&Ggx, alpha, n_dot_v, |m, l| {
        g2(l.z) * v.dot(m) / (n_dot_v * m.z)
    })
}

/// Mean of a term of m and l over half vectors m of density D n·m, l the view mirrored about m; 0
/// for l below the horizon.
fn mean_over_d(
    model: &dyn Brdf,
    alpha: f64,
    n_dot_v: f64,
    term: impl Fn(DVec3, DVec3) -> f64,
) -> f64 {
    // Along the horizon the printed quotients are 0/0.
    const HORIZON: f64 = 1e-9;
    let v = view(n_dot_v);
    mean(|xi| {
        let m = model.sample_d(xi, alpha);
        let l = reflect(v, m);
        if l.z > HORIZON { term(m, l) } else { 0.0 }
    })
}

/// Mean over the unit square, within about 1e-4.
fn mean(value: impl Fn(DVec2) -> f64) -> f64 {
    const COUNT: u32 = 1 << 17;
    let sum: f64 = (0..COUNT).map(|i| value(hammersley(i, COUNT))).sum();
    sum / f64::from(COUNT)
}

/// The view at a cosine to n = +z.
fn view(n_dot_v: f64) -> DVec3 {
    DVec3::new((1.0 - n_dot_v * n_dot_v).sqrt(), 0.0, n_dot_v)
}

fn tan_squared(cosine: f64) -> f64 {
    1.0 / (cosine * cosine) - 1.0
}

fn fresnel(f0: f64, cosine: f64) -> f64 {
    f_schlick(DVec3::splat(f0), cosine).x
}

fn separable_g2(alpha: f64, n_dot_v: f64, n_dot_l: f64) -> f64 {
    g2(&Ggx, n_dot_v, n_dot_l, alpha, MaskingShadowing::Separable)
}

/// (A, B) of GGX with separable masking.
fn pair(alpha: f64, n_dot_v: f64) -> Dfg {
    dfg(&Ggx, MaskingShadowing::Separable, n_dot_v, alpha)
}

fn albedo(alpha: f64, n_dot_v: f64) -> f64 {
    pair(alpha, n_dot_v).albedo()
}

/// `f A + B`.
fn reflectance(pair: &Dfg, f: f64) -> f64 {
    f * pair.f0_scale + pair.f90_scale
}
