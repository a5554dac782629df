//! The table of lobe shapes against adaptive cubature over directions, on its edges, and between its nodes.

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use splitsum::brdf::{Brdf, MODELS, MaskingShadowing, eval_without_fresnel, schlick_weight};
use splitsum::glsl::constants::LOBE_SHAPE_SIDE;
use splitsum::math::quadrature::{Rectangle, Tolerance, integrate_rectangle};
use splitsum::precompute::dfg::reference::dfg;
use splitsum::precompute::lobe_shape::{
    LobeShape, LobeShapes, OBJECTIVES, Objective, SHARES, parameters_from_node, texels, uv_from_parameters,
};
use splitsum::precompute::prefilter::{Kernel, WEIGHTS, Weight};
use splitsum::spelling::Listed;
use std::f64::consts::PI;

/// A lobe, its two parts by their integrals.
struct Lobe {
    model: &'static dyn Brdf,
    masking: MaskingShadowing,
    alpha: f64,
    v: DVec3,
    albedos: DVec2,
    /// First moments over these.
    moments: [DVec3; 2],
}

const UNIT: Rectangle = Rectangle { low: DVec2::ZERO, high: DVec2::ONE };

impl Lobe {
    /// Moments by cubature over the hemisphere about n.
    fn new(model: &'static dyn Brdf, masking: MaskingShadowing, n_dot_v: f64, alpha: f64) -> Self {
        const TOLERANCE: Tolerance = Tolerance { relative: 1e-6, max_part_count: 20_000 };
        let v = DVec3::new((1.0 - n_dot_v * n_dot_v).sqrt(), 0.0, n_dot_v);
        let mut lobe = Self { model, masking, alpha, v, albedos: DVec2::ONE, moments: [DVec3::ZERO; 2] };
        let of_part = |part: usize| {
            let integral = integrate_rectangle(UNIT, TOLERANCE, |p| {
                // Azimuths away from v; nodes gather where the lobe is.
                let ((sin, cos), (sin_phi, cos_phi)) = ((0.5 * PI * p.x).sin_cos(), (PI * p.y * p.y).sin_cos());
                let l = DVec3::new(-sin * cos_phi, sin * sin_phi, cos);
                let measure = 2.0 * p.y * PI * PI * sin;
                measure * lobe.density(part as f64, l) * DVec3::new(1.0, l.x, l.z)
            });
            integral.value
        };
        let [of_a, of_b] = [of_part(0), of_part(1)];
        lobe.albedos = DVec2::new(of_a.x, of_b.x);
        lobe.moments = [of_a, of_b].map(|sum| DVec3::new(sum.y, 0.0, sum.z) / sum.x);
        lobe
    }

    fn density(&self, share: f64, l: DVec3) -> f64 {
        let fc = schlick_weight(self.v.dot((self.v + l).normalize()));
        let parts = DVec2::new((1.0 - share) * (1.0 - fc), share * fc) / self.albedos;
        eval_without_fresnel(self.model, self.v, l, self.alpha, self.masking) * l.z.max(0.0) * parts.element_sum()
    }

    fn mirror(&self) -> DVec3 {
        DVec3::new(-self.v.x, 0.0, self.v.z)
    }
}

fn close(shape: DVec2, lobe: &Lobe, part: usize) -> f64 {
    (shape.x * lobe.mirror() + shape.y * DVec3::Z).distance(lobe.moments[part])
}

const MASKINGS: [MaskingShadowing; 3] =
    [MaskingShadowing::Separable, MaskingShadowing::Correlated, MaskingShadowing::SmithExact];

#[test]
fn moments_meet_their_integral() {
    // 512 nodes a lobe; the rational masking has a kink.
    const RULE: f64 = 1e-4;
    let views = [(0.05, 0.3), (0.2, 0.1), (0.5, 0.5), (0.8, 0.1), (0.3, 1.0), (0.95, 0.25)];
    let cases: Vec<_> =
        MODELS.iter().flat_map(|m| MASKINGS.iter().flat_map(move |g| views.map(|v| (*m, *g, v)))).collect();
    cases.par_iter().for_each(|&(model, masking, (n_dot_v, alpha))| {
        let lobe = Lobe::new(model, masking, n_dot_v, alpha);
        let LobeShape { moments, .. } = LobeShapes::new(Kernel::cosine(model), masking).at(n_dot_v, alpha);
        for (part, moment) in moments.into_iter().enumerate() {
            let off = close(moment, &lobe, part);
            assert!(off < RULE, "{} {masking:?} n_dot_v {n_dot_v} alpha {alpha} part {part}: {off}", model.name());
        }
    });
}

