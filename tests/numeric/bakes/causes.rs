//! Causes that programs of the field have, each made by its formula and put into an exact bake.

use super::files::faces;
use super::scores::{light_of, marked_light};
use super::slips::{SIDE, each_texel, exact, judged, judged_bake, of_levels};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use splitsum::bake::convention::{Axes, PRESETS};
use splitsum::bake::judge::{
    Cause, ChainSlip, Doubt, FaceTurn, Judged, MipSource, Mips, SourceSlip, TableFlags, TableSlip,
    TexelGrid, Truth, Verdict, WidthLaw, WrongBorders, table,
};
use splitsum::bake::make::dfg;
use splitsum::bake::{Bake, Map};
use splitsum::base::math::equirect::{direction_from_uv, uv_from_direction};
use splitsum::base::names::Listed;
use splitsum::base::pixels::{Pixels, RgbImage};
use splitsum::instrument::brdf::{Brdf, Ggx, MaskingShadowing};
use splitsum::instrument::environment::Environment;
use splitsum::instrument::environment::layout::{FilteredMap, LAYOUTS};
use splitsum::instrument::precompute::prefilter::Kernel;
use std::f64::consts::PI;

const ALPHAS: [f64; 2] = [0.2, 0.6];

fn truth(light: &Environment) -> Truth<'_> {
    Truth::new(light, Kernel::cosine(&Ggx), &ALPHAS)
}

pub fn causes_of(judged: &Judged, level: usize) -> &[Cause] {
    judged.levels[level].verdict.causes()
}

/// A level of texels elsewhere in their faces: at `place(i, n)` of columns and rows.
fn placed(
    side: u32,
    place: [fn(f64, f64) -> f64; 2],
    value: impl Fn(DVec3) -> DVec3,
) -> Vec<RgbImage> {
    let n = f64::from(side);
    let texel = |face: u32, x: u32, y: u32| {
        let uv = DVec2::new(place[0](x.into(), n), place[1](y.into(), n));
        value((LAYOUTS[0].direction)(face, uv)).as_vec3().to_array()
    };
    (0..6)
        .map(|face| RgbImage::from_fn(side, side, |x, y| texel(face, x, y)))
        .collect()
}

/// A sun of 1e4 in half a degree of arc is most of the light; dark texels alone would show a gain.
#[test]
fn a_cut_is_named_beside_point_lookups_with_the_light_it_costs() {
    let sun = DVec3::new(0.5, 0.7, 0.4).normalize();
    let marked = marked_light();
    let light = light_of(|d| {
        let sun = if d.angle_between(sun) < 0.12 {
            1e4
        } else {
            0.0
        };
        marked.radiance(d) + sun
    });
    let looked_up = of_levels(vec![faces(&LAYOUTS[0], [SIDE; 2], |d| light.radiance(d))]);
    let mut cut = looked_up.clone();
    each_texel(&mut cut, |rgb| rgb.map(|x| x.min(255.0)));
    let judged = judged(&light, cut, Some(&[0.0]));
    let bias = judged.levels[0].errors.bias_rel;
    assert!(bias < -0.5, "{bias}");
    let causes = causes_of(&judged, 0);
    let named = causes
        .iter()
        .any(|cause| matches!(cause, Cause::Cut(slip) if slip.limit == 255.0));
    assert!(named, "{causes:?}");
    assert!(
        !causes.iter().any(|cause| matches!(cause, Cause::Gain(_))),
        "{causes:?}"
    );
}

