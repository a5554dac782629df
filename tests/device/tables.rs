//! Precomputed tables against their f64 twins and against published numbers; prefilter.rs has the
//! prefiltered map.

use crate::compare::{Tolerance, Worst, absolute, relative};
use crate::harness::{
    golden_environment, poison_image, poisoned_buffer, read_level, with_gpu, xyz,
};
use crate::layouts::{check_texels, read_map};
use crate::mips_twin::chain;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use splitsum::base::glsl::constants::FRESNEL_SCHLICK;
use splitsum::base::math::quadrature;
use splitsum::base::math::spherical_harmonics::{COUNT, irradiance};
use splitsum::base::names::Listed;
use splitsum::base::pixels::{Pixels, RgbImage};
use splitsum::instrument::brdf::{self, Brdf, MODELS, MaskingShadowing};
use splitsum::instrument::environment::layout::MapLayout;
use splitsum::instrument::gpu::{Buffer, Format, Gpu, Image};
use splitsum::instrument::precompute::dfg::{self, DfgAxes, reference::dfg_within};
use splitsum::instrument::precompute::irradiance::{
    self, reference::irradiance as exact_irradiance,
};
use splitsum::instrument::precompute::mips::{self, level_count};
use splitsum::instrument::precompute::sh9::{self, Projection};
use splitsum::instrument::precompute::{PrecomputeSettings, exact_quadrature};
use std::f64::consts::PI;

/// The exact integrals need no more digits than the tables.
pub const EXACT: quadrature::Tolerance = quadrature::Tolerance {
    relative: 1e-5,
    max_part_count: 100_000,
};

/// The environment with its mip chain on the device; every level starts as NaN.
pub fn environment_image(gpu: &Gpu, environment: &RgbImage) -> Image {
    let size = [environment.width, environment.height];
    let image = gpu
        .image("environment", size, level_count(size), Format::Rgba32Float)
        .unwrap();
    poison_image(gpu, &image);
    let texels: Vec<[f32; 4]> = environment
        .data
        .iter()
        .map(|&[r, g, b]| [r, g, b, 1.0])
        .collect();
    gpu.write_image(&image, 0, &texels).unwrap();
    mips::pass::run(gpu, &image).unwrap();
    image
}

pub fn equirect() -> &'static MapLayout {
    MapLayout::listed("equirect")
}

pub fn sunny(size: [u32; 2], sun: [u32; 2], peak: f32) -> RgbImage {
    RgbImage::from_fn(size[0], size[1], |x, y| {
        if [x, y] == sun {
            [peak, 0.9 * peak, 0.8 * peak]
        } else {
            [
                0.1 + 0.01 * (x % 7) as f32,
                0.2,
                0.3 + 0.02 * (y % 5) as f32,
            ]
        }
    })
}

#[test]
fn mips_equal_their_twin() {
    // A mean of a few texels in f32, carried down 8 levels; radiance is positive, so nothing
    // cancels.
    const F32_CHAIN: Tolerance = relative(3e-6);
    with_gpu(|gpu| {
        let mut worst = Worst::new("mips", F32_CHAIN);
        for size in [
            [64, 32],
            [33, 17],
            [15, 7],
            [5, 9],
            [100, 31],
            [2, 1],
            [1, 1],
        ] {
            let environment = sunny(size, [size[0] / 3, size[1] / 2], 72_704.0);
            let image = environment_image(gpu, &environment);
            let levels = chain(&environment);
            assert_eq!(image.mip_count() as usize, levels.len());
            for (mip, expected) in (0..).zip(&levels) {
                let level = read_level(gpu, &image, mip);
                assert_eq!(
                    [level.width, level.height],
                    [expected.width, expected.height]
                );
                for (i, (actual, expected)) in level.data.iter().zip(&expected.data).enumerate() {
                    worst.add_rgb(*actual, *expected, || {
                        format!("{size:?} level {mip} texel {i}")
                    });
                }
            }
        }
        worst.check();
    });
}

