//! The effect of given tables on an image, for lights and tables whose error has a closed form.

use super::files::faces;
use glam::{DVec2, DVec3};
use splitsum::bakes::check::Truth;
use splitsum::bakes::check::image::{ALPHAS, COUNT, ImageScore, score};
use splitsum::bakes::convention::{Axes, Convention, PRESETS, TABLE_AXES};
use splitsum::bakes::{Bake, Map};
use splitsum::brdf::{Ggx, MaskingShadowing};
use splitsum::environment::Environment;
use splitsum::environment::layout::LAYOUTS;
use splitsum::math::design;
use splitsum::math::equirect::direction_from_uv;
use splitsum::pixels::RgbImage;
use splitsum::precompute::dfg::Albedos;
use splitsum::precompute::prefilter::Kernel;

/// Side of a face, and of a table.
const SIDE: u32 = 8;

fn scored(light: &Environment, bake: &Bake, convention: &Convention) -> Vec<ImageScore> {
    score(&Truth::new(light, Kernel::cosine(&Ggx), &ALPHAS), bake, convention).unwrap()
}

/// Levels of the widths [`ALPHAS`], by direction.
fn map(axes: Axes, value: impl Fn(usize, DVec3) -> DVec3) -> Map {
    let level = |k: usize| faces(&LAYOUTS[0], [SIDE; 2], |d| value(k, axes.to_world(d)));
    Map { layout: &LAYOUTS[0], levels: (0..ALPHAS.len()).map(level).collect() }
}

fn of_widths() -> Convention {
    Convention { alphas: Some(ALPHAS.to_vec()), ..PRESETS[0].convention() }
}

/// Under constant light of 1 the image is `r = f0 A + B`. A map of 1.5, and a table linear in both axes, have closed forms.
#[test]
fn under_constant_light_errors_follow_the_formulas() {
    let light = Environment::from_image("flat", RgbImage::filled(32, 16, [1.0; 3]));
    // Axes other than ours reveal swapped axes.
    let axes = &TABLE_AXES[6];
    let held = |at: DVec2| DVec2::new(0.2 + 0.5 * at.x + 0.2 * at.y, 0.05 + 0.1 * at.y);
    let table = RgbImage::from_fn(64, 64, |x, y| {
        let [a, b] = held(axes.parameters((DVec2::new(x.into(), y.into()) + 0.5) / 64.0)).as_vec2().to_array();
        [a, b, 0.0]
    });
    let bake = Bake { specular: Some(map(Axes::SAME, |_, _| DVec3::splat(1.5))), dfg: Some(table), ..Bake::default() };
    let scores = scored(&light, &bake, &Convention { table_axes: axes, ..of_widths() });
    assert_eq!(scores.len(), 2 * ALPHAS.len());
    // Two levels of 1 and 2: a width in between blends them by its place in roughness.
    let steps = Map {
        levels: [1.0, 2.0].map(|x| map(Axes::SAME, |_, _| DVec3::splat(x)).levels.remove(0)).to_vec(),
        ..map(Axes::SAME, |_, d| d)
    };
    let two = Convention { alphas: Some(vec![ALPHAS[0], ALPHAS[4]]), ..of_widths() };
    let blends = scored(&light, &Bake { specular: Some(steps), ..Bake::default() }, &two);
    // n·v and (A, B) of every direction, by width.
    let exact = ALPHAS.map(|alpha| {
        let albedos = Albedos::new(Kernel::cosine(&Ggx), MaskingShadowing::Separable, alpha);
        let of = |i: u32| {
            let [n, v] = design::frame(i, COUNT);
            (n.dot(v), albedos.exact(n.dot(v)))
        };
        (0..COUNT).map(of).collect::<Vec<_>>()
    });
    for (score, blend) in scores.iter().zip(blends) {
        let exact = &exact[ALPHAS.iter().position(|alpha| *alpha == score.alpha).unwrap()];
        let reflectance = |pair: DVec2| score.f0 * pair.x + pair.y;
        let expected = |found: &dyn Fn(f64, f64) -> f64| {
            let square = |&(n_dot_v, pair): &(f64, DVec2)| {
                let r = reflectance(pair);
                (found(n_dot_v, r) - r).powi(2) / (r * r + 0.01)
            };
            exact.iter().map(square).sum::<f64>() / f64::from(COUNT)
        };
        let by_map = expected(&|_, r| 1.5 * r);
        // Lookups clamp in the outermost half texels.
        let at = |n_dot_v: f64| {
            DVec2::new(n_dot_v, score.alpha.sqrt()).clamp(DVec2::splat(0.5 / 64.0), DVec2::splat(63.5 / 64.0))
        };
        let by_table = expected(&|n_dot_v, _| 1.5 * reflectance(held(at(n_dot_v))));
        assert!(score.split_sum < 1e-6 && score.levels.unwrap() < 1e-6, "{score:?}");
        assert!((score.map.unwrap() / by_map - 1.0).abs() < 1e-4, "{score:?}, {by_map}");
        assert!((score.table.unwrap() / by_table - 1.0).abs() < 1e-4, "{score:?}, {by_table}");
        let share = (score.alpha.sqrt() - ALPHAS[0].sqrt()) / (1.0 - ALPHAS[0].sqrt());
        let blended = expected(&|_, r| (1.0 + share) * r);
        assert!((blend.map.unwrap() - blended).abs() < 1e-4 * blended.max(1e-4), "{blend:?}, {blended}");
        // The split sum has no error here, so all error comes from the tables.
        assert!((score.alone / by_table - 1.0).abs() < 1e-3, "{score:?}, {by_table}");
    }
}

/// Light of degree 1 stays of degree 1: a level multiplies it by a factor, so the closed form gives the rung of the levels.
#[test]
fn a_map_of_the_right_levels_errs_as_its_levels_do() {
    let along = DVec3::new(0.3, 0.5, -0.4);
    let light = RgbImage::from_fn(256, 128, |x, y| {
        let d = direction_from_uv((DVec2::new(x.into(), y.into()) + 0.5) / DVec2::new(256.0, 128.0));
        [(1.0 + along.dot(d)) as f32; 3]
    });
    let light = Environment::from_image("linear", light);
    let truth = Truth::new(&light, Kernel::cosine(&Ggx), &ALPHAS);
    let factor = ALPHAS.map(|alpha| {
        let d = along.normalize();
        (truth.prefiltered(alpha).value(d).x - 1.0) / along.length()
    });
    let axes = Axes::parse("-z+y+x").unwrap();
    let exact = map(axes, |k, d| DVec3::splat(1.0 + factor[k] * along.dot(d)));
    let bake = |specular: Map| Bake { specular: Some(specular), ..Bake::default() };
    let convention = Convention { axes, ..of_widths() };
    let scores = scored(&light, &bake(exact.clone()), &convention);
    for score in &scores {
        // Surfaces have the widths of levels, so nothing is blended.
        assert!((score.levels.unwrap() - score.split_sum).abs() < 1e-12 && score.table.is_none(), "{score:?}");
        let off = (score.map.unwrap().sqrt() - score.split_sum.sqrt()).abs();
        // Linear between texels of 11 degrees.
        assert!(off < 2e-3, "{score:?}");
    }
    // n = v = r costs most where the lobe is widest.
    assert!(scores[9].split_sum > 10.0 * scores[1].split_sum && scores[9].split_sum > 1e-4, "{scores:?}");
    let turned = scored(&light, &bake(exact), &of_widths());
    assert!(turned[..4].iter().all(|score| score.map.unwrap() > 50.0 * score.split_sum), "{turned:?}");
}