/// 0.5 % of the mean below 0 in a sixth of the texels is within 3 % rms.
#[test]
fn negative_texels_of_a_good_level_are_counted_and_placed() {
    let light = light_of(|d| DVec3::splat((30.0 * (d.y - 1.0)).exp()));
    let mut map = exact(&truth(&light), &ALPHAS[..1]);
    let mean = light.luminance.mean as f32;
    let mut count = 0;
    for (index, texel) in map.levels[0][3].data.iter_mut().enumerate() {
        let is_lowest = index == 77;
        *texel = [if is_lowest { -0.006 } else { -0.005 } * mean; 3];
        count += 1;
    }
    let judged = judged(&light, map, Some(&ALPHAS[..1]));
    assert!(judged.levels[0].errors.relmse < 1e-3, "{judged:?}");
    let [Cause::Negative(texels)] = causes_of(&judged, 0) else {
        panic!("{:?}", judged.levels[0].verdict);
    };
    assert_eq!([texels.count, texels.total], [count, 6 * count]);
    let side = SIDE as usize;
    assert_eq!(texels.texel, [3, 77 % side, 77 / side]);
    assert!((texels.lowest / f64::from(-0.006 * mean) - 1.0).abs() < 1e-6);
}

#[test]
fn rows_from_the_bottom_are_named_beside_other_axes() {
    let light = marked_light();
    let axes = Axes::parse("-x+y+z").unwrap();
    let truth = truth(&light);
    let flipped = |alpha: &f64| {
        let map = truth.prefiltered(*alpha);
        faces(&LAYOUTS[0], [SIDE; 2], |d| map.value(axes.to_world(d)))
            .iter()
            .map(|face| RgbImage::from_fn(SIDE, SIDE, |x, y| face.get(x, SIDE - 1 - y)))
            .collect()
    };
    let judged = judged(
        &light,
        of_levels(ALPHAS.iter().map(flipped).collect()),
        Some(&ALPHAS),
    );
    let causes = judged.causes();
    let [
        Cause::Doubt(Doubt::TurnedFaces {
            turn,
            best,
            has_other_axes: true,
        }),
    ] = causes[..]
    else {
        panic!("{causes:?}");
    };
    assert_eq!((turn, best.axes), (FaceTurn::FlippedTopBottom, axes));
    assert!(
        judged
            .verdict()
            .contains("flipped top to bottom; axes -x+y+z")
            && judged.verdict().ends_with("nothing else"),
        "{}",
        judged.verdict()
    );
}

/// Babylon.js filters its last levels wider than any microfacet.
#[test]
fn widths_above_one_are_kernels_too() {
    let light = marked_light();
    let alphas = [0.2, 1.19, 2.83];
    let truth = Truth::new(&light, Kernel::cosine(&Ggx), &alphas);
    let judged = judged(&light, exact(&truth, &alphas), Some(&alphas));
    assert!(
        judged.levels.iter().all(|level| level.verdict.is_good()),
        "{}",
        judged.verdict()
    );
}

#[test]
fn texels_at_mixed_corners_and_rounded_lookups_are_named() {
    let light = marked_light();
    let map = truth(&light).prefiltered(0.1);
    let near = |i: f64, n: f64| i / n;
    let far = |i: f64, n: f64| (i + 1.0) / n;
    type At = fn(f64, f64) -> f64;
    let cases: [([At; 2], TexelGrid); 2] = [
        ([near, far], TexelGrid::NearFarCorners),
        ([far, near], TexelGrid::FarNearCorners),
    ];
    for (place, grid) in cases {
        let level = placed(SIDE, place, |d| map.value(d));
        let judged = judged(&light, of_levels(vec![level]), Some(&[0.1]));
        assert_eq!(causes_of(&judged, 0), [Cause::Grid(grid)]);
    }
    let image = &light.image;
    let rounded = |d: DVec3| {
        let uv = uv_from_direction(d) * DVec2::new(image.width.into(), image.height.into());
        let [x, y] = uv.round().to_array().map(|x| x as u32);
        DVec3::from_array(
            image
                .get(x % image.width, y.min(image.height - 1))
                .map(f64::from),
        )
    };
    let level = faces(&LAYOUTS[0], [SIDE; 2], rounded);
    let judged = judged(&light, of_levels(vec![level]), Some(&[0.0]));
    assert_eq!(
        causes_of(&judged, 0),
        [Cause::Mips(Mips::OneLookupRounded)],
        "{}",
        judged.verdict()
    );
}

