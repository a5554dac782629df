//! What the reference draws: points, directions of the environment with their density, and the sum over them.

use crate::compare::{Tolerance, Worst, absolute};
use crate::harness::{Probe, golden_environment, rounded3, vec4, with_gpu, xyz};
use glam::{DVec2, DVec3};
use splitsum::environment::Environment;
use splitsum::environment::distribution::EnvironmentDistribution;
use splitsum::gpu::{Bind, Filter, Format, Gpu, Slot, Wrap};
use splitsum::math::sampling::{direction_from_polar, hammersley};
use splitsum::pixels::RgbImage;
use std::f64::consts::TAU;

/// Column, row, scramble, seed, stream, pair.
type Key = [u32; 6];

/// The first `count` points of each key.
fn points(gpu: &Gpu, count: u32, keys: &[Key]) -> Vec<Vec<DVec2>> {
    let inputs: Vec<[f32; 4]> = keys
        .iter()
        .flat_map(|&[column, row, scramble, seed, stream, pair]| {
            (0..count).flat_map(move |index| [[index, column, row, scramble], [seed, stream, pair, 0]])
        })
        .map(|v| v.map(|x| x as f32))
        .collect();
    let out = Probe { shader: "probe/sobol.comp", inputs: 2, ..Probe::default() }.run(gpu, &inputs);
    let points: Vec<DVec2> = out.iter().map(|item| DVec2::new(item[0][0], item[0][1])).collect();
    points.chunks_exact(count as usize).map(<[DVec2]>::to_vec).collect()
}

#[test]
fn points_are_nets_under_every_scramble() {
    // One point in each elementary interval of the (0, m, 2)-net, of every shape, for any key: the property that Owen scrambling keeps.
    with_gpu(|gpu| {
        let m = 8;
        let keys = [[0; 6], [5, 9, 0, 1, 0, 0], [5, 9, 15, 1, 1, 1], [127, 3, 7, 99, 0, 1]];
        for (key, points) in keys.iter().zip(points(gpu, 1 << m, &keys)) {
            for columns_log2 in 0..=m {
                let columns = f64::from(1 << columns_log2);
                let rows = f64::from(1 << (m - columns_log2));
                let mut hits = vec![0; 1 << m];
                for xi in &points {
                    hits[((xi.x * columns).floor() * rows + (xi.y * rows).floor()) as usize] += 1;
                }
                assert!(hits.iter().all(|&n| n == 1), "{key:?}: {columns} columns");
            }
        }
    });
}

#[test]
fn every_part_of_the_key_changes_the_points() {
    with_gpu(|gpu| {
        let keys: Vec<Key> = (0..64).map(|k| [5, 9 + 2 * k, 3, 1, 0, 0]).collect();
        let first = points(gpu, 64, &keys);
        for part in 0..keys[0].len() {
            let mut others = keys.clone();
            others.iter_mut().for_each(|key| key[part] += 1);
            let pairs = first.iter().zip(points(gpu, 64, &others)).map(|(a, b)| (a.clone(), b));
            let mean = |(a, b): (Vec<DVec2>, Vec<DVec2>)| {
                a.iter().zip(&b).map(|(a, b)| (*a - *b).length()).sum::<f64>() / 64.0
            };
            let mean_distance = pairs.map(mean).sum::<f64>() / 64.0;
            // Two independent points of the unit square are 0.521 apart on average. The points of one key move together (their first bits
            // flip all at once), so that only the 64 keys count: their means spread by 0.15, the mean of those by 0.02.
            assert!((mean_distance - 0.521).abs() < 0.08, "part {part}: {mean_distance}");
        }
        // No point under test is a point of the reference.
        let hammersley: Vec<DVec2> = (0..64).map(|i| hammersley(i, 64)).collect();
        assert!(first[0].iter().all(|xi| hammersley.iter().all(|other| (*xi - *other).length() > 1e-6)));
    });
}

#[test]
fn means_over_scrambles_are_unbiased() {
    // The mean of a point over scrambles is the middle of the square; 256 scrambles of one point: 1/sqrt(12 256) = 0.018.
    with_gpu(|gpu| {
        let keys: Vec<Key> = (0..256).map(|scramble| [3, 4, scramble, 1, 0, 0]).collect();
        let points = points(gpu, 8, &keys);
        for index in [0, 1, 6] {
            let mean = points.iter().map(|points| points[index]).sum::<DVec2>() / 256.0;
            assert!((mean - 0.5).abs().max_element() < 5.0 * 0.018, "point {index}: {mean}");
        }
    });
}

#[test]
fn sums_carry_what_f32_drops() {
    with_gpu(|gpu| {
        let cases = [
            (DVec3::new(1e6, 1.0, -3e4), DVec3::new(0.01, 1e-8, 0.3), 4000),
            (DVec3::new(0.0, 72_704.0, 1.0), DVec3::new(0.1, 1e-3, -1e-4), 10_000),
        ];
        let inputs: Vec<[f32; 4]> =
            cases.iter().flat_map(|(start, term, count)| [vec4(*start, 0.0), vec4(*term, f64::from(*count))]).collect();
        let probe = Probe { shader: "probe/compensated_sum.comp", inputs: 2, outputs: 2, ..Probe::default() };
        // Terms below half a unit of the sum's last place all go to the low part, which rounds as a plain f32 sum of them does. A plain
        // sum would lose them: 1e-4 in the second case.
        let mut worst = Worst::new("compensated sum", absolute(2e-8));
        for ((start, term, count), out) in cases.iter().zip(probe.run(gpu, &inputs)) {
            let exact = rounded3(*start) + f64::from(*count) * rounded3(*term);
            worst.add_rgb((xyz(out[0]) + xyz(out[1]) - exact) / exact, DVec3::ZERO, || {
                format!("{start} + {count} {term}")
            });
        }
        worst.check();
    });
}

