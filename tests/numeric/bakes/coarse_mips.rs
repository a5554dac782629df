//! Coarse mips of a lat-long map, in irradiance, and beside the rounding of an atlas.

use super::causes::{blurred, causes_of, half_vectors, lamps, law_of};
use super::files::faces;
use super::packed::{RgbpScale, atlas_of, judged_file};
use super::scores::{light_of, marked_light};
use super::slips::{each_texel, exact, judged, judged_bake, of_levels};
use glam::{DVec2, DVec3};
use splitsum::bake::Bake;
use splitsum::bake::judge::{Cause, Encoding, MipSource, Truth, WidthLaw};
use splitsum::base::math::equirect::uv_from_direction;
use splitsum::base::names::Listed;
use splitsum::base::pixels::{Pixels, RgbImage};
use splitsum::instrument::brdf::{Brdf, Ggx};
use splitsum::instrument::environment::Environment;
use splitsum::instrument::environment::layout::{FilteredMap, LAYOUTS, MapLayout};
use splitsum::instrument::precompute::prefilter::Kernel;
use std::f64::consts::PI;

/// Mips of a lat-long map as `glGenerateMipmap` makes them: means of four texels.
fn mips(map: &RgbImage) -> Vec<RgbImage> {
    let mut all = vec![map.clone()];
    while all[all.len() - 1].height > 1 {
        let last = &all[all.len() - 1];
        all.push(RgbImage::from_fn(
            last.width / 2,
            last.height / 2,
            |x, y| {
                let four =
                    [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[i, j]| last.get(2 * x + i, 2 * y + j));
                std::array::from_fn(|c| four.iter().map(|texel| texel[c]).sum::<f32>() / 4.0)
            },
        ));
    }
    all
}

fn bilinear(map: &RgbImage, uv: DVec2) -> DVec3 {
    let size = DVec2::new(map.width.into(), map.height.into());
    let place = uv * size - 0.5;
    let weights = place - place.floor();
    let mut sum = DVec3::ZERO;
    for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let x = (place.x.floor() as i64 + i).rem_euclid(map.width.into()) as u32;
        let y = (place.y.floor() as i64 + j).clamp(0, i64::from(map.height) - 1) as u32;
        let weight = |k: i64, w: f64| if k == 1 { w } else { 1.0 - w };
        let texel = DVec3::from_array(map.get(x, y).map(f64::from));
        sum += weight(i, weights.x) * weight(j, weights.y) * texel;
    }
    sum
}

/// What VTK 9.7.1 does: 512 samples read the mip `0.5 (2 + log2(1/(N D)) - log2(π/(6 R²)))` of a map
/// of 2R columns, which is ½ log2 12 = 1.79 levels too coarse for its texels of 8π/(2R)² in the mean.
fn level_of_vtk(light: &Environment, alpha: f64) -> Vec<RgbImage> {
    let mips = mips(&light.image);
    let halves = half_vectors(512, alpha);
    let side = f64::from(light.image.width) / 2.0;
    let texel = |n: DVec3| {
        let (t, b) = n.any_orthonormal_pair();
        let mut sum = DVec3::ZERO;
        let mut whole = 0.0;
        for h in &halves {
            let h_world = t * h.x + b * h.y + n * h.z;
            let l = 2.0 * n.dot(h_world) * h_world - n;
            let n_dot_l = n.dot(l);
            if n_dot_l > 0.0 {
                let sample = 1.0 / (512.0 * Ggx.d(*h, alpha));
                let mip = 0.5 * (2.0 + sample.log2() - (PI / (6.0 * side * side)).log2());
                let mip = mip.clamp(0.0, mips.len() as f64 - 1.0);
                let uv = uv_from_direction(l);
                let fine = bilinear(&mips[mip.floor() as usize], uv);
                let coarse = bilinear(&mips[mip.ceil() as usize], uv);
                sum += n_dot_l * fine.lerp(coarse, mip.fract());
                whole += n_dot_l;
            }
        }
        sum / whole
    };
    faces(&LAYOUTS[0], [12; 2], texel)
}

/// 1.79 levels by 512 samples are 2.29 if there were 1024.
#[test]
fn mips_of_a_lat_long_map_are_named_with_their_levels() {
    let light = lamps();
    let widths = [0.04, 0.16, 0.64];
    let map = of_levels(widths.map(|alpha| level_of_vtk(&light, alpha)).to_vec());
    let judged = judged(&light, map, Some(&widths));
    for level in 0..widths.len() {
        let [Cause::CoarseMips { levels, source }] = causes_of(&judged, level) else {
            panic!("{:?}: {}", judged.levels[level], judged.verdict());
        };
        assert_eq!(*source, MipSource::LatLong, "level {level}");
        assert!((levels - 2.29).abs() < 0.2, "level {level}: {levels}");
    }
    assert!(judged.verdict().contains("mips of the lat-long map"));
}

/// Samples of irradiance by the cosine.
const COSINE_SAMPLES: u32 = 1024;

