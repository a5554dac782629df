//! Elementary functions and sums of shaders/lib against f64.

use crate::compare::{Tolerance, Worst, absolute, relative};
use crate::harness::{Probe, rounded, rounded3, vec4, with_gpu, xyz};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

#[test]
fn elementary_functions_keep_their_stated_error() {
    with_gpu(|gpu| {
        let count = 4001;
        let at = |i: i32, low: f64, high: f64| {
            rounded(low + (high - low) * f64::from(i) / f64::from(count - 1))
        };
        // Includes small arguments down to 1e-8, for log and exp.
        let small = |i: i32, x: f64| {
            if i % 4 == 0 {
                rounded(x * 10f64.powi(-(i / 4) % 9))
            } else {
                x
            }
        };
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
            .flat_map(|&[turns, log, exp, asin, y, x, atan]| {
                [[turns, log, exp, asin], [y, x, atan, 0.0]]
            })
            .map(|v| v.map(|x| x as f32))
            .collect();
        let out = Probe {
            shader: "probe/elementary.comp",
            inputs: 2,
            outputs: 2,
            ..Probe::default()
        }
        .run(gpu, &inputs);
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
            let expected = [
                sin,
                cos,
                (-log).ln_1p(),
                -(-exp).exp_m1(),
                asin.asin(),
                y.atan2(x),
                atan.atan(),
            ];
            let actual = [&out[0][..], &out[1][..3]].concat();
            let argument = [turns, turns, log, exp, asin, y, atan];
            for k in 0..worst.len() {
                worst[k].add(actual[k], expected[k], || format!("{}", argument[k]));
            }
        }
        worst.into_iter().for_each(Worst::check);
        // Quarter turns are exact.
        let quarters: Vec<[f32; 4]> = (-8..=8)
            .flat_map(|q| [[q as f32 * 0.25, 0.0, 0.0, 0.0], [0.0; 4]])
            .collect();
        let out = Probe {
            shader: "probe/elementary.comp",
            inputs: 2,
            outputs: 2,
            ..Probe::default()
        }
        .run(gpu, &quarters);
        for (q, item) in (-8i32..).zip(out) {
            let sin = [0.0, 1.0, 0.0, -1.0];
            assert_eq!(
                item[0][..2],
                [
                    sin[q.rem_euclid(4) as usize],
                    sin[(q + 1).rem_euclid(4) as usize]
                ],
                "{q} / 4"
            );
            assert_eq!(item[1][1], 0.0, "atan2 at the origin");
        }
    });
}

#[test]
fn sums_keep_the_rounding_errors_of_f32() {
    // Both parts together are as good as the exact sum rounded once to f32: half a unit in the last
    // place. A plain sum is off by 1e-4 where each term is below that unit.
    const HALF_UNIT: Tolerance = absolute(6e-8);
    with_gpu(|gpu| {
        let cases = [
            (
                DVec3::new(1e6, 1.0, -3e4),
                DVec3::new(0.01, 1e-8, 0.3),
                4000,
            ),
            (
                DVec3::new(0.0, 72_704.0, 1.0),
                DVec3::new(0.1, 1e-3, -1e-5),
                10_000,
            ),
        ];
        let inputs: Vec<[f32; 4]> = cases
            .iter()
            .flat_map(|(start, term, count)| [vec4(*start, 0.0), vec4(*term, f64::from(*count))])
            .collect();
        let probe = Probe {
            shader: "probe/compensated_sum.comp",
            inputs: 2,
            outputs: 2,
            ..Probe::default()
        };
        let mut worst = Worst::new("compensated sum, relative", HALF_UNIT);
        for ((start, term, count), out) in cases.iter().zip(probe.run(gpu, &inputs)) {
            let exact = rounded3(*start) + f64::from(*count) * rounded3(*term);
            worst.add_rgb(
                (xyz(out[0]) + xyz(out[1]) - exact) / exact,
                DVec3::ZERO,
                || format!("{start} + {count} {term}"),
            );
        }
        worst.check();
    });
}
