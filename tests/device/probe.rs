//! Every other function of shaders/lib against its f64 twin: elementary functions, mappings, frames, harmonics, cameras, lights.

use crate::compare::{Tolerance, Worst, absolute, relative};
use crate::harness::{Probe, incident, rounded, rounded3, vec4, with_gpu, xyz};
use glam::{DVec2, DVec3};
use splitsum::brdf::{alpha_from_perceptual_roughness, perceptual_roughness_from_alpha};
use splitsum::environment::layout::lod_from_solid_angles;
use splitsum::glsl::constants::{ALPHA_MIN, COSINE_MIN};
use splitsum::gpu::Bind;
use splitsum::math::equirect::{direction_from_uv, texel_solid_angle, texel_solid_angle_at, uv_from_direction};
use splitsum::math::frame::Frame;
use splitsum::math::sampling::{direction_from_polar, hammersley};
use splitsum::math::spherical_harmonics::{COUNT, basis, irradiance};
use splitsum::precompute::dfg::DfgAxes;
use splitsum::precompute::prefilter::LEVEL_MAPPINGS;
use splitsum::scene::{Camera, CameraKind, Light, LightKind, Scene};
use splitsum::shade::pass::light_data;
use splitsum::tonemap::ToneCurve;
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
fn texel_solid_angle_is_that_of_the_texels() {
    // At texel centres the shader's form differs from the exact area by a sinc: 1e-3 at 32 rows, but for the poles' rows,
    // where the mean sine is 4 / pi^2 of ... 1.6 % off. It chooses a level, so 0.02 levels are the most it can cost.
    const CENTER_RULE: Tolerance = relative(0.03);
    with_gpu(|gpu| {
        let [width, height] = [64u32, 32];
        let center = |row: u32| direction_from_uv(DVec2::new(0.3, (f64::from(row) + 0.5) / f64::from(height)));
        let size = [0.0, 0.0, width as f32, height as f32];
        let inputs: Vec<[f32; 4]> = (0..height).flat_map(|row| [vec4(center(row), 1.0), size]).collect();
        let out = Probe { shader: "probe/equirect.comp", inputs: 2, outputs: 2, ..Probe::default() }.run(gpu, &inputs);
        let mut worst = Worst::new("solid angle of texels", CENTER_RULE);
        for (row, out) in (0..height).zip(&out) {
            worst.add(out[0][3], texel_solid_angle(row, width, height), || format!("row {row}"));
        }
        worst.check();
        let sphere: f64 = out.iter().map(|out| out[0][3] * f64::from(width)).sum();
        assert!((sphere / (4.0 * PI) - 1.0).abs() < 1e-3, "{sphere}");
    });
}

#[test]
fn frames() {
    with_gpu(|gpu| {
        let normals = directions();
        let inputs: Vec<[f32; 4]> = normals.iter().map(|&n| vec4(n, 0.0)).collect();
        let out = Probe { shader: "probe/frame.comp", outputs: 3, ..Probe::default() }.run(gpu, &inputs);
        let mut twin = Worst::new("frame", absolute(1e-6));
        let mut orthonormal = Worst::new("frame is orthonormal", absolute(1e-6));
        for (n, out) in normals.iter().zip(out) {
            let frame = Frame::from_normal(*n);
            let [tangent, bitangent, normal] = [out[0], out[1], out[2]].map(xyz);
            twin.add((tangent - frame.tangent).length(), 0.0, || format!("tangent of {n}"));
            twin.add((bitangent - frame.bitangent).length(), 0.0, || format!("bitangent of {n}"));
            assert_eq!(normal, *n);
            orthonormal.add((tangent.cross(bitangent) - *n).length(), 0.0, || format!("{n}"));
            orthonormal.add(tangent.dot(bitangent), 0.0, || format!("{n}"));
        }
        [twin, orthonormal].into_iter().for_each(Worst::check);
    });
}

#[test]
fn spherical_harmonics() {
    with_gpu(|gpu| {
        let directions = directions();
        let coefficients: [DVec3; COUNT] =
            std::array::from_fn(|k| rounded3(DVec3::new(1.0 + k as f64, 0.3 - 0.1 * k as f64, (k as f64).sin())));
        let texels: Vec<[f32; 4]> = coefficients.iter().map(|&c| vec4(c, 0.0)).collect();
        let buffer = gpu.buffer_from("coefficients", &texels).unwrap();
        let inputs: Vec<[f32; 4]> = directions.iter().map(|&d| vec4(d, 0.0)).collect();
        let rest = [Bind::Read(&buffer)];
        let probe = Probe { shader: "probe/sh.comp", outputs: 3, rest: &rest, ..Probe::default() };
        let mut worst_basis = Worst::new("sh9_basis", absolute(3e-7));
        let mut worst_e = Worst::new("sh9_irradiance_over_pi", absolute(5e-6));
        for (d, out) in directions.iter().zip(probe.run(gpu, &inputs)) {
            let y: Vec<f64> = out.iter().flatten().copied().collect();
            for (k, expected) in basis(*d).into_iter().enumerate() {
                worst_basis.add(y[k], expected, || format!("function {k} at {d}"));
            }
            let expected = irradiance(&coefficients, *d) / PI;
            worst_e.add_rgb(DVec3::new(y[9], y[10], y[11]), expected, || format!("{d}"));
        }
        [worst_basis, worst_e].into_iter().for_each(Worst::check);
    });
}

