//! Steps of the split sum's error: the game, attributions of synthetic data, and the radiance of
//! coalitions against other formulas.

use crate::oracle::golden_environment;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use splitsum::base::math::design;
use splitsum::base::math::frame::Frame;
use splitsum::base::names::Listed;
use splitsum::base::pixels::{Pixels, RgbImage};
use splitsum::instrument::brdf::{MODELS, MaskingShadowing, g2, reflect, schlick_weight};
use splitsum::instrument::environment::Environment;
use splitsum::instrument::environment::layout::{FilteredMap, LAYOUTS};
use splitsum::instrument::ladder::attribution::{Attribution, Case, attributions};
use splitsum::instrument::ladder::game::{Coalition, Game};
use splitsum::instrument::ladder::radiance::{ByKernel, KernelRadiance, Radiance, Setting};
use splitsum::instrument::ladder::{FRESNEL, LEVELS, MASKING, STEPS, STORAGE, TABLE, VIEW, game};
use splitsum::instrument::metrics::Epsilon;
use splitsum::instrument::precompute::dfg::{Albedos, reference::dfg};
use splitsum::instrument::precompute::prefilter::{Kernel, harmonic};
use splitsum::instrument::precompute::{PrecomputeSettings, PrefilterBy, exact_quadrature};
use splitsum::instrument::shade::method::ladder;
use splitsum::instrument::shade::reference::{Surface, TOLERANCE};
use splitsum::instrument::shade::twin::Twin;
use std::f64::consts::{PI, TAU};

fn scattered(coalition: Coalition) -> f64 {
    (coalition.index() as f64 * 0.754_877_666).fract() + f64::from(coalition.len())
}

/// Every order in which each player comes after the players it needs.
fn orders(game: &Game, so_far: &[usize]) -> Vec<Vec<usize>> {
    if so_far.len() == game.player_count() {
        return vec![so_far.to_vec()];
    }
    (0..game.player_count())
        .filter(|player| game.can_join(Coalition::from_players(so_far), *player))
        .flat_map(|player| orders(game, &[so_far, &[player]].concat()))
        .collect()
}

/// The contribution of each player, averaged over these orders.
fn by_orders(game: &Game, value: fn(Coalition) -> f64) -> Vec<f64> {
    let orders = orders(game, &[]);
    let mut sums = vec![0.0; game.player_count()];
    for order in &orders {
        let mut joined = Coalition::EMPTY;
        for &player in order {
            sums[player] += (value(joined.with(player)) - value(joined)) / orders.len() as f64;
            joined = joined.with(player);
        }
    }
    sums
}

#[test]
fn coalitions_contain_the_players_they_need() {
    let game = game();
    let all = game.coalitions();
    // Three free steps beside n = v = r: 2³; with it four more: 2³ · 2⁴.
    assert_eq!(all.len(), 8 + 128);
    assert!(
        (0..=STEPS.len()).all(|count| game.is_feasible(Coalition::first(count))),
        "the ladder's order is one of them"
    );
    for step in 0..STEPS.len() {
        let least = game.smallest_before(step);
        let most = game.largest_without(step);
        assert!(
            game.is_feasible(least.with(step)) && game.is_feasible(most),
            "{step}"
        );
        assert!(
            all.iter()
                .filter(|coalition| coalition.contains(step))
                .all(|coalition| coalition.contains_all(least)),
            "{step}: least"
        );
        assert!(
            all.iter()
                .filter(|coalition| !coalition.contains(step))
                .all(|coalition| most.contains_all(*coalition)),
            "{step}: most"
        );
    }
}

#[test]
fn shapley_values_are_means_over_all_orders() {
    const NONE: &[usize] = &[];
    let games: [&[&[usize]]; 3] = [
        &[NONE, NONE, NONE, NONE],
        &[NONE, &[0], &[0], &[1, 2], NONE],
        &[NONE, &[0], &[1]],
    ];
    for needs in games {
        let game = Game::new(
            needs
                .iter()
                .map(|players| Coalition::from_players(players))
                .collect(),
        );
        let found = game.shapley(scattered);
        let right = by_orders(&game, scattered);
        let whole = scattered(game.everybody()) - scattered(Coalition::EMPTY);
        assert!(
            (found.iter().sum::<f64>() - whole).abs() < 1e-12,
            "{needs:?}: the sum"
        );
        assert!(
            found.iter().zip(&right).all(|(a, b)| (a - b).abs() < 1e-12),
            "{needs:?}: {found:?}, {right:?}"
        );
    }
}

