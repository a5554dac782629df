//! The clear sky of Hosek and Wilkie \[HosekWilkie12\], RGB data set, in the f32 arithmetic of its
//! authors.
//!
//! `L(θ, γ) = r (1 + A exp(B/(cos θ + 0.01))) (C + D exp(E γ) + F cos² γ + G χ(H, γ) + I √cos θ)`
//! for each channel, θ the angle to the zenith, γ to the sun, and `χ(H, γ) = (1 + cos² γ)/(1 + H² -
//! 2 H cos γ)^1.5`.

use std::f32::consts::FRAC_PI_2;

/// Little-endian f32: the nine coefficients of red, green and blue, then r of each. Each is ordered
/// by albedo (0 and 1), turbidity (1 to 10) and the six control points of a quintic Bézier curve.
static DATA: &[u8] = include_bytes!("../../../../assets/hosek-wilkie/rgb.f32");

const COEFFICIENTS: usize = 9;
const POINTS: usize = 6;
const TURBIDITIES: usize = 10;
const ALBEDOS: usize = 2;

pub struct Sky {
    /// A to G, I, H, by channel.
    coefficients: [[f32; COEFFICIENTS]; 3],
    radiances: [f32; 3],
}

impl Sky {
    /// Computes the sky for an elevation in [0, π/2] (radians), a turbidity in [1, 10] and a ground
    /// albedo in [0, 1].
    pub fn new(elevation: f32, turbidity: f32, albedo: f32) -> Self {
        let data: Vec<f32> = DATA
            .as_chunks()
            .0
            .iter()
            .map(|word| f32::from_le_bytes(*word))
            .collect();
        let points = ALBEDOS * TURBIDITIES * POINTS;
        let (coefficients, radiances) = data.split_at(3 * points * COEFFICIENTS);
        let t = (elevation / FRAC_PI_2).powf(1.0 / 3.0);
        let interpolated = |data: &[f32], stride: usize, index: usize| {
            interpolated(data, stride, index, turbidity, albedo, t)
        };
        let of_channel = |channel: usize| &coefficients[channel * points * COEFFICIENTS..];
        Self {
            coefficients: [0, 1, 2]
                .map(|i| std::array::from_fn(|k| interpolated(of_channel(i), COEFFICIENTS, k))),
            radiances: [0, 1, 2].map(|i| interpolated(&radiances[i * points..], 1, 0)),
        }
    }

    /// Returns the RGB radiance at angles to the zenith and to the sun, radians. Under a low sun it
    /// may be negative.
    pub fn radiance(&self, theta: f32, gamma: f32) -> [f32; 3] {
        let cos_gamma = gamma.cos();
        let cos_theta = theta.cos().abs();
        let rayleigh = cos_gamma * cos_gamma;
        [0, 1, 2].map(|channel| {
            // The data set has I before H.
            let [a, b, c, d, e, f, g, i, h] = self.coefficients[channel];
            let mie = (1.0 + rayleigh) / (1.0 + h * h - 2.0 * h * cos_gamma).powf(1.5);
            let horizon = 1.0 + a * (b / (cos_theta + 0.01)).exp();
            let rest = c + d * (e * gamma).exp() + f * rayleigh + g * mie + i * cos_theta.sqrt();
            self.radiances[channel] * (horizon * rest)
        })
    }
}

/// Interpolates coefficient `index` of `stride`: linearly between albedos and turbidities, by the
/// Bézier curve in t.
fn interpolated(
    data: &[f32],
    stride: usize,
    index: usize,
    turbidity: f32,
    albedo: f32,
    t: f32,
) -> f32 {
    let whole = turbidity.trunc() as usize;
    let part = turbidity.fract();
    let turbidities = [whole.saturating_sub(1), whole.min(TURBIDITIES - 1)];
    let mut sum = 0.0;
    for (albedo_index, albedo_weight) in [1.0 - albedo, albedo].into_iter().enumerate() {
        for (turbidity_index, turbidity_weight) in turbidities.into_iter().zip([1.0 - part, part]) {
            let first = (albedo_index * TURBIDITIES + turbidity_index) * POINTS * stride + index;
            sum +=
                albedo_weight * turbidity_weight * quintic(|point| data[first + point * stride], t);
        }
    }
    sum
}

fn quintic(point: impl Fn(usize) -> f32, t: f32) -> f32 {
    let t2 = t * t;
    let u = 1.0 - t;
    let t3 = t2 * t;
    let t4 = t2 * t2;
    let u2 = u * u;
    let t5 = t4 * t;
    let u3 = u2 * u;
    let u4 = u2 * u2;
    let u5 = u4 * u;
    point(0) * u5
        + point(1) * 5.0 * u4 * t
        + point(2) * 10.0 * u3 * t2
        + point(3) * 10.0 * u2 * t3
        + point(4) * 5.0 * u * t4
        + point(5) * t5
}