#[test]
fn camera_rays() {
    with_gpu(|gpu| {
        let scene = Scene::load("plane", std::path::Path::new(".")).unwrap();
        let mut worst = Worst::new("ray_direction", absolute(3e-7));
        for kind in [CameraKind::Perspective, CameraKind::Ortho] {
            let size = [80, 50];
            let camera = Camera::for_scene(kind, &scene, size);
            let [x, y] = match kind {
                CameraKind::Perspective => camera.extent(1.6),
                CameraKind::Ortho => [0.0; 2],
            };
            let pixels = [[0, 0], [79, 0], [0, 49], [79, 49], [40, 25], [13, 31]];
            let inputs: Vec<[f32; 4]> = pixels
                .iter()
                .flat_map(|&[column, row]| {
                    [
                        [column, row, size[0], size[1]].map(|x| x as f32),
                        vec4(camera.right * x, 0.0),
                        vec4(camera.up * y, 0.0),
                        vec4(camera.forward, 0.0),
                    ]
                })
                .collect();
            let out = Probe { shader: "probe/camera.comp", inputs: 4, ..Probe::default() }.run(gpu, &inputs);
            for ([column, row], out) in pixels.into_iter().zip(out) {
                let (_, direction) = camera.ray(column, row, size);
                worst.add((xyz(out[0]) - direction).length(), 0.0, || format!("{kind:?} {column} {row}"));
            }
        }
        worst.check();
    });
}

#[test]
fn lights_at_a_point() {
    with_gpu(|gpu| {
        let light = |kind, position_or_direction, color| Light { kind, position_or_direction, color };
        let lights = [
            light(LightKind::Directional, DVec3::new(0.6, 0.0, 0.8), [1.0, 2.0, 3.0]),
            light(LightKind::Point, DVec3::new(3.0, -1.0, 2.0), [10.0, 0.0, 1e4]),
        ];
        let position = DVec3::new(-0.5, 0.25, 1.0);
        let data = light_data(&lights);
        let vectors: &[[f32; 4]] = bytemuck::cast_slice(&data);
        let inputs: Vec<[f32; 4]> =
            vectors.chunks_exact(2).flat_map(|light| [light[0], light[1], vec4(position, 0.0)]).collect();
        let out = Probe { shader: "probe/light.comp", inputs: 3, outputs: 2, ..Probe::default() }.run(gpu, &inputs);
        let mut worst = Worst::new("light_at", F32);
        for (light, out) in lights.iter().zip(out) {
            let (l, irradiance) = incident(light, position);
            worst.add_vector(xyz(out[0]), l, || format!("{light:?}"));
            worst.add_rgb(xyz(out[1]), irradiance, || format!("{light:?}"));
        }
        worst.check();
    });
}

#[test]
fn tone_curve_and_its_bytes() {
    // `pow` of a base near 0 multiplies the error of its logarithm; display values are 0 to 1.
    const F32_POWER: Tolerance = Tolerance { relative: 4e-6, floor: 1e-7 };
    with_gpu(|gpu| {
        let curves: Vec<ToneCurve> = [0.1, 1.0, 5.0, 50.0, 500.0, 1e4]
            .into_iter()
            .flat_map(|exposure| [0.1, 1.0, 5.0].map(|contrast| ToneCurve { exposure, contrast }))
            .collect();
        let radiance: Vec<[f32; 3]> =
            (0..20).map(|i| 10f32.powf(0.5 * i as f32 - 5.0)).map(|l| [l, 0.5 * l, 0.0]).chain([[0.0; 3]]).collect();
        let cases: Vec<_> = curves.iter().flat_map(|&curve| radiance.iter().map(move |&l| (curve, l))).collect();
        let inputs: Vec<[f32; 4]> = cases
            .iter()
            .flat_map(|(curve, [r, g, b])| [[*r, *g, *b, 0.0], [curve.exposure, curve.contrast, 0.0, 0.0]])
            .collect();
        let out = Probe { shader: "probe/tone_curve.comp", inputs: 2, ..Probe::default() }.run(gpu, &inputs);
        let mut worst = Worst::new("tone_curve", F32_POWER);
        for ((curve, l), out) in cases.iter().zip(out) {
            let expected = curve.apply(l.map(f64::from));
            worst.add_rgb(xyz(out[0]), expected.into(), || format!("{l:?} {curve:?}"));
            let bytes = (out[0][3] as u32).to_le_bytes();
            for c in 0..3 {
                let code = 255.0 * expected[c];
                // A value half way between two codes may round either way.
                let near_half = ((code - code.floor()) - 0.5).abs() < 1e-3;
                let off = (f64::from(bytes[c]) - code).abs();
                assert!(off <= if near_half { 0.501 } else { 0.5 }, "{l:?} {curve:?}: {bytes:?} for {code}");
            }
        }
        worst.check();
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