/// Returns the levels by which an irradiance map is judged to read mips of a cube too coarse. Its
/// samples, drawn by the cosine, read `radiance` at a direction and its cosine.
fn levels_of_irradiance(light: &Environment, radiance: impl Fn(DVec3, f64) -> DVec3) -> f64 {
    let texel = |n: DVec3| {
        let (t, b) = n.any_orthonormal_pair();
        let sample = |i: u32| {
            let sin = (f64::from(i.reverse_bits()) / 2f64.powi(32)).sqrt();
            let cos = (1.0 - sin * sin).sqrt();
            let (y, x) = (2.0 * PI * f64::from(i) / f64::from(COSINE_SAMPLES)).sin_cos();
            radiance(sin * (x * t + y * b) + cos * n, cos)
        };
        (0..COSINE_SAMPLES).map(sample).sum::<DVec3>() / f64::from(COSINE_SAMPLES)
    };
    let bake = Bake {
        irradiance: Some(of_levels(vec![faces(&LAYOUTS[0], [12; 2], texel)])),
        ..Bake::default()
    };
    let judged = judged_bake(light, bake, None);
    let irradiance = judged.irradiance.as_ref().unwrap();
    let [Cause::CoarseMips { levels, source }] = irradiance.verdict.causes() else {
        panic!("{irradiance:?}");
    };
    assert_eq!(*source, MipSource::Cube);
    *levels
}

/// Each sample stands for π/(N cos) of solid angle.
#[test]
fn coarse_mips_of_irradiance_are_named_with_their_levels() {
    let light = lamps();
    let levels = levels_of_irradiance(&light, |l, cos| {
        blurred(
            &light,
            l,
            4f64.powf(2.5) * PI / (f64::from(COSINE_SAMPLES) * cos),
        )
    });
    assert!((levels - 2.5).abs() < 0.4, "{levels}");
}

/// Side of the cube whose mips are read, texels.
const CUBE_SIDE: u32 = 64;

/// A cube of the light with mips as `glGenerateMipmap` makes them.
fn cube_mips(light: &Environment) -> FilteredMap {
    let layout = MapLayout::listed("cube");
    let face = |face: u32| {
        Pixels::from_fn(CUBE_SIDE, CUBE_SIDE, |x, y| {
            let uv = (DVec2::new(x.into(), y.into()) + 0.5) / f64::from(CUBE_SIDE);
            light.radiance((layout.direction)(face, uv))
        })
    };
    let halved = |face: &Pixels<DVec3>| {
        Pixels::from_fn(face.width / 2, face.height / 2, |x, y| {
            let texel = |[i, j]: [u32; 2]| face.get(2 * x + i, 2 * y + j);
            [[0, 0], [1, 0], [0, 1], [1, 1]]
                .map(texel)
                .iter()
                .sum::<DVec3>()
                / 4.0
        })
    };
    let mut levels: Vec<Vec<Pixels<DVec3>>> = vec![(0..6).map(face).collect()];
    while levels[levels.len() - 1][0].width > 1 {
        levels.push(levels[levels.len() - 1].iter().map(halved).collect());
    }
    FilteredMap { layout, levels }
}

/// The mip that PlayCanvas 2.23.3 reads for a density of samples: it divides texels by samples, and
/// forgets the 4 pi of the sphere, ½ log2 4π = 1.83 levels.
fn mip_of_playcanvas(sample_count: u32, density: f64) -> f64 {
    let texels_per_sample = f64::from(6 * CUBE_SIDE * CUBE_SIDE) / f64::from(sample_count);
    0.5 * (texels_per_sample / density).log2()
}

/// A texel of a level as PlayCanvas filters it.
fn filtered_by_playcanvas(mips: &FilteredMap, halves: &[DVec3], alpha: f64, n: DVec3) -> DVec3 {
    let (t, b) = n.any_orthonormal_pair();
    let mut sum = DVec3::ZERO;
    let mut whole = 0.0;
    for h in halves {
        let h_world = t * h.x + b * h.y + n * h.z;
        let l = 2.0 * n.dot(h_world) * h_world - n;
        let n_dot_l = n.dot(l);
        if n_dot_l > 0.0 {
            let density = 0.25 * Ggx.d(*h, alpha) + 1e-3;
            sum += n_dot_l * mips.value(l, mip_of_playcanvas(halves.len() as u32, density));
            whole += n_dot_l;
        }
    }
    sum / whole
}