fn drawn(
    radiance: &dyn Fn(Coalition) -> Vec<DVec3>,
    scrambles: &dyn Fn(Coalition) -> Vec<Vec<DVec3>>,
) -> Attribution {
    let (n_dot_v, epsilon) = (&[0.5; PIXELS], Epsilon::of_light(0.0));
    attributions(
        &Case {
            n_dot_v,
            radiance,
            scrambles,
            epsilon,
        },
        &[],
    )
    .remove(0)
}

#[test]
fn a_step_between_rungs_of_the_same_scrambles_has_its_own_error() {
    // The reference is 1, with an error that every rung shares. A step with a size per pixel is
    // drawn with 1 % noise, from 3 scrambles.
    let step = |pixel: usize| 0.1 + 0.2 * (pixel % 7) as f64;
    let rungs = |coalition: Coalition| coalition.contains(MASKING);
    let estimate = |coalition: Coalition, k: usize, pixel: usize| {
        let shared = [0.3, -0.1, -0.2][k] * (1.0 + (pixel % 3) as f64);
        let own = [0.01, -0.01, 0.0][k];
        1.0 + shared
            + if rungs(coalition) {
                step(pixel) * (1.0 + own)
            } else {
                0.0
            }
    };
    let image = |coalition: Coalition| -> Vec<DVec3> {
        (0..PIXELS)
            .map(|pixel| DVec3::splat(1.0 + if rungs(coalition) { step(pixel) } else { 0.0 }))
            .collect()
    };
    let scrambles = |coalition: Coalition| -> Vec<Vec<DVec3>> {
        (0..3)
            .map(|k| {
                (0..PIXELS)
                    .map(|pixel| DVec3::splat(estimate(coalition, k, pixel)))
                    .collect()
            })
            .collect()
    };
    let found = drawn(&image, &scrambles);
    // se² = (1e-4 + 1e-4) / (3 · 2) of the step's square.
    let right = (2e-4f64 / 6.0).sqrt();
    assert!(
        (found.steps[MASKING].step_error / right - 1.0).abs() < 1e-9,
        "{}",
        found.steps[MASKING].step_error
    );
    assert!(
        found.steps[FRESNEL].step_error == 0.0 && found.noise > 1e-2,
        "{found:?}"
    );
    // One step makes the whole error, with any noise of the scrambles.
    assert!(
        (found.steps[MASKING].share - 1.0).abs() < 1e-12
            && found.steps[MASKING].share_error < 1e-12
    );
}

#[test]
fn a_share_is_known_as_well_as_its_steps() {
    // e = a + b with a = 1, b = 0.5 and scrambles of b: the share of b is b (a + b) / (a + b)² = b
    // / (1 + b), slope 1 / (1 + b)².
    let by = [0.02, -0.01, -0.03, 0.02];
    let radiance = |coalition: Coalition| {
        let steps = [coalition.contains(FRESNEL), coalition.contains(MASKING)];
        let added = match steps {
            [false, false] => 0.0,
            [true, false] => 1.0,
            [false, true] => 0.5,
            [true, true] => 1.5,
        };
        vec![DVec3::splat(1.0 + added); PIXELS]
    };
    let scrambles = |coalition: Coalition| -> Vec<Vec<DVec3>> {
        by.map(|by| {
            radiance(coalition)
                .iter()
                .map(|x| x + if coalition.contains(MASKING) { by } else { 0.0 })
                .collect()
        })
        .to_vec()
    };
    let step = drawn(&radiance, &scrambles).steps[MASKING];
    // Standard error of b: 1.8e-3 over 4 · 3.
    let of_b = (by.iter().map(|x| x * x).sum::<f64>() / 12.0).sqrt();
    assert!((step.share - 1.0 / 3.0).abs() < 1e-12);
    assert!(
        (step.step_error / (of_b / 0.5) - 1.0).abs() < 1e-9,
        "{}",
        step.step_error
    );
    assert!(
        (step.share_error / (of_b / 2.25) - 1.0).abs() < 0.01,
        "{} {of_b}",
        step.share_error
    );
}

/// `w` at r = 1: a black light leaves the absolute ε.
fn weight() -> f64 {
    1.0 / (1.0 + Epsilon::of_light(0.0).squared_epsilon())
}