/// SH9 coefficients on the device and read back.
pub fn coefficients(gpu: &Gpu, image: &Image, projection: Projection) -> (Buffer, [DVec3; COUNT]) {
    let buffer = poisoned_buffer(
        gpu,
        "coefficients",
        sh9::pass::coefficients(gpu).unwrap().size(),
    );
    sh9::pass::run(gpu, image, projection, &buffer).unwrap();
    let read: Vec<[f32; 4]> = gpu.read_buffer(&buffer).unwrap();
    let values = std::array::from_fn(|k| xyz(read[k].map(f64::from)));
    (buffer, values)
}

#[test]
fn sh9_adds_suns_and_skies_without_loss() {
    with_gpu(|gpu| {
        let mut worst = Worst::new("SH9 with a sun, of L00", absolute(1e-6));
        for (size, sun) in [
            ([512, 256], [300, 70]),
            ([77, 31], [76, 0]),
            ([3, 2], [1, 1]),
        ] {
            let environment = sunny(size, sun, 72_704.0);
            let image = environment_image(gpu, &environment);
            for (projection, twin) in PROJECTIONS {
                let (_, values) = coefficients(gpu, &image, projection);
                let expected = twin(&environment);
                for k in 0..COUNT {
                    worst.add_rgb(values[k] / expected[0], expected[k] / expected[0], || {
                        format!("{size:?} {projection:?} coefficient {k}")
                    });
                }
            }
        }
        worst.check();
    });
}

/// Projects a map in f64.
type Twin = fn(&RgbImage) -> [DVec3; COUNT];

/// How the device projects, and the twin.
const PROJECTIONS: [(Projection, Twin); 2] = [
    (Projection::OverTexels, crate::sh9::project_texels),
    (Projection::AtCentres, crate::sh9::project_texel_centers),
];

/// A map of radiance 1 has irradiance π in every direction, at every size; the sum at texel centres
/// misses it by 6 % at 8 x 4 texels.
#[test]
fn constant_maps_of_every_size_have_constant_irradiance() {
    const SIZES: [[u32; 2]; 9] = [
        [1, 1],
        [2, 1],
        [1, 2],
        [4, 2],
        [8, 4],
        [7, 5],
        [16, 8],
        [64, 32],
        [512, 256],
    ];
    let normals = [
        DVec3::X,
        DVec3::Y,
        -DVec3::Z,
        DVec3::new(1.0, 2.0, -3.0).normalize(),
        DVec3::new(-2.0, -1.0, 1.0).normalize(),
    ];
    with_gpu(|gpu| {
        for size in SIZES {
            let map = RgbImage::filled(size[0], size[1], [1.0, 0.5, 2.0]);
            let image = environment_image(gpu, &map);
            let off = |projection: Projection| {
                let (_, values) = coefficients(gpu, &image, projection);
                let error = |n: &DVec3| {
                    let ratio = irradiance(&values, *n) / (PI * DVec3::new(1.0, 0.5, 2.0));
                    (ratio - 1.0).abs().max_element()
                };
                normals.iter().map(error).fold(0.0, f64::max)
            };
            let error = off(Projection::OverTexels);
            assert!(error < 1e-6, "{size:?}: {error}");
            if size == [8, 4] {
                let centres = off(Projection::AtCentres);
                assert!((0.05..0.08).contains(&centres), "at centres: {centres}");
            }
        }
    });
}

#[test]
fn irradiance_map_by_integration() {
    // A lookup spreads light over the trilinear footprint of its level, about two cells of the grid
    // and longer in theta near the poles. A sun of 100 times the sky then makes 1.2 % at 128 x 32
    // points, and 16 times less with a quarter of the cell.
    const POINTS: [([u32; 2], Tolerance); 2] =
        [([128, 32], relative(1.5e-2)), ([512, 128], relative(1e-3))];
    with_gpu(|gpu| {
        let environment = golden_environment();
        let image = environment_image(gpu, &environment.image);
        let exact = exact_quadrature(&environment.image);
        for (sample_count, tolerance) in POINTS {
            let map = irradiance::pass::map(gpu, equirect(), [16, 8]).unwrap();
            poison_image(gpu, &map);
            irradiance::pass::run(gpu, equirect(), &image, sample_count, &map).unwrap();
            let (name, map) = (
                format!("irradiance from {sample_count:?} points"),
                read_map(gpu, equirect(), &map),
            );
            check_texels(&name, &map, 0, 1, tolerance, |n| {
                exact_irradiance(&exact, n, EXACT).value / PI
            });
        }
    });
}