/// Level 0 at corners is looked up as if at centres, and convolved.
#[test]
fn half_a_texel_that_level_0_hands_on_is_named() {
    let light = marked_light();
    let corner = |i: f64, n: f64| i / n;
    let level_0 = placed(16, [corner, corner], |d| light.radiance(d));
    let texels = |face: &RgbImage| face.map(|rgb| DVec3::from_array(rgb.map(f64::from)));
    let filtered = FilteredMap {
        layout: &LAYOUTS[0],
        levels: vec![level_0.iter().map(texels).collect()],
    };
    let shifted = light_of(|d| filtered.value(d, 0.0));
    let alphas = [0.0, 0.1, 0.2];
    let of_shifted = Truth::new(&shifted, Kernel::cosine(&Ggx), &alphas);
    let mut map = exact(&of_shifted, &alphas);
    map.levels[0] = level_0;
    let judged = judged(&light, map, Some(&alphas));
    for level in 1..3 {
        assert_eq!(
            causes_of(&judged, level),
            [Cause::Source(SourceSlip::Level0)],
            "{}",
            judged.verdict()
        );
    }
}

/// Half vectors of GGX on a Hammersley grid, as bakers draw them.
pub fn half_vectors(count: u32, alpha: f64) -> Vec<DVec3> {
    (0..count)
        .map(|i| {
            let xi = f64::from(i.reverse_bits()) / 2f64.powi(32);
            let phi = 2.0 * PI * f64::from(i) / f64::from(count);
            let cos = ((1.0 - xi) / (1.0 + (alpha * alpha - 1.0) * xi)).sqrt();
            let sin = (1.0 - cos * cos).sqrt();
            DVec3::new(sin * phi.cos(), sin * phi.sin(), cos)
        })
        .collect()
}

/// What 1024 samples make of the light that each blurs as linear lookups do `levels` too high: by a
/// Gaussian about it, whose variance along an axis is a quarter of the texels' solid angle. Eight
/// directions at `√2 σ` have this variance.
pub fn coarse_texel(
    light: &Environment,
    halves: &[DVec3],
    alpha: f64,
    levels: f64,
    n: DVec3,
) -> DVec3 {
    let (t, b) = n.any_orthonormal_pair();
    let mut sum = DVec3::ZERO;
    let mut whole = 0.0;
    for h in halves {
        let h_world = t * h.x + b * h.y + n * h.z;
        let l = 2.0 * n.dot(h_world) * h_world - n;
        let n_dot_l = n.dot(l);
        if n_dot_l > 0.0 {
            let pdf = Ggx.d(*h, alpha) / 4.0;
            let omega = 4f64.powf(levels) / (1024.0 * pdf);
            sum += n_dot_l * blurred(light, l, omega);
            whole += n_dot_l;
        }
    }
    sum / whole
}

/// The light along l, by a lookup in texels of this solid angle.
pub fn blurred(light: &Environment, l: DVec3, omega: f64) -> DVec3 {
    let radius = (2.0 * omega / 4.0).sqrt();
    let (right, up) = l.any_orthonormal_pair();
    let around = |k: u32| {
        let (sin, cos) = (PI * f64::from(k) / 4.0).sin_cos();
        light.radiance(l + radius.tan() * (right * cos + up * sin))
    };
    (0..8).map(around).sum::<DVec3>() / 8.0
}

fn coarse_level(light: &Environment, alpha: f64, levels: f64) -> Vec<RgbImage> {
    let halves = half_vectors(1024, alpha);
    let texel = |n: DVec3| coarse_texel(light, &halves, alpha, levels, n);
    faces(&LAYOUTS[0], [8; 2], texel)
}

#[test]
fn samples_that_read_mips_too_coarse_are_named_with_their_levels() {
    let light = marked_light();
    let map = of_levels(
        ALPHAS
            .map(|alpha| coarse_level(&light, alpha, 2.5))
            .to_vec(),
    );
    let judged = judged(&light, map, Some(&ALPHAS));
    let [Cause::CoarseMips { levels, source }] = causes_of(&judged, 1) else {
        panic!("{:?}: {}", judged.levels, judged.verdict());
    };
    assert!((levels - 2.5).abs() < 0.4, "{levels}");
    assert_eq!(*source, MipSource::Cube);
    let has_gain = judged
        .causes()
        .iter()
        .any(|cause| matches!(cause, Cause::Gain(_)));
    assert!(!has_gain, "{}", judged.verdict());
}

