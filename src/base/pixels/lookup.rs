//! Filtered lookups in f64: twins of the device's linear samplers.
//!
//! Texel (i, j) of a W x H image has its centre at `uv = ((i + 1/2)/W, (j + 1/2)/H)`.

use super::Pixels;
use glam::{DVec2, DVec3};

/// Continues coordinates beyond an image's edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Edge {
    Clamp,
    Repeat,
    /// Repeats, mirrored every second time.
    Mirror,
}

/// The edges of u and v.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Wrap(pub Edge, pub Edge);

impl Wrap {
    pub const CLAMP: Self = Self(Edge::Clamp, Edge::Clamp);
    pub const EQUIRECT: Self = Self(Edge::Repeat, Edge::Clamp);
    pub const REPEAT: Self = Self(Edge::Repeat, Edge::Repeat);

    /// Returns the texel at a whole coordinate inside or outside the image.
    fn texel(self, x: f64, y: f64, [width, height]: [f64; 2]) -> [u32; 2] {
        let index = |edge: Edge, i: f64, count: f64| match edge {
            Edge::Clamp => i.clamp(0.0, count - 1.0),
            Edge::Repeat => i.rem_euclid(count),
            Edge::Mirror => count - 0.5 - (i.rem_euclid(2.0 * count) + 0.5 - count).abs(),
        };
        [
            index(self.0, x, width) as u32,
            index(self.1, y, height) as u32,
        ]
    }
}

/// Interpolates between the four nearest texel centres; `value` converts a texel to f64.
pub fn bilinear<T: Copy>(
    image: &Pixels<T>,
    uv: DVec2,
    wrap: Wrap,
    value: impl Fn(T) -> DVec3,
) -> DVec3 {
    let size = DVec2::new(f64::from(image.width), f64::from(image.height));
    let texel = |x: u32, y: u32| value(image.get(x, y));
    bilinear_at(uv * size - 0.5, size.to_array(), wrap, texel)
}

/// Interpolates at a position in texels: 0, 0 is the centre of the first texel.
pub fn bilinear_at(
    position: DVec2,
    size: [f64; 2],
    wrap: Wrap,
    value: impl Fn(u32, u32) -> DVec3,
) -> DVec3 {
    let low = position.floor();
    let texel = |dx: f64, dy: f64| {
        let [x, y] = wrap.texel(low.x + dx, low.y + dy, size);
        value(x, y)
    };
    let row = |dy: f64| texel(0.0, dy).lerp(texel(1.0, dy), position.x - low.x);
    row(0.0).lerp(row(1.0), position.y - low.y)
}

/// Interpolates between the two levels around `lod`, finest first; clamps `lod`.
pub fn trilinear<T: Copy>(
    levels: &[Pixels<T>],
    uv: DVec2,
    lod: f64,
    wrap: Wrap,
    value: impl Fn(T) -> DVec3,
) -> DVec3 {
    let lod = lod.clamp(0.0, levels.len() as f64 - 1.0);
    let level = |k: usize| bilinear(&levels[k.min(levels.len() - 1)], uv, wrap, &value);
    let fine = lod.floor() as usize;
    level(fine).lerp(level(fine + 1), lod.fract())
}
