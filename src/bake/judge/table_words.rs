//! Words of slips of DFG tables.

use super::clause::Clause;
use super::table::GRAZING;
use super::table_slip::{Integral, Reading, StretchedLines, TableFlags, TableSlip, WrongBorders};
use super::texel_words::curve_clause;
use glam::DVec2;

/// Returns the word for the slip in JSON.
pub fn kind(slip: TableSlip) -> &'static str {
    match slip {
        TableSlip::Convention { .. } => "convention",
        TableSlip::Reading { reading, .. } | TableSlip::ConventionAndReading { reading, .. } => {
            match reading {
                Reading::Curve(_) => "encoding",
                Reading::Alpha | Reading::RootOfRoughness | Reading::RootOfNDotV => "axis",
            }
        }
        TableSlip::Shift { .. } | TableSlip::Stretch { .. } => "shift",
        TableSlip::Integral(_) => "integral",
        TableSlip::TooFewSamples => "noise",
        TableSlip::Borders(_) => "borders",
    }
}

pub fn clauses(slip: TableSlip) -> Vec<Clause> {
    let (clauses, share_left) = match slip {
        TableSlip::Convention { flags, rms_left } => {
            let rest = Clause::remainder(format!("rms {rms_left:.1e} if fixed"));
            return vec![fitting_clause(flags), rest];
        }
        TableSlip::ConventionAndReading { flags, reading } => {
            let reading = reading_clauses(reading);
            return [fitting_clause(flags)].into_iter().chain(reading).collect();
        }
        TableSlip::Integral(integral) => return integral_clauses(integral),
        TableSlip::TooFewSamples => {
            return vec![Clause::detailed(
                "too few samples",
                format!("beyond n·v {GRAZING} it is within a step of 8 bits"),
            )];
        }
        TableSlip::Borders(sides) => {
            let sides = border_words(sides);
            return vec![Clause::detailed(
                format!("its outermost texels at the {sides} are wrong"),
                "the others are within a step of 8 bits",
            )];
        }
        TableSlip::Reading {
            reading,
            share_left,
        } => (reading_clauses(reading), share_left),
        TableSlip::Shift { texels, share_left } => (vec![shift_clause(texels)], share_left),
        TableSlip::Stretch { lines, share_left } => (stretch_clauses(lines), share_left),
    };
    let left = format!("fixing it leaves {:.0} % of the rms", 100.0 * share_left);
    clauses.into_iter().chain([Clause::new(left)]).collect()
}

fn border_words(sides: WrongBorders) -> String {
    let named = [
        (sides.left, "left"),
        (sides.right, "right"),
        (sides.top, "top"),
        (sides.bottom, "bottom"),
    ];
    let names: Vec<&str> = named
        .iter()
        .filter(|(is_wrong, _)| *is_wrong)
        .map(|(_, name)| *name)
        .collect();
    names.join(", ")
}

fn fitting_clause(flags: TableFlags) -> Clause {
    let named = [
        ("--table-axes", flags.axes),
        ("--table-channels", flags.channels),
        ("--masking", flags.masking),
    ];
    let mut text = "fits".to_owned();
    for (flag, name) in named {
        if let Some(name) = name {
            text += &format!(" {flag} {name}");
        }
    }
    Clause::new(text)
}

fn reading_clauses(reading: Reading) -> Vec<Clause> {
    match reading {
        Reading::Curve(curve) => vec![curve_clause(curve)],
        Reading::Alpha => vec![
            Clause::new("spaced by alpha"),
            Clause::new("expected perceptual roughness"),
        ],
        Reading::RootOfRoughness => vec![Clause::new("spaced by the root of roughness")],
        Reading::RootOfNDotV => vec![Clause::new("spaced by the root of n·v")],
    }
}

fn shift_clause(texels: DVec2) -> Clause {
    let side = |shift: f64, ahead: &'static str, behind: &'static str| {
        let side = if shift > 0.0 { behind } else { ahead };
        (shift != 0.0).then_some(side)
    };
    let along_row = side(texels.x, "far right", "far left");
    let along_column = side(texels.y, "low", "high");
    let sides: Vec<&str> = along_row.into_iter().chain(along_column).collect();
    Clause::new(format!(
        "its values are {} texel too {}",
        texels.abs().max_element(),
        sides.join(" and too ")
    ))
}

fn stretch_clauses(lines: StretchedLines) -> Vec<Clause> {
    let name = match lines {
        StretchedLines::Columns => "columns",
        StretchedLines::Rows => "rows",
        StretchedLines::Both => "texels",
    };
    vec![
        Clause::new(format!("its {name} are at i/(n - 1), from edge to edge")),
        Clause::new("expected centres, (i + 0.5)/n"),
    ]
}

fn integral_clauses(integral: Integral) -> Vec<Clause> {
    let texts: &[&str] = match integral {
        Integral::SchlickDirect => &[
            "Schlick's masking of direct light, k = (r + 1)^2/8",
            "expected k = alpha/2",
        ],
        Integral::SchlickAlphaSquared => {
            &["Schlick's masking of k = alpha^2/2", "expected k = alpha/2"]
        }
        Integral::SchlickAlpha => &["Schlick's masking of k = alpha", "expected k = alpha/2"],
        Integral::SchlickQuarter => &[
            "Schlick's masking of k = alpha/4, as in SAPIEN",
            "expected k = alpha/2",
        ],
        Integral::SchlickRoughness => &["Schlick's masking of k = r/2", "expected k = alpha/2"],
        Integral::MaskingByRoughness => &["masking by roughness", "expected alpha"],
        Integral::MaskingByAlphaSquared => &["masking by alpha squared", "expected alpha"],
        Integral::FresnelOfHalf => &["Fresnel of n·h", "expected v·h"],
        Integral::FresnelOfView => &["Fresnel of n·v", "expected v·h"],
        Integral::WithoutFactor => &["samples without the factor v·h of their weight"],
        Integral::WithoutDivisor => &["samples without the divisor n·h of their weight"],
    };
    texts.iter().map(|text| Clause::new(*text)).collect()
}