#[test]
fn directions_of_the_environment_and_their_density() {
    with_gpu(|gpu| {
        let sun = RgbImage::from_fn(40, 21, |x, y| match (x, y) {
            (11, 6) => [72_704.0, 60_000.0, 30_000.0],
            // A black corner, so that some cells have no light.
            (20..30, 14..) => [0.0; 3],
            _ => [0.1 + 0.01 * x as f32, 0.2, 0.3 + 0.01 * y as f32],
        });
        for environment in [Environment::clone(&golden_environment()), Environment::from_image("sun", sun)] {
            let size = [environment.image.width, environment.image.height];
            let image = gpu.image("environment", size, 1, Format::Rgba32Float).unwrap();
            let texels: Vec<[f32; 4]> = environment.image.data.iter().map(|&[r, g, b]| [r, g, b, 1.0]).collect();
            gpu.write_image(&image, 0, &texels).unwrap();
            let distribution = EnvironmentDistribution::new(&environment.image);
            let words = gpu.buffer_from("words", distribution.words()).unwrap();
            let sampler = gpu.sampler(Filter::Nearest, Wrap::Equirect).unwrap();
            let count = 2000;
            let items: Vec<([u32; 2], DVec3)> = (0..count)
                .map(|i| {
                    let xi = hammersley(i, count);
                    let z = 1.0 - 2.0 * xi.y;
                    let fixed = [xi.x, xi.y].map(|x| (x * 4_294_967_296.0) as u32);
                    (fixed, rounded3(direction_from_polar((1.0 - z * z).sqrt(), z, xi.x)))
                })
                .collect();
            let inputs: Vec<[f32; 4]> = items
                .iter()
                .flat_map(|([x, y], d)| {
                    let halves = [x >> 16, x & 0xffff, y >> 16, y & 0xffff].map(|half| half as f32);
                    [halves, vec4(*d, 0.0), [size[0] as f32, size[1] as f32, 0.0, 0.0]]
                })
                .collect();
            let rest = [Bind::Sample(&image, &sampler), Bind::Read(&words)];
            let probe = Probe {
                shader: "probe/environment_sampling.comp",
                inputs: 3,
                outputs: 3,
                rest: &rest,
                rest_slots: &[Slot::Sampled, Slot::Buffer],
                ..Probe::default()
            };
            let name = &environment.name;
            // A place in a cell follows from a fraction of an interval of 2^32 / W units; directions are angles of 4e-7.
            let mut direction = Worst::new(format!("{name}: direction"), absolute(3e-6));
            // A direction off by 4e-7 moves the lookup by 4e-7 W / 2 pi texels, times the step to the sun.
            let step = environment.image.data.iter().flatten().fold(0f32, |a, &b| a.max(b));
            let lookup = |of: f64| Tolerance { relative: 4e-6, floor: 4e-7 * f64::from(size[0]) / TAU * of };
            let mut li = Worst::new(format!("{name}: radiance of the sample"), lookup(f64::from(step)));
            let mut given = Worst::new(format!("{name}: radiance"), lookup(f64::from(step)));
            let mut density =
                Worst::new(format!("{name}: density over radiance"), Tolerance { relative: 1e-5, floor: 1e-12 });
            let luminance = |li: DVec3| li.dot(DVec3::new(0.2126, 0.7152, 0.0722));
            for (([x, y], d), out) in items.iter().zip(probe.run(gpu, &inputs)) {
                let xi = DVec2::new(f64::from(*x) + 0.5, f64::from(*y) + 0.5) / 4_294_967_296.0;
                let (expected, _) = distribution.sample(xi);
                let sampled = xyz(out[0]);
                direction.add((sampled - expected).length(), 0.0, || format!("{sampled} against {expected}, xi {xi}"));
                li.add_rgb(xyz(out[1]), environment.radiance(sampled), || format!("{sampled}"));
                given.add_rgb(xyz(out[2]), environment.radiance(*d), || format!("{d}"));
                // Both are proportional to the luminance that was looked up: what is compared is the row's constant over sin(theta).
                let row = |d: DVec3| {
                    let luminance = luminance(environment.radiance(d));
                    if luminance > 0.0 { distribution.pdf(d) / luminance } else { 0.0 }
                };
                for (at, li, pdf) in [(sampled, xyz(out[1]), out[0][3]), (*d, xyz(out[2]), out[2][3])] {
                    let share = if luminance(li) > 0.0 { pdf / luminance(li) } else { 0.0 };
                    density.add(share, row(at), || format!("{at}"));
                }
            }
            [direction, li, given, density].into_iter().for_each(Worst::check);
        }
    });
}