/// A chain of `count` levels whose level k is filtered for roughness k/`last`, by samples that read
/// mips `levels` too coarse.
fn coarse_chain(light: &Environment, count: usize, last: f64, levels: f64) -> Judged {
    let level = |k: usize| match k {
        0 => faces(&LAYOUTS[0], [SIDE; 2], |d| light.radiance(d)),
        _ => coarse_level(light, (k as f64 / last).powi(2), levels),
    };
    judged(light, of_levels((0..count).map(level).collect()), None)
}

pub fn law_of(judged: &Judged) -> Option<WidthLaw> {
    match judged.chain.as_ref().map(|chain| &chain.slip) {
        Some(ChainSlip::Law { law, .. }) => Some(*law),
        _ => None,
    }
}

/// Ten lamps of 3 degrees on a dim sky.
pub fn lamps() -> Environment {
    let lamp = |k: u32| {
        let k = f64::from(k);
        DVec3::new((2.4 * k).cos(), 0.9 - 0.2 * k, (2.4 * k).sin()).normalize()
    };
    let radiance = |x: u32, y: u32| {
        let uv = (DVec2::new(x.into(), y.into()) + 0.5) / DVec2::new(256.0, 128.0);
        let d = direction_from_uv(uv);
        let of_lamp =
            |k: u32| (400.0 * (d.dot(lamp(k)) - 1.0)).exp() * DVec3::new(40.0, 35.0, 30.0);
        let sky = 0.3 + 0.2 * d.y;
        ((0..10).map(of_lamp).sum::<DVec3>() + sky)
            .as_vec3()
            .to_array()
    };
    Environment::from_image("lamps", RgbImage::from_fn(256, 128, radiance))
}

/// VTK 9.7 filters level k of 5 for roughness k/5, and PlayCanvas 2.23 level k of 6 for 2k/11, both
/// by mips that are too coarse. Slight ones hide in the width; of three levels, no width explains
/// every level.
#[test]
fn chains_of_other_widths_are_named_beside_coarse_mips() {
    let light = lamps();
    let vtk = coarse_chain(&light, 5, 5.0, 3.0);
    assert_eq!(law_of(&vtk), Some(WidthLaw::OverCount), "{}", vtk.verdict());
    let fixed = vtk.fixed.as_ref().unwrap();
    let [Cause::CoarseMips { levels, .. }] = causes_of(fixed, 1) else {
        panic!("{}", vtk.verdict());
    };
    assert!((levels - 3.0).abs() < 0.4, "{levels}");

    let playcanvas = coarse_chain(&light, 6, 5.5, 1.8);
    let words = playcanvas.verdict();
    assert_eq!(
        law_of(&playcanvas),
        Some(WidthLaw::OverHalfCount),
        "{words}"
    );
    let fixed = playcanvas.fixed.as_ref().unwrap();
    let wide = fixed.levels[1..].iter();
    assert!(wide.clone().all(|level| level.verdict.is_good()), "{words}");
}

/// With the widths that are read, coarse mips alone are named.
#[test]
fn coarse_mips_of_right_widths_are_not_another_chain() {
    let judged = coarse_chain(&lamps(), 5, 4.0, 3.0);
    assert!(judged.chain.is_none(), "{}", judged.verdict());
    let [Cause::CoarseMips { levels, source }] = causes_of(&judged, 1) else {
        panic!("{}", judged.verdict());
    };
    assert!((levels - 3.0).abs() < 0.4, "{levels}");
    assert_eq!(*source, MipSource::Cube);
}