#[test]
fn widths_are_where_the_objective_is_least() {
    // In ln a; rings and the parabola between widths that are tried.
    const OFF: f64 = 0.02;
    const STEP: f64 = 0.1;
    let views = [(0.1, 0.3), (0.4, 0.1), (0.7, 0.25), (0.9, 0.5)];
    let cases: Vec<_> =
        MODELS.iter().flat_map(|m| WEIGHTS[..2].iter().flat_map(move |w| views.map(|v| (*m, w, v)))).collect();
    cases.par_iter().for_each(|&(model, weight, (n_dot_v, alpha))| {
        let masking = MaskingShadowing::Separable;
        let kernel = Kernel::new(model, weight, masking);
        let lobe = Lobe::new(model, masking, n_dot_v, alpha);
        let shape = LobeShapes::new(kernel, masking).at(n_dot_v, alpha);
        for (objective, ratios) in OBJECTIVES.into_iter().zip(shape.width_ratios) {
            for (share, ratio) in SHARES.into_iter().zip(ratios) {
                let width = alpha * ratio * ratio;
                if width > 0.9 {
                    continue;
                }
                let m = lobe.moments[0].lerp(lobe.moments[1], share).normalize();
                let tried = [-STEP, 0.0, STEP].map(|step: f64| width * step.exp());
                let [narrow, middle, wide] = objectives(kernel, &lobe, share, m, tried, objective).to_array();
                let off = 0.5 * STEP * (narrow - wide) / (narrow - 2.0 * middle + wide);
                let name = format!("{} {} n_dot_v {n_dot_v} alpha {alpha}", model.name(), weight.name);
                assert!(narrow > middle && wide > middle, "{name} {objective:?} {share}: {narrow} {middle} {wide}");
                assert!(off.abs() < OFF, "{name} {objective:?} {share}: {off}");
            }
        }
    });
}

/// `∫ K² S - 2 K ŵ S`, S the objective's weight, for three widths.
fn objectives(kernel: Kernel, lobe: &Lobe, share: f64, m: DVec3, widths: [f64; 3], by: Objective) -> DVec3 {
    const TOLERANCE: Tolerance = Tolerance { relative: 1e-4, max_part_count: 20_000 };
    let value = |alpha: f64, gamma: f64| {
        let h = DVec3::new((0.5 * gamma).sin(), 0.0, (0.5 * gamma).cos());
        kernel.brdf.d(h, alpha) * kernel.weight(alpha, gamma.cos())
    };
    // γ = π/2 x² gathers nodes about m.
    let integral = |f: &dyn Fn(f64, f64) -> DVec3| {
        integrate_rectangle(UNIT, TOLERANCE, |p| {
            let gamma = 0.5 * PI * p.x * p.x;
            2.0 * PI * PI * p.x * gamma.sin() * f(gamma, PI * p.y)
        })
        .value
    };
    let kernels = |gamma: f64| DVec3::from_array(widths.map(|width| value(width, gamma)));
    let norms = integral(&|gamma, _| kernels(gamma));
    let tangent = DVec3::new(m.z, 0.0, -m.x);
    integral(&|gamma, phi| {
        let l = gamma.cos() * m + gamma.sin() * (phi.cos() * tangent + phi.sin() * DVec3::Y);
        let (density, k) = (lobe.density(share, l), kernels(gamma) / norms);
        by.weight(density) * k * (k - 2.0 * density)
    })
}

/// Facing the viewer the lobe is D G1 but for Fresnel: along n, and of the width of the kernel of weight G1.
#[test]
fn the_kernel_of_masking_fits_itself_at_normal_incidence() {
    let weight = Weight::listed("masking");
    for model in MODELS {
        for masking in MASKINGS {
            // The view is tilted by 0.0014: far less than the lobe is wide.
            for alpha in [0.05, 0.1, 0.3] {
                let shape = LobeShapes::new(Kernel::new(*model, weight, masking), masking).at(1.0 - 1e-6, alpha);
                for ratio in shape.width_ratios.map(|ratios| ratios[0]) {
                    assert!((ratio - 1.0).abs() < 2e-3, "{} {masking:?} {alpha}: {ratio}", model.name());
                }
            }
        }
    }
}

