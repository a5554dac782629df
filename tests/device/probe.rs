//! Every other function of shaders/lib against its f64 twin: elementary functions, mappings, frames, harmonics, cameras, lights.

use crate::compare::{Tolerance, Worst, absolute, relative};
use crate::harness::{Probe, rounded, rounded3, vec4, with_gpu, xyz};
use glam::{DVec2, DVec3};
use splitsum::brdf::{alpha_from_perceptual_roughness, perceptual_roughness_from_alpha};
use splitsum::environment::layout::lod_from_solid_angles;
use splitsum::glsl::constants::{ALPHA_MIN, COSINE_MIN};
use splitsum::math::equirect::{direction_from_uv, texel_solid_angle_at, uv_from_direction};
use splitsum::math::sampling::{direction_from_polar, hammersley};
use splitsum::precompute::dfg::DfgAxes;
use splitsum::precompute::prefilter::LEVEL_MAPPINGS;
use std::f64::consts::{PI, TAU};

/// Arithmetic in f32.
const F32: Tolerance = relative(1e-6);

/// Unit vectors over the sphere, with its axes and places near them, as the f32 numbers that a shader gets.
fn directions() -> Vec<DVec3> {
    let spread = (0..300).map(|i| {
        let xi = hammersley(i, 300);
        let z = 1.0 - 2.0 * xi.x;
        direction_from_polar((1.0 - z * z).sqrt(), z, xi.y + 1e-3)
    });
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let near = axes.into_iter().flat_map(|axis| {
        [1.0, -1.0].into_iter().flat_map(move |sign| {
            [0.0, 1e-6, 1e-3].map(|off| (sign * axis + off * DVec3::new(0.6, -0.8, 0.7)).normalize())
        })
    });
    spread.chain(near).map(rounded3).collect()
}

#[test]
fn elementary_functions_keep_their_stated_error() {
    with_gpu(|gpu| {
        let count = 4001;
        let at = |i: i32, low: f64, high: f64| rounded(low + (high - low) * f64::from(i) / f64::from(count - 1));
        // Small arguments too, down to 1e-8: log and exp are there for them.
        let small = |i: i32, x: f64| if i % 4 == 0 { rounded(x * 10f64.powi(-(i / 4) % 9)) } else { x };
        let items: Vec<[f64; 7]> = (0..count)
            .map(|i| {
                let angle = at(i, -PI, PI);
                [
                    at(i, -2.0, 2.0),
                    small(i, at(i, 0.0, 1.0 - 6e-8)),
                    small(i, at(i, 0.0, 30.0)),
                    at(i, 0.0, 0.5f64.sqrt()),
                    rounded(3.0 * angle.sin()),
                    rounded(3.0 * angle.cos()),
                    at(i, 0.0, 1.0),
                ]
            })
            .collect();
        let inputs: Vec<[f32; 4]> = items
            .iter()
            .flat_map(|&[turns, log, exp, asin, y, x, atan]| [[turns, log, exp, asin], [y, x, atan, 0.0]])
            .map(|v| v.map(|x| x as f32))
            .collect();
        let out =
            Probe { shader: "probe/elementary.comp", inputs: 2, outputs: 2, ..Probe::default() }.run(gpu, &inputs);
        // The errors that the functions' comments state.
        let mut worst = [
            Worst::new("sin of turns", absolute(1.5e-7)),
            Worst::new("cos of turns", absolute(1.5e-7)),
            Worst::new("log_one_minus", relative(1e-6)),
            Worst::new("one_minus_exp", relative(1e-6)),
            Worst::new("asin_half_octant", absolute(2e-7)),
            Worst::new("atan2_precise", absolute(3e-7)),
            Worst::new("atan_octant", absolute(2e-7)),
        ];
        for ([turns, log, exp, asin, y, x, atan], out) in items.into_iter().zip(out) {
            let (sin, cos) = (TAU * turns).sin_cos();
            let expected = [sin, cos, (-log).ln_1p(), -(-exp).exp_m1(), asin.asin(), y.atan2(x), atan.atan()];
            let actual = [&out[0][..], &out[1][..3]].concat();
            let argument = [turns, turns, log, exp, asin, y, atan];
            for k in 0..worst.len() {
                worst[k].add(actual[k], expected[k], || format!("{}", argument[k]));
            }
        }
        worst.into_iter().for_each(Worst::check);
        // Quarter turns are exact.
        let quarters: Vec<[f32; 4]> = (-8..=8).flat_map(|q| [[q as f32 * 0.25, 0.0, 0.0, 0.0], [0.0; 4]]).collect();
        let out =
            Probe { shader: "probe/elementary.comp", inputs: 2, outputs: 2, ..Probe::default() }.run(gpu, &quarters);
        for (q, item) in (-8i32..).zip(out) {
            let sin = [0.0, 1.0, 0.0, -1.0];
            assert_eq!(item[0][..2], [sin[q.rem_euclid(4) as usize], sin[(q + 1).rem_euclid(4) as usize]], "{q} / 4");
            assert_eq!(item[1][1], 0.0, "atan2 at the origin");
        }
    });
}

