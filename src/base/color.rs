//! Colour: luminance, sRGB, conversions between primaries. Linear RGB has Rec.709 primaries.

use glam::{DMat3, DVec2, DVec3};

/// Luminance weights of linear Rec.709 \[BT709\] item 3.2.
pub const REC709_LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// Luminance of linear Rec.709, in the unit of its channels.
pub fn luminance(rgb: [f32; 3]) -> f64 {
    rgb.iter()
        .zip(REC709_LUMINANCE)
        .map(|(&channel, weight)| f64::from(channel) * weight)
        .sum()
}

/// Encodes linear [0, 1] as an sRGB signal [0, 1] \[Srgb99\]. Clamps; NaN gives 0.
pub fn srgb_encode(linear: f32) -> f32 {
    // In f32 1.055 - 0.055 is not 1.
    let linear = if linear.is_nan() {
        0.0
    } else {
        f64::from(linear.clamp(0.0, 1.0))
    };
    srgb_curve(linear) as f32
}

/// The curve of [`srgb_encode`], which goes on above 1.
pub fn srgb_curve(linear: f64) -> f64 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

/// Decodes an sRGB signal; inverse of [`srgb_encode`].
pub fn srgb_decode(signal: f32) -> f32 {
    let signal = f64::from(signal);
    let linear = if signal <= 0.040_45 {
        signal / 12.92
    } else {
        ((signal + 0.055) / 1.055).powf(2.4)
    };
    linear as f32
}

/// CIE 1931 xy of the primaries and the white of an RGB space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chromaticities {
    pub red: DVec2,
    pub green: DVec2,
    pub blue: DVec2,
    pub white: DVec2,
}

/// Rec.709 and sRGB: white D65.
pub const REC709: Chromaticities = Chromaticities {
    red: DVec2::new(0.64, 0.33),
    green: DVec2::new(0.30, 0.60),
    blue: DVec2::new(0.15, 0.06),
    white: DVec2::new(0.3127, 0.3290),
};

/// P3 with white D65, as displays have it.
pub const DISPLAY_P3: Chromaticities = Chromaticities {
    red: DVec2::new(0.680, 0.320),
    green: DVec2::new(0.265, 0.690),
    blue: DVec2::new(0.150, 0.060),
    white: DVec2::new(0.3127, 0.3290),
};

/// Rec.2020.
pub const REC2020: Chromaticities = Chromaticities {
    red: DVec2::new(0.708, 0.292),
    green: DVec2::new(0.170, 0.797),
    blue: DVec2::new(0.131, 0.046),
    white: DVec2::new(0.3127, 0.3290),
};

/// Adobe RGB (1998).
pub const ADOBE_RGB: Chromaticities = Chromaticities {
    red: DVec2::new(0.64, 0.33),
    green: DVec2::new(0.21, 0.71),
    blue: DVec2::new(0.15, 0.06),
    white: DVec2::new(0.3127, 0.3290),
};

/// ACES 2065-1 (SMPTE ST 2065-1).
pub const ACES_AP0: Chromaticities = Chromaticities {
    red: DVec2::new(0.7347, 0.2653),
    green: DVec2::new(0.0, 1.0),
    blue: DVec2::new(0.0001, -0.077),
    white: DVec2::new(0.32168, 0.33767),
};

/// ACEScg (Academy S-2014-004).
pub const ACES_AP1: Chromaticities = Chromaticities {
    red: DVec2::new(0.713, 0.293),
    green: DVec2::new(0.165, 0.830),
    blue: DVec2::new(0.128, 0.044),
    white: DVec2::new(0.32168, 0.33767),
};

/// Returns the matrix from CIE XYZ, in which D65 is white, to linear Rec.709.
pub fn xyz_to_rec709() -> DMat3 {
    REC709
        .to_xyz()
        .expect("the primaries span a triangle")
        .inverse()
}

/// Warns of colours that a conversion took outside Rec.709.
pub fn out_of_gamut(texel_count: u64) -> Option<String> {
    (texel_count > 0).then(|| {
        format!("{texel_count} texels lie outside Rec.709; their negative channels were set to 0.")
    })
}

/// RGB space of the Radiance programs (`color.h`): nearly Rec.709, with equal-energy white.
pub const RADIANCE: Chromaticities = Chromaticities {
    red: DVec2::new(0.640, 0.330),
    green: DVec2::new(0.290, 0.600),
    blue: DVec2::new(0.150, 0.060),
    white: DVec2::new(1.0 / 3.0, 1.0 / 3.0),
};

impl Chromaticities {
    /// Returns the matrix to CIE XYZ; white has Y = 1. `None` if the primaries span no triangle or
    /// the white is outside.
    pub fn to_xyz(&self) -> Option<DMat3> {
        let xyz = |xy: DVec2| DVec3::new(xy.x, xy.y, 1.0 - xy.x - xy.y);
        let primaries = DMat3::from_cols(xyz(self.red), xyz(self.green), xyz(self.blue));
        // NaN fails both comparisons.
        let usable = primaries.determinant().abs() > 1e-6 && self.white.y > 1e-6;
        let amounts = usable.then(|| primaries.inverse() * (xyz(self.white) / self.white.y))?;
        (amounts.min_element() > 0.0).then(|| primaries * DMat3::from_diagonal(amounts))
    }

    /// Returns the matrix to linear Rec.709, white to white (Bradford adaptation \[Lam85\]); `None`
    /// as [`Chromaticities::to_xyz`].
    pub fn to_rec709(&self) -> Option<DMat3> {
        let bradford = DMat3::from_cols_array_2d(&[
            [0.8951, -0.7502, 0.0389],
            [0.2664, 1.7135, -0.0685],
            [-0.1614, 0.0367, 1.0296],
        ]);
        let to_xyz = self.to_xyz()?;
        let rec709_to_xyz = REC709.to_xyz()?;
        let cones = |to_xyz: DMat3| bradford * (to_xyz * DVec3::ONE);
        let adapt = DMat3::from_diagonal(cones(rec709_to_xyz) / cones(to_xyz));
        Some(rec709_to_xyz.inverse() * bradford.inverse() * adapt * bradford * to_xyz)
    }

    /// Converts as [`Self::to_rec709`] and adds a warning about the header field `name`.
    pub fn to_rec709_with_warning(&self, name: &str, warnings: &mut Vec<String>) -> Option<DMat3> {
        let matrix = self.to_rec709();
        warnings.push(match matrix {
            Some(_) => format!("The colours were converted from the header's {name} to Rec.709."),
            None => format!(
                "The header's {name} span no colour space; the colours were taken as Rec.709."
            ),
        });
        matrix
    }

    /// Whether no coordinate differs by more than 0.001, as files round.
    pub fn is_close_to(&self, other: &Self) -> bool {
        [
            (self.red, other.red),
            (self.green, other.green),
            (self.blue, other.blue),
            (self.white, other.white),
        ]
        .iter()
        .all(|(a, b)| (*a - *b).abs().max_element() <= 1e-3)
    }
}

#[cfg(test)]
mod tests;
