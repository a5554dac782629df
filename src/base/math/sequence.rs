//! Sequences of points in the unit square, and independent sets of each.
//!
//! Set 0 is the plain sequence if there is one; set k > 0 is a randomised copy. Sets of one
//! sequence are repetitions that separate bias from variance. No coordinate is 0 or 1, where lobes
//! and level formulas are singular.

use super::blue_noise;
use super::sampling::hammersley;
use crate::base::names::listed;
use glam::{DVec2, DVec3};

/// A sequence of points. To add one: an entry of [`SEQUENCES`].
#[derive(Clone, Copy, Debug)]
pub struct Sequence {
    pub name: &'static str,
    pub about: &'static str,
    /// Returns point `i` of `count` of a set.
    pub point: fn(i: u32, count: u32, set: u32) -> DVec2,
}

/// Every sequence, the default first.
pub static SEQUENCES: &[Sequence] = &[
    Sequence {
        name: "hammersley",
        about: "((i + 1/2) / n, radical inverse); set k is shifted on the torus by the k-th point \
                of R2 [CranleyPatterson76]",
        point: |i, count, set| (hammersley(i, count) + (f64::from(set) * R2).fract()).fract(),
    },
    Sequence {
        name: "sobol-owen",
        about: "the first two Sobol dimensions with a nested uniform scramble by hash; each set \
                has its own [Burley20]",
        point: |i, _, set| {
            let key = hash(set);
            let first = scramble_reversed(i, hash(key ^ 1));
            let second = scramble_reversed(sobol_second_reversed(i), hash(key ^ 2));
            centre([first.reverse_bits(), second.reverse_bits()])
        },
    },
    Sequence {
        name: "r2",
        about: "the additive recurrence of the plastic number [Roberts18] from (1/2, 1/2); further \
                sets start at a random point",
        point: |i, _, set| {
            let start = if set == 0 {
                DVec2::splat(0.5)
            } else {
                random(set, 0)
            };
            let point = (start + f64::from(i) * R2).fract() * CELLS;
            (point.floor() + 0.5) / CELLS
        },
    },
    Sequence {
        name: "random",
        about: "independent uniform points by hash, the baseline of the other sequences",
        point: |i, _, set| random(set, i),
    },
];

listed!(Sequence, "sequence", SEQUENCES);

/// How a pixel gets the points of a set. The discriminants are `glsl::constants::PIXEL_POINTS_*`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum PixelPoints {
    /// All pixels use the set: errors of neighbours are similar and show as ghosts and bands.
    #[default]
    Shared = 0,
    /// Each pixel scrambles both coordinates of the set: errors of neighbours are independent and
    /// show as noise.
    Owen = 1,
}

listed!(PixelPoints, "kind of pixel points", { "shared": Shared, "owen": Owen });

/// Returns the point of a set as the pixel at column x and row y scrambles it: nested uniform
/// scrambles of both coordinates \[Owen97\] by hash \[Burley20\], each with its own key. The mean
/// over pixels or sets is uniform for any point.
pub fn scrambled(point: DVec2, [x, y]: [u32; 2], set: u32) -> DVec2 {
    /// The reference uses streams 0 and 1.
    const STREAM: u32 = 2;
    let seed = 0;
    let parts = [STREAM + 1, seed, set, y, x];
    let mut key = parts
        .iter()
        .fold(0, |key: u32, part: &u32| hash(part.wrapping_add(key)));
    centre(point.as_vec2().to_array().map(|coordinate| {
        key = hash(key.wrapping_add(1));
        // f32, as in the table on the device.
        let fixed = (f64::from(coordinate) * 2f64.powi(32)) as u32;
        scramble_reversed(fixed.reverse_bits(), key).reverse_bits()
    }))
}

/// How the points of a pixel change from frame to frame of a sequence.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FramePoints {
    /// Each pixel and frame scrambles the set by its own keys: white noise in space and time.
    #[default]
    Owen,
    /// Each pixel continues R2 from frame to frame, from its own random point.
    R2,
    /// Each pixel and frame shifts the set on the torus by a mask of blue noise.
    Blue,
}

listed!(FramePoints, "kind of frame points", { "owen": Owen, "r2": R2, "blue": Blue });

/// Steps of R2 in fixed point, in whole cells: then the points of successive frames are bit by bit
/// the points of one set.
const R2_CELLS: [u32; 2] = [((R2.x * CELLS) as u32) << 9, ((R2.y * CELLS) as u32) << 9];