/// The last level is up to 12 % too dark towards -y, as no known slip makes it.
#[test]
fn a_chain_is_named_beside_a_slip_that_is_not_known() {
    let light = marked_light();
    let alphas: Vec<f64> = (0..6).map(|k| (f64::from(k) / 5.5).powi(2)).collect();
    let truth = Truth::new(&light, Kernel::cosine(&Ggx), &alphas);
    let mut map = exact(&truth, &alphas);
    map.levels[5] = {
        let right = truth.prefiltered(alphas[5]);
        let darker = |d: DVec3| (1.0 - 0.12 * (-d.y).max(0.0)) * right.value(d);
        faces(&LAYOUTS[0], [SIDE; 2], darker)
    };
    let judged = judged(&light, map, None);
    assert_eq!(
        law_of(&judged),
        Some(WidthLaw::OverHalfCount),
        "{}",
        judged.verdict()
    );
}

/// Each face's light alone, normalized within the face.
#[test]
fn faces_filtered_one_by_one_and_flat_levels_are_named() {
    let light = marked_light();
    let fine = 64;
    let fine_faces = faces(&LAYOUTS[0], [fine; 2], |d| light.radiance(d));
    let alpha: f64 = 0.4;
    let level: Vec<RgbImage> = (0..6)
        .map(|face| {
            RgbImage::from_fn(16, 16, |x, y| {
                let uv = (DVec2::new(x.into(), y.into()) + 0.5) / 16.0;
                let r = (LAYOUTS[0].direction)(face, uv);
                let mut sum = DVec3::ZERO;
                let mut whole = 0.0;
                for texel in 0..fine * fine {
                    let [column, row] = [texel % fine, texel / fine];
                    let uv = (DVec2::new(column.into(), row.into()) + 0.5) / f64::from(fine);
                    let l = (LAYOUTS[0].direction)(face, uv);
                    let cos = r.dot(l).max(0.0);
                    let half = 0.5 + 0.5 * cos;
                    let d = alpha / (1.0 + half * (alpha * alpha - 1.0));
                    let omega = (LAYOUTS[0].texel_solid_angle)(l, [fine; 2], 0.0);
                    let weight = omega * cos * d * d;
                    let radiance = fine_faces[face as usize].get(column, row).map(f64::from);
                    sum += weight * DVec3::from_array(radiance);
                    whole += weight;
                }
                (sum / whole).as_vec3().to_array()
            })
        })
        .collect();
    let alone = judged(&light, of_levels(vec![level]), Some(&[alpha]));
    assert_eq!(
        causes_of(&alone, 0),
        [Cause::FacesAlone],
        "{}",
        alone.verdict()
    );

    let mut map = exact(&truth(&light), &ALPHAS);
    map.levels
        .insert(0, vec![RgbImage::filled(SIDE, SIDE, [0.7; 3]); 6]);
    let flat = judged(&light, map, Some(&[0.0, 0.2, 0.6]));
    assert_eq!(causes_of(&flat, 0), [Cause::Flat], "{}", flat.verdict());
    assert!(flat.levels[1].verdict.is_good(), "{}", flat.verdict());
}

/// Level k of six for roughness k/6, for 2k/11 and for 0.8 k/5.
#[test]
fn chains_of_a_wrong_count_and_of_a_factor_are_named() {
    let light = marked_light();
    let law_of = |alphas: &[f64]| {
        let truth = Truth::new(&light, Kernel::cosine(&Ggx), alphas);
        let judged = judged(&light, exact(&truth, alphas), None);
        law_of(&judged).unwrap_or_else(|| panic!("{}", judged.verdict()))
    };
    let by = |last: f64| -> Vec<f64> { (0..6).map(|k| (f64::from(k) / last).powi(2)).collect() };
    assert_eq!(law_of(&by(6.0)), WidthLaw::OverCount);
    assert_eq!(law_of(&by(5.5)), WidthLaw::OverHalfCount);
    let WidthLaw::RoughnessTimes(factor) = law_of(&by(6.25)) else {
        panic!("another law");
    };
    assert!((factor - 0.8).abs() < 0.01, "{factor}");
}