/// Pixels with n·v from 0 to 1.
const PIXELS: usize = 400;

/// Two scrambles, this far from an image: its standard error is 1e-3.
fn scrambles(image: &[DVec3]) -> Vec<Vec<DVec3>> {
    [-1e-3, 1e-3]
        .map(|by| image.iter().map(|value| value + by).collect())
        .to_vec()
}

/// Attributions of images that are a constant plus the addition of each step to each pixel.
fn made(added: &dyn Fn(usize, usize) -> f64, bands: &[[f64; 2]]) -> Vec<Attribution> {
    let radiance = |coalition: Coalition| -> Vec<DVec3> {
        let sum = |pixel| {
            (0..STEPS.len())
                .filter(|i| coalition.contains(*i))
                .map(|i| added(i, pixel))
                .sum::<f64>()
        };
        (0..PIXELS)
            .map(|pixel| DVec3::splat(1.0 + sum(pixel)))
            .collect()
    };
    let n_dot_v: Vec<f64> = (0..PIXELS)
        .map(|i| (i as f64 + 0.5) / PIXELS as f64)
        .collect();
    let case = Case {
        n_dot_v: &n_dot_v,
        radiance: &radiance,
        scrambles: &|coalition| scrambles(&radiance(coalition)),
        epsilon: Epsilon::of_light(0.0),
    };
    attributions(&case, bands)
}

#[test]
fn steps_on_different_pixels_keep_their_error() {
    // Each step changes its own pixels; the last does nothing.
    let size = |step: usize| {
        if step == TABLE {
            0.0
        } else {
            0.01 * (step + 1) as f64
        }
    };
    let [all] = &made(
        &|step, pixel| {
            if pixel % STEPS.len() == step {
                size(step)
            } else {
                0.0
            }
        },
        &[],
    )[..] else {
        panic!("one band")
    };
    let whole: f64 = (0..STEPS.len()).map(|step| size(step).powi(2)).sum();
    for (step, found) in all.steps.iter().enumerate() {
        let own = size(step).powi(2);
        let mean = weight() * own / STEPS.len() as f64;
        assert!(
            (found.share - own / whole).abs() < 1e-12,
            "{step}: share {}",
            found.share
        );
        for (name, x) in [
            ("first", found.first_in),
            ("last", found.last_out),
            ("shapley", found.shapley),
        ] {
            // Making n = v = r exact also makes the steps exact that need it.
            let with_others = step == VIEW && name == "last";
            let right = if with_others {
                (VIEW..TABLE)
                    .map(|i| weight() * size(i).powi(2))
                    .sum::<f64>()
                    / 8.0
            } else {
                mean
            };
            assert!((x - right).abs() < 1e-12, "{step}: {name} {x}, not {right}");
        }
    }
    assert!(
        (all.error - weight() * whole / 8.0).abs() < 1e-12
            && (all.noise - weight() * 1e-6).abs() < 1e-15
    );
}

#[test]
fn a_step_that_undoes_another_has_a_negative_share() {
    // Two steps of the same pixels, 0.3 and -0.1, leave 0.2: shares 1.5 and -0.5.
    let added = |step: usize, _| [0.3, -0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0][step];
    let found = made(&added, &[[0.0, 0.5], [0.5, 1.0], [1.0, 1.0]]);
    assert_eq!(
        found.iter().map(|one| one.pixel_count).collect::<Vec<_>>(),
        [PIXELS, PIXELS / 2, PIXELS / 2]
    );
    for one in &found {
        let [fresnel, masking] = [one.steps[FRESNEL], one.steps[MASKING]];
        assert!((fresnel.share - 1.5).abs() < 1e-12 && (masking.share + 0.5).abs() < 1e-12);
        for (step, first_in, last_out, shapley) in
            [(fresnel, 0.09, 0.03, 0.06), (masking, 0.01, -0.05, -0.02)]
        {
            let found = [step.first_in, step.last_out, step.shapley].map(|x| x / weight());
            assert!(
                found
                    .iter()
                    .zip([first_in, last_out, shapley])
                    .all(|(a, b)| (a - b).abs() < 1e-12),
                "{found:?}"
            );
        }
    }
}

