//! Colours of error maps. Ranges are fixed, so that maps are comparable.

use crate::base::pixels::{GrayImage, Rgb8Image};
use std::sync::LazyLock;

/// Colours over [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Palette {
    /// Black, purple, pale yellow, perceptually uniform: `magma` of Smith and van der Walt
    /// (matplotlib, CC0), in the 8-bit codes of d3. FLIP's authors use it, too.
    Magma,
    /// Blue, near white, red: `RdBu` of ColorBrewer 2.0 \[Brewer03\], reversed, interpolated
    /// linearly in encoded RGB. Safe for the colour-blind.
    BlueRed,
}

const BLUE_RED: [[u8; 3]; 11] = [
    [5, 48, 97],
    [33, 102, 172],
    [67, 147, 195],
    [146, 197, 222],
    [209, 229, 240],
    [247, 247, 247],
    [253, 219, 199],
    [244, 165, 130],
    [214, 96, 77],
    [178, 24, 43],
    [103, 0, 31],
];

/// For NaN; not in any palette.
pub const NAN_COLOR: [u8; 3] = [0, 255, 0];

pub const OFF_MASK_COLOR: [u8; 3] = [236, 236, 236];

impl Palette {
    /// The sRGB-encoded colour at `t`, clamped to [0, 1].
    pub fn color(self, t: f64) -> [u8; 3] {
        static MAGMA: LazyLock<[[u8; 3]; 256]> = LazyLock::new(|| {
            std::array::from_fn(|i| colorous::MAGMA.eval_rational(i, 256).as_array())
        });
        if t.is_nan() {
            return NAN_COLOR;
        }
        let colors: &[[u8; 3]] = match self {
            Self::Magma => &*MAGMA,
            Self::BlueRed => &BLUE_RED,
        };
        let position = t.clamp(0.0, 1.0) * (colors.len() - 1) as f64;
        let lower = (position as usize).min(colors.len() - 2);
        let weight = position - lower as f64;
        std::array::from_fn(|c| {
            let [a, b] = [colors[lower][c], colors[lower + 1][c]].map(f64::from);
            (a + weight * (b - a)).round() as u8
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    Linear {
        lo: f64,
        hi: f64,
    },
    /// 0 < lo < hi; smaller values, 0 included, have the first colour.
    Log {
        lo: f64,
        hi: f64,
    },
}

/// A palette over a fixed range of values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorScale {
    pub palette: Palette,
    pub range: Range,
}

pub const RELATIVE_ERROR: ColorScale = ColorScale {
    palette: Palette::Magma,
    range: Range::Log { lo: 1e-3, hi: 1.0 },
};
/// Blue is too dark, red too bright.
pub const SIGNED_ERROR: ColorScale = ColorScale {
    palette: Palette::BlueRed,
    range: Range::Linear { lo: -0.5, hi: 0.5 },
};
pub const FLIP_ERROR: ColorScale = ColorScale {
    palette: Palette::Magma,
    range: Range::Linear { lo: 0.0, hi: 1.0 },
};

/// Intervals between the ticks of a linear range.
const LINEAR_TICK_COUNT: u32 = 4;

impl ColorScale {
    /// The colour of a value, clamped to the range.
    pub fn color(&self, value: f64) -> [u8; 3] {
        self.palette.color(self.share(value))
    }

    /// The position of a value on the palette: 0 at `lo`, 1 at `hi`.
    pub fn share(&self, value: f64) -> f64 {
        match self.range {
            Range::Linear { lo, hi } => (value - lo) / (hi - lo),
            // The maximum would turn a NaN into `lo`.
            Range::Log { .. } if value.is_nan() => value,
            Range::Log { lo, hi } => (value.max(lo) / lo).ln() / (hi / lo).ln(),
        }
    }

    /// Values on a legend, ascending: powers of ten of a logarithmic range, ends and quarters of a
    /// linear one.
    pub fn ticks(&self) -> Vec<f64> {
        match self.range {
            Range::Linear { lo, hi } => (0..=LINEAR_TICK_COUNT)
                .map(|i| lo + (hi - lo) * f64::from(i) / f64::from(LINEAR_TICK_COUNT))
                .collect(),
            Range::Log { lo, hi } => {
                // Parsed: a power is not the nearest f64.
                let decade = |exponent: i32| format!("1e{exponent}").parse::<f64>().ok();
                let first = lo.log10().round() as i32;
                let last = hi.log10().round() as i32;
                (first..=last)
                    .filter_map(decade)
                    .filter(|tick| (lo..=hi).contains(tick))
                    .collect()
            }
        }
    }

    /// Colours a map; the mask must have its size.
    pub fn image(&self, map: &GrayImage, mask: &GrayImage) -> Rgb8Image {
        assert_eq!(
            [map.width, map.height],
            [mask.width, mask.height],
            "size of the mask of an error map"
        );
        Rgb8Image::from_fn(map.width, map.height, |x, y| {
            if mask.get(x, y) == 0.0 {
                OFF_MASK_COLOR
            } else {
                self.color(f64::from(map.get(x, y)))
            }
        })
    }
}

#[cfg(test)]
mod tests;
