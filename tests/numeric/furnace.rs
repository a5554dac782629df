//! White furnaces in f64: what the twins of the methods reflect of radiance 1, with the light that a
//! compensation returns; and the factor and the dielectrics of Blender's Cycles.

use crate::compensation_twins::{factor, multiple, reflectance};
use glam::{DVec2, DVec3};
use splitsum::base::math::sequence::SEQUENCES;
use splitsum::base::names::Listed;
use splitsum::base::pixels::Pixels;
use splitsum::instrument::brdf::{
    Compensation, FresnelWeight, Ggx, MaskingShadowing, Stretch, Widths, f0_from_ior,
};
use splitsum::instrument::environment::layout::{FilteredMap, MapLayout};
use splitsum::instrument::precompute::PrecomputeSettings;
use splitsum::instrument::precompute::dfg::reference::{dfg, dfg_of, table};
use splitsum::instrument::precompute::dfg::{Albedos, DfgAxes};
use splitsum::instrument::precompute::prefilter::Kernel;
use splitsum::instrument::precompute::taps::{TapCount, TapTable};
use splitsum::instrument::shade::bend::Bend;
use splitsum::instrument::shade::reference::Surface;
use splitsum::instrument::shade::twin::{Light, Samples, Twin};
use splitsum::instrument::shade::{METHODS, Method};
use std::collections::BTreeMap;

const MODEL: Ggx = Ggx;
const MASKING: MaskingShadowing = MaskingShadowing::Correlated;

/// Radiance 1 in every table, and a smooth table of A and B.
fn white_light() -> Light {
    let settings = PrecomputeSettings::default();
    let layout = MapLayout::listed("equirect");
    let ones = |side: u32| Pixels::filled(2 * side, side, DVec3::ONE);
    let map = |sides: &[u32]| FilteredMap {
        layout,
        levels: sides.iter().map(|side| vec![ones(*side)]).collect(),
    };
    // Places and levels do not matter here, and weights add up to 1.
    let taps = |count: TapCount| {
        let [width, height] = TapTable::size(count);
        let weight = 1.0 / (count as u32) as f32;
        TapTable {
            texels: Pixels::filled(width, height, [weight; 4]),
        }
    };
    Light {
        environment: vec![ones(4)],
        filtered: map(&[4, 2, 1]),
        prefiltered: map(&[4, 2, 1]),
        level_mapping: settings.level_mapping,
        dfg: Pixels::from_fn(16, 16, |x, y| {
            DVec2::new(0.9 - 0.02 * f64::from(y), 0.08 - 0.004 * f64::from(x))
        }),
        dfg_axes: DfgAxes::FourthRoots,
        albedos: Albedos::new(Kernel::cosine(&MODEL), MASKING, 1.0),
        one_tap: taps(TapCount::One),
        two_taps: taps(TapCount::Two),
        four_taps: taps(TapCount::Four),
        irradiance_map: map(&[2]),
        sh9: Default::default(),
    }
}

/// `2 ∫ E μ dμ` of the table at one alpha, by 64 midpoints as on the device.
fn mean_albedo(light: &Light, alpha: f64) -> f64 {
    let cosine = |i: u32| (f64::from(i) + 0.5) / 64.0;
    (0..64)
        .map(|i| 2.0 * cosine(i) / 64.0 * light.dfg(cosine(i), alpha).element_sum())
        .sum()
}

/// Each split sum with each compensation returns 1 of radiance 1 for F0 1; below it, what the
/// diffuse term gets of the rest is at least 0. Methods agree with their table about alpha.
#[test]
fn split_sums_and_compensations_add_up_to_the_whole_light() {
    let light = white_light();
    let split_sums: Vec<&Method> = METHODS
        .iter()
        .filter(|method| method.uses_prefiltered() && method.uses_dfg)
        .collect();
    assert!(split_sums.len() > 12, "{}", split_sums.len());
    for method in split_sums {
        let Twin::Estimator(estimate) = method.twin else {
            panic!("{} has no estimator", method.name)
        };
        let bends = Bend::all().take(if method.uses_bend { usize::MAX } else { 1 });
        for bend in bends {
            for (x, y, n_dot_v) in [(0.8, 0.2, 0.6), (0.3, 0.3, 0.2), (0.5, 0.1, 0.95)] {
                let sine = f64::sqrt(1.0 - n_dot_v * n_dot_v);
                let v = DVec3::new(0.6 * sine, -0.8 * sine, n_dot_v);
                let stretch = Stretch {
                    widths: Widths(DVec2::new(x, y)),
                    tangent: DVec3::X,
                };
                let surface = Surface::new(&MODEL, MASKING, x, DVec3::ONE, [DVec3::Z, v]);
                let surface = surface.stretched(stretch);
                let samples = Samples {
                    count: 1,
                    sequence: &SEQUENCES[0],
                    set: 0,
                    pixel: None,
                    lod_bias: 0.0,
                    bend,
                };
                let single = estimate(&surface, &light, &samples);
                let alpha = if method.uses_bend {
                    bend.table_alpha(surface.widths())
                } else {
                    surface.alpha
                };
                let pair = light.dfg(n_dot_v, alpha);
                let mean = mean_albedo(&light, alpha);
                for &compensation in Compensation::all() {
                    if compensation == Compensation::None {
                        continue;
                    }
                    let whole = single
                        * factor(compensation, FresnelWeight::Schlick, DVec3::ONE, pair, mean)
                        + multiple(compensation, FresnelWeight::Schlick, DVec3::ONE, pair, mean);
                    let case = format!("{} {} {compensation:?} {x} {y}", method.name, bend.name);
                    assert!((whole - 1.0).abs().max_element() < 1e-6, "{case}: {whole}");
                    let rest = 1.0
                        - reflectance(
                            compensation,
                            FresnelWeight::Schlick,
                            DVec3::splat(0.5),
                            pair,
                            mean,
                        );
                    assert!(rest.min_element() > 0.0, "{case}: {rest}");
                }
            }
        }
    }
}