#[test]
fn albedos_between_nodes_match_the_quadrature() {
    let settings = [
        (0.1, MaskingShadowing::Separable),
        (0.7, MaskingShadowing::Correlated),
    ];
    for (model, (alpha, masking)) in MODELS.iter().zip(settings.into_iter().cycle()) {
        let albedos = Albedos::new(Kernel::cosine(*model), masking, alpha);
        for n_dot_v in [0.002, 0.013, 0.11, 0.37, 0.62, 0.883, 0.9999] {
            let (found, right) = (albedos.exact(n_dot_v), dfg(*model, masking, n_dot_v, alpha));
            let error = (found - DVec2::new(right.f0_scale, right.f90_scale))
                .abs()
                .max_element();
            assert!(
                error < 2e-6,
                "{} alpha {alpha} n.v {n_dot_v}: {error:e}",
                model.name()
            );
        }
    }
}

fn frames(count: u32) -> Vec<[DVec3; 2]> {
    (0..count).map(|i| design::frame(i, count)).collect()
}

fn one_level(environment: &Environment, side: u32) -> FilteredMap {
    let layout = &LAYOUTS[0];
    let face = |face| {
        Pixels::from_fn(side, side, |x, y| {
            let uv = (DVec2::new(x.into(), y.into()) + 0.5) / f64::from(side);
            environment.radiance((layout.direction)(face, uv))
        })
    };
    FilteredMap {
        layout,
        levels: vec![(0..layout.face_count).map(face).collect()],
    }
}

/// The radiance of coalitions of GGX at one alpha, with the drawn parts taken from the quadrature.
fn radiance(
    environment: &Environment,
    alpha: f64,
    frames: &[[DVec3; 2]],
    tables: &PrecomputeSettings,
) -> Radiance {
    let (model, masking) = (MODELS[0], MaskingShadowing::Separable);
    let exact = exact_quadrature(&environment.image);
    let mean = |method: &splitsum::instrument::shade::Method, f0: f64| -> Vec<DVec3> {
        let Twin::Mean(twin) = method.twin else {
            panic!("{} is not an integral", method.name)
        };
        let of_frame = |[n, v]: &[DVec3; 2]| {
            let surface = Surface::new(model, masking, alpha, DVec3::splat(f0), [*n, *v]);
            twin(&exact, &surface, tables, TOLERANCE).value
        };
        frames.par_iter().map(of_frame).collect()
    };
    let reference = splitsum::instrument::shade::Method::listed("reference");
    let drawn = |method| KernelRadiance {
        f0_0: mean(method, 0.0),
        f0_1: mean(method, 1.0),
    };
    let drawn = ByKernel {
        exact: drawn(reference),
        weighted: drawn(&ladder::MASKING_ALONE),
    };
    let albedos = Albedos::new(Kernel::cosine(model), masking, alpha);
    let harmonics = harmonic::harmonics(&environment.image, harmonic::degree(alpha.min(0.0625)));
    Radiance::new(Setting {
        model,
        masking,
        alpha,
        albedos: &albedos,
        tables,
        environment,
        scale: 1.0,
        harmonics: &harmonics,
        filtered: &one_level(environment, 32),
        table: frames
            .iter()
            .map(|[n, v]| albedos.exact(n.dot(*v)))
            .collect(),
        frames,
        drawn: vec![drawn],
    })
}

fn harmonic_tables() -> PrecomputeSettings {
    PrecomputeSettings {
        prefilter: PrefilterBy::Harmonic,
        prefilter_size: [64; 2],
        ..PrecomputeSettings::default()
    }
}

#[test]
fn rungs_match_their_f64_twins() {
    let environment = Environment::from_image("golden", golden_environment());
    let (frames, tables, f0) = (frames(7), harmonic_tables(), DVec3::new(0.04, 0.3, 1.0));
    let exact = exact_quadrature(&environment.image);
    for alpha in [0.1, 0.45] {
        let found = radiance(&environment, alpha, &frames, &tables);
        let rungs = [
            (&ladder::FRESNEL, Coalition::from_players(&[FRESNEL])),
            (
                &ladder::MASKING,
                Coalition::from_players(&[FRESNEL, MASKING]),
            ),
            (
                &ladder::VIEW,
                Coalition::from_players(&[FRESNEL, MASKING, VIEW]),
            ),
            (
                &ladder::LEVELS,
                Coalition::from_players(&[FRESNEL, MASKING, VIEW, LEVELS]),
            ),
            // Nothing is rounded or sampled here, and the table is exact.
            (
                &ladder::LEVELS,
                Coalition::from_players(&[FRESNEL, MASKING, VIEW, LEVELS, STORAGE, TABLE]),
            ),
        ];
        for (method, coalition) in rungs {
            let Twin::Mean(twin) = method.twin else {
                panic!("{} is not an integral", method.name)
            };
            for (pixel, own) in found.for_coalition(coalition, f0).iter().enumerate() {
                let [n, v] = frames[pixel];
                let surface =
                    Surface::new(MODELS[0], MaskingShadowing::Separable, alpha, f0, [n, v]);
                let right = twin(&exact, &surface, &tables, TOLERANCE).value;
                let error = ((*own - right) / right).abs().max_element();
                assert!(
                    error < 2e-4,
                    "{} alpha {alpha} pixel {pixel}: {own}, not {right}",
                    method.name
                );
            }
        }
    }
}