/// PlayCanvas 2.23.3 reads mips 1.83 levels too coarse, and rounds the scale of RGBP up.
#[test]
fn scales_of_rgbp_that_are_rounded_up_are_named() {
    let lamps = lamps();
    let bright = lamps.image.map(|texel| texel.map(|value| 6.0 * value));
    let light = Environment::from_image("bright", bright);
    let alphas: [f64; 6] = std::array::from_fn(|k| (k as f64 / 5.0).powi(2));
    let truth = Truth::new(&light, Kernel::cosine(&Ggx), &alphas);
    let exact: Vec<_> = alphas[1..]
        .iter()
        .map(|alpha| truth.prefiltered(*alpha))
        .collect();
    let mips = cube_mips(&light);
    let halves = alphas.map(|alpha| half_vectors(1024, alpha));
    // The coarse levels have few texels, so that the test takes little time.
    let value = |k: usize, d: DVec3| match k {
        0 => light.radiance(d),
        1..3 => exact[k - 1].value(d),
        _ => filtered_by_playcanvas(&mips, &halves[k], alphas[k], d),
    };
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("atlas.png");
    let rounding = Cause::Encoding(Encoding::RgbpScaleRoundedUp);
    for scale in [RgbpScale::RoundedUp, RgbpScale::RoundedDown] {
        atlas_of(&light, scale, value).save(&path).unwrap();
        let judged = judged_file(&light, &path);
        let verdict = judged.verdict();
        for level in [0, 3, 4, 5] {
            let causes = causes_of(&judged, level);
            assert_eq!(
                causes.contains(&rounding),
                scale == RgbpScale::RoundedUp,
                "level {level}: {verdict}"
            );
            let levels = causes.iter().find_map(|cause| match cause {
                Cause::CoarseMips { levels, .. } => Some(*levels),
                _ => None,
            });
            match levels {
                Some(levels) => {
                    assert!(
                        level > 0 && (levels - 1.83).abs() < 0.3,
                        "level {level}: {levels}"
                    );
                }
                None => assert_eq!(level, 0, "{verdict}"),
            }
        }
    }
}

/// PlayCanvas filters level k of 6 for roughness 2k/11 by mips 1.83 levels too coarse. The last mips of a
/// cube, which wide lobes read, have other means than even blurs.
#[test]
fn widths_of_playcanvas_are_named_beside_mips_of_a_cube() {
    // Lamps near the size of a texel of the map.
    let lamp = |k: u32| {
        let k = f64::from(k);
        DVec3::new((2.4 * k).cos(), 0.9 - 0.2 * k, (2.4 * k).sin()).normalize()
    };
    let light = light_of(|d| {
        let of_lamp =
            |k: u32| (400.0 * (d.dot(lamp(k)) - 1.0)).exp() * DVec3::new(60.0, 54.0, 42.0);
        (0..10).map(of_lamp).sum::<DVec3>() + 0.3 + 0.15 * d.y
    });
    let mips = cube_mips(&light);
    let level = |k: u32| match k {
        0 => faces(&LAYOUTS[0], [32; 2], |d| light.radiance(d)),
        _ => {
            let alpha = (f64::from(k) / 5.5).powi(2);
            let halves = half_vectors(1024, alpha);
            faces(&LAYOUTS[0], [12; 2], |n| {
                filtered_by_playcanvas(&mips, &halves, alpha, n)
            })
        }
    };
    let judged = judged(&light, of_levels((0..6).map(level).collect()), None);
    let verdict = judged.verdict();
    assert_eq!(law_of(&judged), Some(WidthLaw::OverHalfCount), "{verdict}");
    assert!(!verdict.contains("--scale"), "{verdict}");
    let fixed = judged.fixed.as_ref().unwrap();
    for level in 1..6 {
        let [Cause::CoarseMips { levels, source }] = causes_of(fixed, level) else {
            panic!("level {level}: {verdict}");
        };
        assert_eq!(*source, MipSource::Cube, "level {level}: {verdict}");
        assert!((levels - 1.83).abs() < 0.3, "level {level}: {levels}");
    }
}

/// Grazing samples of irradiance read the last mips of a cube, which even blurs do not resemble.
#[test]
fn irradiance_of_a_cubes_mips_is_named() {
    let light = lamps();
    let mips = cube_mips(&light);
    let levels = levels_of_irradiance(&light, |l, cos| {
        mips.value(l, 0.5 + mip_of_playcanvas(COSINE_SAMPLES, cos / PI))
    });
    assert!((levels - 2.33).abs() < 0.3, "{levels}");
}

/// What a level lacks because the sun was cut does not count as a gain of others.
#[test]
fn no_gain_is_named_beside_a_cut() {
    let sun = DVec3::new(0.9, 0.1, 0.4).normalize();
    let marked = marked_light();
    let light = light_of(|d| {
        let of_sun = if d.angle_between(sun) < 0.12 {
            1e4
        } else {
            0.0
        };
        marked.radiance(d) + DVec3::splat(of_sun)
    });
    let alphas = [0.0, 0.5];
    let truth = Truth::new(&light, Kernel::cosine(&Ggx), &alphas);
    let mut map = exact(&truth, &alphas);
    let mut level_0 = of_levels(vec![map.levels[0].clone()]);
    each_texel(&mut level_0, |texel| texel.map(|value| value.min(100.0)));
    map.levels[0] = level_0.levels.swap_remove(0);
    let mut level_1 = of_levels(vec![map.levels[1].clone()]);
    each_texel(&mut level_1, |texel| texel.map(|value| 1.08 * value));
    map.levels[1] = level_1.levels.swap_remove(0);
    let judged = judged(&light, map, Some(&alphas));
    let verdict = judged.verdict();
    assert!(verdict.contains("cut at 100"), "{verdict}");
    assert!(!verdict.contains("--scale"), "{verdict}");
}