#[test]
fn equirectangular_mapping_and_its_inverse() {
    // u, v: two angles of 3e-7 over 2 pi and pi, and one rounding of each.
    const UV: Tolerance = absolute(2e-7);
    const SIZE: [u32; 2] = [512, 256];
    with_gpu(|gpu| {
        let directions = directions();
        let uvs: Vec<DVec2> = (0..directions.len() as u32)
            .map(|i| rounded3(hammersley(i, directions.len() as u32).extend(0.0)).truncate())
            .collect();
        let omega_s = rounded(3e-3);
        let [width, height] = SIZE.map(f64::from);
        let inputs: Vec<[f32; 4]> = directions
            .iter()
            .zip(&uvs)
            .flat_map(|(d, uv)| [vec4(*d, omega_s), [uv.x, uv.y, width, height].map(|x| x as f32)])
            .collect();
        let out = Probe { shader: "probe/equirect.comp", inputs: 2, outputs: 2, ..Probe::default() }.run(gpu, &inputs);
        let mut worst_uv = Worst::new("uv_from_direction", UV);
        let mut worst_sin = Worst::new("sin_theta", F32);
        let mut worst_omega = Worst::new("texel_solid_angle", F32);
        let mut worst_d = Worst::new("direction_from_uv", absolute(4e-7));
        let mut worst_lod = Worst::new("lod_from_solid_angles", absolute(2e-6));
        for ((d, uv), out) in directions.iter().zip(&uvs).zip(out) {
            let expected = uv_from_direction(*d);
            let sin_theta = d.x.hypot(d.z);
            // u is an angle: 0 and 1 are one, and it has no value at the poles.
            let wrapped = (out[0][0] - expected.x + 0.5).rem_euclid(1.0) - 0.5;
            worst_uv.add(wrapped * sin_theta, 0.0, || format!("u of {d}"));
            worst_uv.add(out[0][1], expected.y, || format!("v of {d}"));
            worst_sin.add(out[0][2], sin_theta, || format!("{d}"));
            let omega_p = texel_solid_angle_at(sin_theta, SIZE[0], SIZE[1]);
            worst_omega.add(out[0][3], omega_p, || format!("{d}"));
            worst_lod.add(out[1][3], lod_from_solid_angles(omega_s, omega_p), || format!("{d}"));
            worst_d.add_vector(xyz(out[1]), direction_from_uv(*uv), || format!("{uv}"));
        }
        [worst_uv, worst_sin, worst_omega, worst_d, worst_lod].into_iter().for_each(Worst::check);
    });
}