/// D of GGX at alpha 1 is one value: under separable masking the lobe is G1(l) from any view, the kernel of that weight about n, but for
/// Fresnel. So the moment of f0 = 1 lies along n, and the kernel's mean cosine is its length.
#[test]
fn at_alpha_1_the_kernel_of_masking_is_the_lobe_from_any_view() {
    let weight = Weight::listed("masking");
    let [ggx] = MODELS.iter().copied().filter(|model| model.name() == "ggx").collect::<Vec<_>>()[..] else { panic!() };
    let shapes = LobeShapes::new(Kernel::new(ggx, weight, MaskingShadowing::Separable), MaskingShadowing::Separable);
    let moment = |n_dot_v: f64| {
        let (shape, pair) = (shapes.at(n_dot_v, 1.0), dfg(ggx, MaskingShadowing::Separable, n_dot_v, 1.0));
        shape.moments[0].lerp(shape.moments[1], pair.f90_scale / pair.albedo())
    };
    // At n·v 1 the shares of r and n are not parted.
    let facing = moment(1.0 - 1e-6).element_sum();
    // D is one value, so the kernel is its weight alone.
    let kernel = Kernel::new(ggx, weight, MaskingShadowing::Separable);
    let of_kernel = |power: i32| {
        let tolerance = Tolerance { relative: 1e-7, max_part_count: 20_000 };
        integrate_rectangle(UNIT, tolerance, |p| DVec3::splat(kernel.weight(1.0, p.x) * p.x.powi(power))).value.x
    };
    let mean_cosine = of_kernel(1) / of_kernel(0);
    assert!((facing - mean_cosine).abs() < 1e-4, "{facing} {mean_cosine}");
    for n_dot_v in [0.05, 0.3, 0.7, 0.95] {
        let found = moment(n_dot_v);
        assert!(found.x.abs() < 1e-4 && (found.y - facing).abs() < 1e-4, "{n_dot_v}: {found} {facing}");
    }
}

/// A narrow lobe points along r.
#[test]
fn a_mirror_looks_along_r() {
    for model in MODELS {
        let shapes = LobeShapes::new(Kernel::cosine(*model), MaskingShadowing::Separable);
        for n_dot_v in [0.2, 0.5, 0.9] {
            let [moment, _] = shapes.at(n_dot_v, 1e-3).moments;
            assert!(moment.distance(DVec2::X) < 1e-4, "{} {n_dot_v}: {moment}", model.name());
        }
    }
}

/// What a lookup between nodes loses, in units of what it stands for.
#[test]
fn lookups_between_nodes_meet_the_shape_there() {
    // Of alpha; relative.
    const DIRECTION: f64 = 0.02;
    const WIDTH: f64 = 0.02;
    let side = LOBE_SHAPE_SIDE as usize;
    let masking = MaskingShadowing::Separable;
    for model in MODELS {
        let kernel = Kernel::cosine(*model);
        let (table, shapes) = (texels(kernel, masking), LobeShapes::new(kernel, masking));
        for (x, y) in [(8, 7), (12, 10), (16, 15), (22, 20), (28, 12), (20, 29), (29, 25)] {
            let [low, high] = [[x, y], [x + 1, y + 1]].map(parameters_from_node);
            let (n_dot_v, alpha) =
                ((0.5 * (low.x.sqrt() + high.x.sqrt())).powi(2), (0.5 * (low.y.sqrt() + high.y.sqrt())).powi(2));
            let shape = shapes.at(n_dot_v, alpha);
            let uv = uv_from_parameters(n_dot_v, alpha, 0) * DVec2::new(side as f64, 3.0 * side as f64) - 0.5;
            assert!((uv - DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5)).length() < 1e-9, "{uv}");
            let mean = |part: usize, channel: usize| {
                let at =
                    |dx: usize, dy: usize| table[(part * side + y as usize + dy) * side + x as usize + dx][channel];
                0.25 * f64::from(at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1))
            };
            let name = format!("{} n_dot_v {n_dot_v} alpha {alpha}", model.name());
            let r = DVec3::new(-(1.0 - n_dot_v * n_dot_v).sqrt(), 0.0, n_dot_v);
            let direction = |moment: DVec2| (moment.x * r + moment.y * DVec3::Z).normalize();
            let off = direction(DVec2::new(mean(0, 0), mean(0, 1))).distance(direction(shape.moments[0]));
            assert!(off < DIRECTION * alpha, "{name}: {off}");
            for (part, ratios) in (1..).zip(shape.width_ratios) {
                let off = mean(part, 0) / ratios[0] - 1.0;
                assert!(off.abs() < WIDTH, "{name} part {part}: {off}");
            }
        }
    }
}