/// The points of a frame that continues R2, before their shift.
pub static R2_OF_FRAMES: Sequence = Sequence {
    name: "r2-of-frames",
    about: "R2 from 0 in steps of whole cells",
    point: |i, _, _| centre(R2_CELLS.map(|step| step.wrapping_mul(i))),
};

/// Returns the shift of the points of the pixel at column x and row y in a frame of `samples`
/// points, as fixed point; 0 for scrambled points.
pub fn frame_shift(
    points: FramePoints,
    [x, y]: [u32; 2],
    frame: u32,
    samples: u32,
    set: u32,
) -> [u32; 2] {
    match points {
        FramePoints::Owen => [0; 2],
        FramePoints::R2 => {
            let first = hash(x.wrapping_add(hash(y.wrapping_add(hash(set.wrapping_add(1))))));
            let steps = R2_CELLS.map(|step| step.wrapping_mul(frame.wrapping_mul(samples)));
            [
                first.wrapping_add(steps[0]),
                hash(first.wrapping_add(1)).wrapping_add(steps[1]),
            ]
        }
        FramePoints::Blue => {
            blue_pair([x, y], frame, set).map(|value| (value * 2f64.powi(32)) as u32)
        }
    }
}

/// Returns two values of a pixel in a frame: the second from another place of the mask. Every 32
/// frames both move to other places, by R2; so does each set.
fn blue_pair([x, y]: [u32; 2], frame: u32, set: u32) -> [f64; 2] {
    let cycle = frame / blue_noise::DEPTH as u32 + set.wrapping_mul(1 << 12);
    [0.0, 0.5].map(|half| {
        let [right, down] = ((f64::from(cycle) + half) * R2)
            .fract()
            .to_array()
            .map(|part| (part * blue_noise::SIDE as f64) as u32);
        blue_noise::value([x.wrapping_add(right), y.wrapping_add(down)], frame)
    })
}

/// Returns a point that is shifted on the torus.
pub fn shifted(point: DVec2, shift: [u32; 2]) -> DVec2 {
    // f32, as in the table on the device.
    let [x, y] = point
        .as_vec2()
        .to_array()
        .map(|coordinate| (f64::from(coordinate) * 2f64.powi(32)) as u32);
    centre([x.wrapping_add(shift[0]), y.wrapping_add(shift[1])])
}

/// Steps of the R2 sequence: 1/g and 1/g² for the root g of g³ = g + 1.
const R2: DVec2 = DVec2::new(0.754_877_666_246_692_8, 0.569_840_290_998_053_3);

/// Steps of the R3 sequence: 1/g, 1/g² and 1/g³ for the root g of g⁴ = g + 1.
pub const R3: DVec3 = DVec3::new(
    0.819_172_513_396_164_5,
    0.671_043_606_703_789_3,
    0.549_700_477_901_970_1,
);

/// Cells per side: the most for which f32 holds every centre.
const CELLS: f64 = (1u32 << 23) as f64;

/// Maps fixed point to the open unit square: the centre of a cell.
fn centre(fixed_point: [u32; 2]) -> DVec2 {
    let [x, y] = fixed_point.map(|bits| (f64::from(bits >> 9) + 0.5) / CELLS);
    DVec2::new(x, y)
}

/// Returns point `i` of a stream of independent uniform points.
fn random(stream: u32, i: u32) -> DVec2 {
    let key = hash(i.wrapping_add(hash(stream.wrapping_add(1))));
    let second = hash(key.wrapping_add(1));
    centre([key, second])
}

/// Hashes as `sobol_hash` of `shaders/lib/sobol.glsl` \[Wellons18\].
pub fn hash(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// As in `shaders/lib/sobol.glsl`: the second Sobol dimension with its bits reversed. The first is
/// the index itself.
pub fn sobol_second_reversed(mut index: u32) -> u32 {
    index ^= index >> 16;
    index ^= (index & 0xff00_ff00) >> 8;
    index ^= (index & 0xf0f0_f0f0) >> 4;
    index ^= (index & 0xcccc_cccc) >> 2;
    index ^ ((index & 0xaaaa_aaaa) >> 1)
}

/// As `sobol_scramble_reversed` of `shaders/lib/sobol.glsl` [Burley20, Vegdahl21]: lower bits flip
/// bit k.
pub fn scramble_reversed(mut x: u32, key: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(key);
    x = x.wrapping_mul((key >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}
