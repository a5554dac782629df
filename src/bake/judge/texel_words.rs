//! Words of slips that change texels: sources, channels, encodings.

use super::cause::Encoding;
use super::clause::Clause;
use super::light::{Half, SourceSlip};
use super::texel::{
    ChannelCopy, ChannelOrder, ColorConversion, Curve, Cut, Packing, Primaries, Rgbm, Tone,
};

/// Largest relative difference of an exposure from 1 that is not mentioned.
const EXPOSURE_APART: f64 = 0.02;
/// Largest difference of the limit of LDR images from 1.
const LDR_APART: f64 = 0.05;

/// Rounds to three significant digits.
pub fn three_digits(x: f64) -> f64 {
    let digits = 10.0_f64.powf(2.0 - x.max(1e-9).log10().floor());
    (x * digits).round() / digits
}

pub fn source_clause(slip: SourceSlip) -> Clause {
    match slip {
        SourceSlip::Cut { cut, limit } => {
            let text = format!("source cut at {}", three_digits(limit));
            match cut {
                Cut::EachChannel if (limit - 1.0).abs() < LDR_APART => {
                    Clause::detailed(text, "LDR")
                }
                Cut::EachChannel => Clause::new(text),
                Cut::WithHue => Clause::new(text + " with its hue"),
                Cut::ToBlack => Clause::detailed(text, "what is brighter is black"),
            }
        }
        SourceSlip::Curve(curve) => curve_clause(curve).after("source "),
        SourceSlip::CutAndCurve(curve) => curve_clause(curve).after("source cut at 1 and "),
        SourceSlip::Tone { tone, exposure } => {
            Clause::new(format!("source {}", tone_words(tone, exposure)))
        }
        SourceSlip::WithoutHalf(half) => {
            let name = match half {
                Half::Upper => "upper",
                Half::Lower => "lower",
            };
            Clause::new(format!("source without its {name} half"))
        }
        SourceSlip::WithoutSolidAngle => {
            Clause::new("source summed without the solid angle of its pixels, sin θ")
        }
        SourceSlip::Level0 => Clause::detailed(
            "right for level 0 of the file as the light",
            "it inherits what is wrong there",
        ),
        SourceSlip::DarkWeighted => {
            Clause::new("samples weighted by 1/(1 + luminance), as against fireflies")
        }
    }
}

pub fn channels(order: ChannelOrder) -> String {
    order.0.map(|channel| ["R", "G", "B"][channel]).join(", ")
}

pub fn copy_words(copy: ChannelCopy) -> &'static str {
    match copy {
        ChannelCopy::AlphaFirst => "channels in the order A, R, G",
        ChannelCopy::Red => "red in every channel",
        ChannelCopy::Green => "green in every channel",
        ChannelCopy::Blue => "blue in every channel",
        ChannelCopy::Luminance => "luminance in every channel",
        ChannelCopy::Mean => "the mean in every channel",
    }
}

pub fn conversion_words(conversion: ColorConversion) -> String {
    let (direction, primaries) = match conversion {
        ColorConversion::To(primaries) => ("to", primaries),
        ColorConversion::From(primaries) => ("from", primaries),
    };
    let name = match primaries {
        Primaries::AcesCg => "ACEScg (AP1)",
        Primaries::Rec2020 => "Rec. 2020",
        Primaries::DisplayP3 => "Display P3",
        Primaries::CieXyz => "CIE XYZ",
    };
    format!("converted {direction} {name}")
}

pub fn encoding_clause(encoding: Encoding) -> Clause {
    match encoding {
        Encoding::Curve(curve) => curve_clause(curve),
        Encoding::Tone { tone, exposure } => Clause::new(tone_words(tone, exposure)),
        Encoding::Packing(packing) => packing_clause(packing),
        Encoding::RgbpScaleRoundedUp => Clause::detailed(
            "RGBP whose scale was rounded up",
            "the largest channel loses up to 5.3 % above 1; round it down",
        ),
        Encoding::Rgbm(Rgbm { range, exponent }) => {
            let power = if exponent == 1.0 {
                String::new()
            } else {
                format!(" to the power of {exponent}")
            };
            Clause::detailed(
                "RGBM read as linear",
                format!("decode {range} alpha RGB{power}"),
            )
        }
    }
}

fn packing_clause(packing: Packing) -> Clause {
    match packing {
        Packing::Rgbd => Clause::detailed("RGBD read as linear", "divide by alpha"),
        Packing::RgbdGamma => Clause::detailed("RGBD with gamma 2.2 read as linear", "decode it"),
        Packing::Rgbe => Clause::detailed("RGBE read as linear", "times 2^(255 alpha - 128)"),
        Packing::LogLuv => Clause::detailed("LogLuv read as linear", "decode it"),
        Packing::HalfAsInteger => Clause::new("half floats read as 16-bit integers"),
    }
}

pub fn curve_clause(curve: Curve) -> Clause {
    match curve {
        Curve::GammaEncoded => Clause::detailed("encoded with gamma 2.2", "decode it"),
        Curve::GammaDecoded => Clause::new("decoded with gamma 2.2 though linear"),
        Curve::SrgbEncoded => Clause::detailed("encoded as sRGB", "decode it"),
        Curve::SrgbDecoded => Clause::new("decoded as sRGB though linear"),
    }
}

fn tone_words(tone: Tone, exposure: f64) -> String {
    let text = match tone {
        Tone::Reinhard => "tone-mapped by Reinhard's x/(1 + x)",
        Tone::Aces => "tone-mapped by ACES (Narkowicz)",
        Tone::Hable => "tone-mapped by Hable's curve, white at 11.2",
        Tone::Exponential => "tone-mapped by 1 - exp(-x)",
        Tone::Logarithm => "encoded as ln(1 + x)",
        Tone::Pq => "encoded as PQ with 1 at 100 nits",
    };
    if (exposure - 1.0).abs() < EXPOSURE_APART {
        text.to_owned()
    } else {
        format!("{text}, exposed by {}", three_digits(exposure))
    }
}