#[test]
fn prefilter_and_dfg_mappings() {
    with_gpu(|gpu| {
        const LEVELS: u32 = 5;
        const SIDE: u32 = 128;
        let items: Vec<[f64; 5]> = (0..=40)
            .map(|i| {
                let x = f64::from(i) / 40.0;
                // roughness, alpha, lod, texel, n_dot_v
                [rounded(x), rounded(x * x), rounded(4.0 * x), (127.0 * x).floor(), rounded(1.0 - x)]
            })
            .collect();
        let inputs: Vec<[f32; 4]> = items
            .iter()
            .flat_map(|&[roughness, alpha, lod, texel, n_dot_v]| {
                [
                    [roughness, alpha, lod, f64::from(LEVELS)],
                    [texel, 127.0 - texel, f64::from(SIDE), f64::from(SIDE)],
                    [n_dot_v, 0.0, 0.0, 0.0],
                ]
            })
            .map(|v| v.map(|x| x as f32))
            .collect();
        let mut worst = Worst::new("mappings", F32);
        let mut table = Worst::new("places in the DFG table", absolute(1e-6));
        // Near the rough end the inverse of the bent mappings is steep: it is held to what f32 makes of the level.
        let mut levels = Worst::new("levels of the roughness of a level", absolute(2e-6));
        let both = [DfgAxes::FourthRoots, DfgAxes::Centres].into_iter().cycle();
        for (mapping, axes, (&[roughness, alpha, lod, texel, n_dot_v], out)) in
            LEVEL_MAPPINGS.iter().zip(both).flat_map(|(mapping, axes)| {
                let constants = [0, 0, (mapping.bend as f32).to_bits(), 0, 0, 0, axes as u32];
                let probe = Probe {
                    shader: "probe/prefilter_mapping.comp",
                    constants: &constants,
                    inputs: 3,
                    outputs: 2,
                    ..Probe::default()
                };
                items.iter().zip(probe.run(gpu, &inputs)).map(move |item| (mapping, axes, item))
            })
        {
            let case = || format!("roughness {roughness} alpha {alpha} lod {lod} texel {texel}");
            // At and below the floor of alpha the surface is a mirror.
            let perceptual_roughness =
                if alpha <= f64::from(ALPHA_MIN) { 0.0 } else { perceptual_roughness_from_alpha(alpha) };
            worst.add(out[0][0], alpha_from_perceptual_roughness(roughness), case);
            worst.add(out[0][1], perceptual_roughness, case);
            levels.add(mapping.mip_from_alpha(out[0][2].powi(2), LEVELS), lod, case);
            worst.add(out[0][2].powi(2), mapping.alpha_from_mip(lod, LEVELS), case);
            worst.add(out[0][3], mapping.mip_from_alpha(roughness * roughness, LEVELS), case);
            let parameters = axes.parameters(DVec2::new(texel, 127.0 - texel) + 0.5, SIDE);
            table.add(out[1][0], parameters.x, case);
            table.add(out[1][1], parameters.y.max(ALPHA_MIN.into()), case);
            let uv = axes.texel(DVec2::new(n_dot_v, alpha), SIDE) / f64::from(SIDE);
            // Beyond the least cosine and width a lookup is clamped.
            if axes == DfgAxes::Centres || (alpha >= ALPHA_MIN.into() && n_dot_v >= COSINE_MIN.into()) {
                table.add(out[1][2], uv.x, case);
                table.add(out[1][3], if alpha <= ALPHA_MIN.into() { perceptual_roughness } else { uv.y }, case);
            }
        }
        [worst, table, levels].into_iter().for_each(Worst::check);
    });
}

#[test]
fn sums_carry_what_f32_drops() {
    // Both parts together are as good as the exact sum rounded once to f32: half a unit in the last place. A plain sum is off by 1e-4
    // where each term is below that unit.
    const HALF_UNIT: Tolerance = absolute(6e-8);
    with_gpu(|gpu| {
        let cases = [
            (DVec3::new(1e6, 1.0, -3e4), DVec3::new(0.01, 1e-8, 0.3), 4000),
            (DVec3::new(0.0, 72_704.0, 1.0), DVec3::new(0.1, 1e-3, -1e-5), 10_000),
        ];
        let inputs: Vec<[f32; 4]> =
            cases.iter().flat_map(|(start, term, count)| [vec4(*start, 0.0), vec4(*term, f64::from(*count))]).collect();
        let probe = Probe { shader: "probe/compensated_sum.comp", inputs: 2, outputs: 2, ..Probe::default() };
        let mut worst = Worst::new("compensated sum, relative", HALF_UNIT);
        for ((start, term, count), out) in cases.iter().zip(probe.run(gpu, &inputs)) {
            let exact = rounded3(*start) + f64::from(*count) * rounded3(*term);
            worst.add_rgb((xyz(out[0]) + xyz(out[1]) - exact) / exact, DVec3::ZERO, || {
                format!("{start} + {count} {term}")
            });
        }
        worst.check();
    });
}
