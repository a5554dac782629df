//! Lookups between texel centres in f64: the twins of the device's linear samplers.
//!
//! Texel (i, j) of a W x H image has its centre at `uv = ((i + 1/2)/W, (j + 1/2)/H)`.

use super::Pixels;
use glam::{DVec2, DVec3};

/// How a lookup goes on beyond the edges of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The outermost texels go on in both directions.
    Clamp,
    /// u repeats, v clamps: an equirectangular map.
    Equirect,
    /// Both repeat.
    RepeatBoth,
}

impl Wrap {
    /// The texel that stands at a whole coordinate inside or outside the image.
    fn texel(self, x: f64, y: f64, [width, height]: [f64; 2]) -> [u32; 2] {
        let repeated = |i: f64, count: f64| i.rem_euclid(count);
        let clamped = |i: f64, count: f64| i.clamp(0.0, count - 1.0);
        let (x, y) = match self {
            Self::Clamp => (clamped(x, width), clamped(y, height)),
            Self::Equirect => (repeated(x, width), clamped(y, height)),
            Self::RepeatBoth => (repeated(x, width), repeated(y, height)),
        };
        [x as u32, y as u32]
    }
}

/// The value at `uv`, linear between the four nearest texel centres; `value` turns a texel into f64.
pub fn bilinear<T: Copy>(image: &Pixels<T>, uv: DVec2, wrap: Wrap, value: impl Fn(T) -> DVec3) -> DVec3 {
    let size = [f64::from(image.width), f64::from(image.height)];
    let at = uv * DVec2::from_array(size) - 0.5;
    let low = at.floor();
    let texel = |dx: f64, dy: f64| {
        let [x, y] = wrap.texel(low.x + dx, low.y + dy, size);
        value(image.get(x, y))
    };
    let row = |dy: f64| texel(0.0, dy).lerp(texel(1.0, dy), at.x - low.x);
    row(0.0).lerp(row(1.0), at.y - low.y)
}

/// The value at `uv` of a chain of levels, finest first: linear between the two levels about `lod`, which is clamped to the chain.
pub fn trilinear(levels: &[Pixels<DVec3>], uv: DVec2, lod: f64, wrap: Wrap) -> DVec3 {
    let lod = lod.clamp(0.0, levels.len() as f64 - 1.0);
    let level = |k: usize| bilinear(&levels[k.min(levels.len() - 1)], uv, wrap, |texel| texel);
    let fine = lod.floor() as usize;
    level(fine).lerp(level(fine + 1), lod.fract())
}