/// A DFG table of these settings read back: x is the scale of f0, y the scale of f90.
pub fn dfg_table(
    gpu: &Gpu,
    model: &dyn brdf::Brdf,
    masking: MaskingShadowing,
    settings: &PrecomputeSettings,
) -> Pixels<DVec2> {
    let table = dfg::pass::table(gpu, settings.dfg_size).unwrap();
    poison_image(gpu, &table);
    dfg::pass::run(
        gpu,
        model,
        masking,
        settings.dfg_axes,
        FRESNEL_SCHLICK,
        settings.dfg_sample_count,
        &table,
    )
    .unwrap();
    read_level(gpu, &table, 0).map(DVec3::truncate)
}

/// Largest error of A or B of a table, as looked up at these n·v and alpha, against the integrals
/// in f64.
fn lookup_error(
    table: &Pixels<DVec2>,
    model: &'static dyn Brdf,
    masking: MaskingShadowing,
    at: &[DVec2],
) -> (f64, DVec2) {
    const AXES: DfgAxes = DfgAxes::FourthRoots;
    let error = |at: &DVec2| {
        let exact = dfg_within(model, masking, at.x, at.y, 1e-5);
        let d = AXES.lookup(table, at.x, at.y) - DVec2::new(exact.f0_scale, exact.f90_scale);
        (d.abs().max_element(), *at)
    };
    at.par_iter()
        .map(error)
        .reduce(|| (0.0, DVec2::ZERO), |a, b| if a.0 > b.0 { a } else { b })
}

#[test]
fn dfg_tables_as_looked_up_match_their_integral() {
    // At texels 768 nodes leave 4e-5, correlated masking 1e-4 below n·v 0.001; bilinear lookups
    // between 256 x 256 texels add the rest.
    const ANYWHERE: f64 = 2e-4;
    // Phong above alpha 0.9 has D = cos^e with e near 0: seen at n·v below 0.001 it bends by e
    // ln(n·v) from row to row.
    const NEAR_UNIFORM_PHONG: f64 = 4e-4;
    const SIDE: u32 = 256;
    let texel = |x: f64, y: f64| DfgAxes::FourthRoots.parameters(DVec2::new(x, y), SIDE);
    let corners = [(0.5, 0.5), (255.5, 0.5), (0.5, 255.5), (255.5, 255.5)];
    // Middles of cells, where bilinear lookups err most, including the first and last cells of both
    // axes.
    let middles = (0..30).map(|i| {
        let place = |k: f64| (f64::from(i) * k).fract() * 255.0;
        (
            1.0 + place(0.754877666).floor(),
            1.0 + place(0.569840291).floor(),
        )
    });
    let between = [
        (1.0, 1.0),
        (255.0, 1.0),
        (1.0, 255.0),
        (255.0, 255.0),
        (255.0, 128.0),
        (20.0, 255.0),
    ];
    let at: Vec<DVec2> = corners
        .into_iter()
        .chain(between)
        .chain(middles)
        .map(|(x, y)| texel(x, y))
        .collect();
    let settings = PrecomputeSettings {
        dfg_size: SIDE,
        ..PrecomputeSettings::default()
    };
    with_gpu(|gpu| {
        for model in MODELS {
            for &masking in MaskingShadowing::all() {
                let table = dfg_table(gpu, *model, masking, &settings);
                let is_hard = |at: &DVec2| {
                    model.name() == "phong"
                        && masking == MaskingShadowing::Correlated
                        && at.x < 1e-3
                        && at.y > 0.9
                };
                let (hard, other): (Vec<DVec2>, Vec<DVec2>) = at.iter().partition(|at| is_hard(at));
                for (at, within) in [(other, ANYWHERE), (hard, NEAR_UNIFORM_PHONG)] {
                    let (error, worst) = lookup_error(&table, *model, masking, &at);
                    println!("{} {masking:?}: {error:.2e} at {worst}", model.name());
                    assert!(
                        error < within,
                        "{} {masking:?}: {error} at n·v and alpha {worst}",
                        model.name()
                    );
                }
            }
        }
    });
}