fn table_causes(image: &RgbImage) -> Vec<Cause> {
    match table::score(image, &Ggx, &PRESETS[0].convention()).verdict {
        Verdict::Good(_) => Vec::new(),
        Verdict::Wrong(causes) | Verdict::Unexplained(causes) => causes,
    }
}

#[test]
fn wrong_borders_of_a_table_are_named() {
    let convention = PRESETS[0].convention();
    let mut image = dfg(&Ggx, convention.masking, convention.table_axes, 32);
    assert!(table_causes(&image).is_empty());
    for i in 0..32 {
        image.data[i * 32 + 31] = [0.0; 3];
        image.data[31 * 32 + i] = [0.0; 3];
    }
    let borders = WrongBorders {
        right: true,
        bottom: true,
        ..WrongBorders::default()
    };
    assert_eq!(
        table_causes(&image),
        [Cause::Table(TableSlip::Borders(borders))]
    );
}

/// The table of LearnOpenGL: 1024 samples, Schlick's masking with k = alpha/2 on both sides.
fn learn_open_gl(side: u32) -> RgbImage {
    let texel = |index: u32| {
        let n_dot_v = (f64::from(index % side) + 0.5) / f64::from(side);
        let roughness = (f64::from(index / side) + 0.5) / f64::from(side);
        let v = DVec3::new((1.0 - n_dot_v * n_dot_v).sqrt(), 0.0, n_dot_v);
        let k = roughness * roughness / 2.0;
        let g1 = |cos: f64| cos / (cos * (1.0 - k) + k);
        let mut pair = [0.0; 2];
        for h in half_vectors(1024, roughness * roughness) {
            let v_dot_h = v.dot(h).max(0.0);
            let n_dot_l = 2.0 * v.dot(h) * h.z - v.z;
            if n_dot_l > 0.0 {
                let visibility = g1(n_dot_v) * g1(n_dot_l) * v_dot_h / (h.z * n_dot_v);
                let fresnel = (1.0 - v_dot_h).powi(5);
                pair[0] += (1.0 - fresnel) * visibility / 1024.0;
                pair[1] += fresnel * visibility / 1024.0;
            }
        }
        [pair[0] as f32, pair[1] as f32, 0.0]
    };
    let data = (0..side * side).into_par_iter().map(texel).collect();
    Pixels::new(side, side, data)
}

#[test]
fn the_usual_tutorials_table_is_named_at_every_size() {
    for side in [32, 128, 256] {
        let causes = table_causes(&learn_open_gl(side));
        let schlick = |cause: &Cause| {
            matches!(
                cause,
                Cause::Table(TableSlip::Convention {
                    flags: TableFlags {
                        axes: None,
                        channels: None,
                        masking: Some("schlick"),
                    },
                    ..
                })
            )
        };
        assert!(causes.iter().any(schlick), "{side}: {causes:?}");
    }
    assert!(MaskingShadowing::parse("schlick").is_ok());
}

/// An irradiance map with a part that is not wrong keeps its verdict beside turned faces.
#[test]
fn a_good_irradiance_map_beside_turned_faces_is_good() {
    let light = marked_light();
    let truth = truth(&light);
    let turned: Map = {
        let mut map = exact(&truth, &ALPHAS);
        for face in map.levels.iter_mut().flatten() {
            *face = RgbImage::from_fn(SIDE, SIDE, |x, y| face.get(x, SIDE - 1 - y));
        }
        map
    };
    let (kernel, alpha) = Truth::of_irradiance();
    let irradiance = Truth::new(&light, kernel, &[alpha]).prefiltered(alpha);
    let bake = Bake {
        specular: Some(turned),
        irradiance: Some(of_levels(vec![faces(&LAYOUTS[0], [SIDE; 2], |d| {
            irradiance.value(d)
        })])),
        ..Bake::default()
    };
    let judged = judged_bake(&light, bake, Some(&ALPHAS));
    assert!(
        judged
            .verdict()
            .contains("every face is flipped top to bottom"),
        "{}",
        judged.verdict()
    );
    assert!(judged.irradiance.as_ref().unwrap().verdict.is_good());
}