/// An engine with a factor of its own: the method, and the BRDF that its pictures are compared with.
struct Engine {
    name: &'static str,
    method: &'static str,
    masking: MaskingShadowing,
    compensation: Compensation,
}

const ENGINES: [Engine; 3] = [
    Engine {
        name: "vtk",
        method: "split-sum-vtk",
        masking: MaskingShadowing::Schlick,
        compensation: Compensation::FdezAguera,
    },
    Engine {
        name: "playcanvas",
        method: "split-sum-playcanvas",
        masking: MaskingShadowing::Correlated,
        compensation: Compensation::None,
    },
    Engine {
        name: "babylon",
        method: "split-sum-babylon",
        masking: MaskingShadowing::Correlated,
        compensation: Compensation::Turquin,
    },
];

impl Engine {
    /// Returns the mean of the method over the mean of the exact light, on the disc of a sphere in
    /// radiance 1, both with the compensation.
    fn mean_ratio(&self, light: &Light, f0: DVec3, alpha: f64, radius: f64) -> f64 {
        const RINGS: u32 = 256;
        let Twin::Estimator(estimate) = Method::listed(self.method).twin else {
            panic!("{} has no estimator", self.method)
        };
        let samples = Samples {
            count: 1,
            sequence: &SEQUENCES[0],
            set: 0,
            pixel: None,
            lod_bias: 0.0,
            bend: Bend::all().next().unwrap(),
        };
        let mean_albedo = mean_albedo(light, alpha);
        // Rings of equal area.
        let sums = (0..RINGS).map(|ring| {
            let sine2 = radius * radius * (f64::from(ring) + 0.5) / f64::from(RINGS);
            let v = DVec3::new(sine2.sqrt(), 0.0, (1.0 - sine2).sqrt());
            let surface = Surface::new(&MODEL, self.masking, alpha, f0, [DVec3::Z, v]);
            let pair = light.dfg(v.z, alpha);
            let (of, schlick) = (self.compensation, FresnelWeight::Schlick);
            let found = estimate(&surface, light, &samples)
                * factor(of, schlick, f0, pair, mean_albedo)
                + multiple(of, schlick, f0, pair, mean_albedo);
            let exact = reflectance(of, schlick, f0, pair, mean_albedo);
            [found, exact].map(|color| color.element_sum() / 3.0 / f64::from(RINGS))
        });
        let [found, exact] = sums.fold([0.0; 2], |[a, b], [x, y]| [a + x, b + y]);
        found / exact
    }
}

/// One row of `results/engines/spheres.csv`.
#[derive(serde::Deserialize)]
struct Sphere {
    engine: String,
    material: String,
    map: String,
    roughness: f64,
    /// Mean of the engine's picture over the reference's.
    mean_ratio: f64,
}

/// In constant light no lookup errs. There the methods with a factor of an engine differ from the
/// exact light as the engine's own pictures do, within 1 %; the exact factors do not. At the outline
/// the exact light of a dielectric grows steeply, so half a pixel more or less of it is allowed.
#[test]
fn pictures_confirm_the_factors_of_engines() {
    /// Width of a pixel of the pictures over the sphere's radius.
    const PIXEL: f64 = 2.0 * 1.05 / 96.0;
    /// Pixels at the outline that scripts/engines/compare.py leaves out.
    const OUTLINE: f64 = 1.25;
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/results/engines/spheres.csv");
    let rows: Vec<Sphere> = csv::Reader::from_path(path)
        .unwrap()
        .deserialize()
        .collect::<Result<_, _>>()
        .unwrap();
    for engine in &ENGINES {
        let axes = DfgAxes::FourthRoots;
        let light = Light {
            dfg: table(&MODEL, engine.masking, axes, 64, 1e-3),
            dfg_axes: axes,
            ..white_light()
        };
        let mut count = 0;
        for row in rows
            .iter()
            .filter(|row| row.engine == engine.name && row.map == "constant")
        {
            let f0 = match row.material.as_str() {
                "metal" => DVec3::new(1.0, 0.5, 0.2),
                "dielectric" => DVec3::splat(0.04),
                _ => continue,
            };
            let alpha = row.roughness * row.roughness;
            let [a, b] = [OUTLINE + 0.5, OUTLINE - 0.5].map(|pixels| {
                engine.mean_ratio(&light, f0, alpha, 1.0 - pixels * PIXEL) / row.mean_ratio
            });
            let name = format!("{} {} {}", engine.name, row.material, row.roughness);
            println!("{name}: {a:.4} to {b:.4} of the picture");
            assert!(a.min(b) < 1.01 && a.max(b) > 0.99, "{name}: {a} to {b}");
            count += 1;
        }
        assert!(count >= 8, "{}: {count}", engine.name);
    }
}