#[test]
fn the_view_alone_is_the_lobe_about_r() {
    // (f0 A + B) <K F, L> with K = D/4 G1(l) for n = v = r, by sums over latitude and longitude.
    let environment = Environment::from_image("golden", golden_environment());
    let (alpha, f0, frames) = (0.45, DVec3::new(0.04, 0.3, 1.0), frames(6));
    let found = radiance(&environment, alpha, &frames, &harmonic_tables())
        .for_coalition(Coalition::from_players(&[VIEW]), f0);
    let (model, masking) = (MODELS[0], MaskingShadowing::Separable);
    for ([n, v], own) in frames.iter().zip(&found) {
        let frame = Frame::from_normal(reflect(*v, *n));
        let (mut sums, mut wholes) = ([DVec3::ZERO; 2], [0.0; 2]);
        let (rows, columns) = (400, 400);
        for row in 0..rows {
            let theta = 0.5 * PI * (f64::from(row) + 0.5) / f64::from(rows);
            for column in 0..columns {
                let phi = TAU * (f64::from(column) + 0.5) / f64::from(columns);
                let l = DVec3::new(
                    theta.sin() * phi.cos(),
                    theta.sin() * phi.sin(),
                    theta.cos(),
                );
                let h = (l + DVec3::Z).normalize();
                let value = model.d(h, alpha) * g2(model, 1.0, l.z, alpha, masking) * theta.sin();
                let fc = schlick_weight(h.z);
                let light = environment.radiance(frame.to_world(l));
                for (i, part) in [1.0 - fc, fc].into_iter().enumerate() {
                    sums[i] += value * part * light;
                    wholes[i] += value * part;
                }
            }
        }
        let albedo = dfg(model, masking, n.dot(*v), alpha);
        let mean = (f0 * sums[0] + sums[1]) / (f0 * wholes[0] + wholes[1]);
        let right = (f0 * albedo.f0_scale + albedo.f90_scale) * mean;
        assert!(
            ((*own - right) / right).abs().max_element() < 1e-3,
            "{own}, not {right}"
        );
    }
}

#[test]
fn a_white_lobe_has_no_step_of_fresnel() {
    let environment = Environment::from_image("golden", golden_environment());
    let found = radiance(&environment, 0.3, &frames(12), &harmonic_tables());
    for coalition in game()
        .coalitions()
        .into_iter()
        .filter(|coalition| !coalition.contains(FRESNEL))
    {
        let inside = found.for_coalition(coalition, DVec3::ONE);
        let outside = found.for_coalition(coalition.with(FRESNEL), DVec3::ONE);
        for (inside, outside) in inside.iter().zip(&outside) {
            assert!(
                ((*inside - *outside) / *outside).abs().max_element() < 1e-9,
                "{coalition:b}: {inside} {outside}"
            );
        }
    }
}

#[test]
fn constant_light_has_no_step_but_the_table() {
    let image = RgbImage::from_fn(64, 32, |_, _| [0.5, 1.0, 2.0]);
    let environment = Environment::from_image("constant", image);
    let (frames, f0) = (frames(16), DVec3::new(0.04, 0.3, 1.0));
    let found = radiance(&environment, 0.3, &frames, &harmonic_tables());
    let exact = found.for_coalition(Coalition::EMPTY, f0);
    for coalition in game().coalitions() {
        for (own, right) in found.for_coalition(coalition, f0).iter().zip(&exact) {
            assert!(
                ((own - right) / right).abs().max_element() < 2e-5,
                "{coalition:b}: {own}, not {right}"
            );
        }
    }
}