/// One row of `tests/golden/cycles_multiscatter.csv`.
#[derive(serde::Deserialize)]
struct CyclesRow {
    f0: f64,
    perceptual_roughness: f64,
    n_dot_v: f64,
    /// Radiance of the plane in radiance 1.
    radiance: f64,
}

/// Planes of Blender's Cycles by its Multiscatter GGX in constant light, written by
/// `scripts/engines/cycles/planes.py`: ten colours, five roughnesses, two views.
#[test]
fn the_compensation_of_cycles_is_blenders() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/golden/cycles_multiscatter.csv"
    );
    let rows: Vec<CyclesRow> = csv::Reader::from_path(path)
        .unwrap()
        .deserialize()
        .collect::<Result<_, _>>()
        .unwrap();
    assert_eq!(rows.len(), 300);
    let (mut worst, mut gap) = (0.0f64, 0.0f64);
    // By roughness and view: (A, B), and the mean albedo.
    let mut known: BTreeMap<[u64; 2], (DVec2, f64)> = BTreeMap::new();
    for row in &rows {
        let alpha = row.perceptual_roughness * row.perceptual_roughness;
        let at = |n_dot_v: f64| {
            let exact = dfg(&MODEL, MASKING, n_dot_v, alpha);
            DVec2::new(exact.f0_scale, exact.f90_scale)
        };
        let cosine = |i: u32| (f64::from(i) + 0.5) / 16.0;
        let (pair, mean) = *known
            .entry([alpha.to_bits(), row.n_dot_v.to_bits()])
            .or_insert_with(|| {
                let mean = (0..16)
                    .map(|i| 2.0 * cosine(i) / 16.0 * at(cosine(i)).element_sum())
                    .sum();
                (at(row.n_dot_v), mean)
            });
        let shown = |compensation| {
            reflectance(
                compensation,
                FresnelWeight::Schlick,
                DVec3::splat(row.f0),
                pair,
                mean,
            )
            .x
        };
        worst = worst.max((shown(Compensation::Cycles) / row.radiance - 1.0).abs());
        gap = gap.max((shown(Compensation::Turquin) / row.radiance - 1.0).abs());
    }
    println!("cycles: at most {worst:.2e} off, turquin {gap:.2e}");
    assert!(worst < 1e-3, "{worst}");
    assert!(gap > 0.1, "turquin would pass as well: {gap}");
}

/// One row of `tests/golden/cycles_dielectric.csv`.
#[derive(serde::Deserialize)]
struct DielectricRow {
    ior: f64,
    perceptual_roughness: f64,
    n_dot_v: f64,
    radiance: f64,
}

/// Black dielectrics of Blender's Cycles by GGX in constant light: `f0 A + B` with the exact weight.
#[test]
fn exact_dielectrics_are_blenders() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/golden/cycles_dielectric.csv"
    );
    let rows: Vec<DielectricRow> = csv::Reader::from_path(path)
        .unwrap()
        .deserialize()
        .collect::<Result<_, _>>()
        .unwrap();
    assert_eq!(rows.len(), 50);
    let (mut worst, mut gap) = (0.0f64, 0.0f64);
    for row in &rows {
        let alpha = row.perceptual_roughness * row.perceptual_roughness;
        let f0 = f0_from_ior(row.ior);
        let shown = |fresnel| {
            let pair = dfg_of(&MODEL, MASKING, fresnel, row.n_dot_v, alpha);
            f0 * pair.f0_scale + pair.f90_scale
        };
        let off = |fresnel| (shown(fresnel) / row.radiance - 1.0).abs();
        worst = worst.max(off(FresnelWeight::Dielectric { f0 }));
        gap = gap.max(off(FresnelWeight::Schlick));
    }
    println!("exact: at most {worst:.2e} off, Schlick's {gap:.2e}");
    assert!(worst < 1e-3, "{worst}");
    assert!(gap > 0.1, "Schlick's would pass as well: {gap}");
}
