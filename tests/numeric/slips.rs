//! What the slips of the source documents cost, against figures that were derived elsewhere.

use glam::{DVec2, DVec3};
use splitsum::brdf::{Beckmann, Brdf, Ggx, MaskingShadowing, Phong};
use splitsum::math::equirect::{direction_from_uv, uv_from_direction};
use splitsum::precompute::dfg::reference::dfg;
use splitsum::slips::{Figure, costs, slips};
use std::f64::consts::PI;

/// Document, part of the printed formula, part of the quantity, value as printed, right value. Half a unit of the last digit, and as
/// much again, is the tolerance.
const DERIVED: &[(u32, &str, &str, &str, &str)] = &[
    (0, "a_p", "exponent", "6.000", "30.000"),
    (0, "G_p", "n·v 0.1", "1.141", "0.558"),
    (0, "G_p", "n·v 0.01", "1.319", "0.608"),
    (0, "G_g", "G1", "0.18", "0.83"),
    (0, "G_g", "albedo, alpha 0.1, n·v 0.1", "0.09", "0.87"),
    (0, "F f_cook-torrance", "mirror", "0.0016", "0.0400"),
    (0, "half vectors from D", "alpha 0.1, n·v 0.1", "1.236", "0.873"),
    (0, "half vectors from D", "alpha 0.1, n·v 0.5", "0.469", "0.969"),
    (0, "half vectors from D", "alpha 0.1, n·v 1", "0.247", "0.988"),
    (0, "half vectors from D", "alpha 0.5, n·v 0.1", "0.321", "0.772"),
    (0, "half vectors from D", "alpha 0.5, n·v 0.5", "0.227", "0.686"),
    (0, "half vectors from D", "alpha 0.5, n·v 1", "0.172", "0.688"),
    (0, "seed0-literal", "alpha 0.1, n·v 0.1", "1.403", "0.873"),
    (0, "seed0-literal", "alpha 0.1, n·v 0.5", "0.487", "0.969"),
    (0, "seed0-literal", "alpha 0.1, n·v 1", "0.250", "0.988"),
    (0, "seed0-literal", "alpha 0.5, n·v 0.1", "0.305", "0.772"),
    (0, "seed0-literal", "alpha 0.5, n·v 0.5", "0.298", "0.686"),
    (0, "seed0-literal", "alpha 0.5, n·v 1", "0.239", "0.688"),
    (0, "Phong:", "sin² of the lobe, alpha 1", "0.667", "0.500"),
    (0, "level", "v = n, equator", "1.15", "0.000"),
    (0, "level", "n·v 0.1, equator", "2.81", "0.000"),
    (0, "level", "sin θ 0.1", "-0.51", "0.000"),
    (0, "texel to direction", "degrees", "120.000", "0.000"),
    (0, "pixel", "least", "-0.040", "0.000"),
    (0, "pixel", "90 degrees (", "0.094", "0.000"),
    (0, "pixel", "peak", "1.0625", "1.0000"),
    (1, "MAX_REFLECTION_LOD", "10 levels", "0.556", "0.500"),
    (1, "(F A + B)", "factor", "0.60", "0.17"),
    (1, "G_Smith", "(r + 1)²/8", "0.183", "0.994"),
    (1, "G_Smith", "alpha/2, alpha 0.01", "0.914", "0.994"),
    (1, "G_Smith", "alpha/2, alpha 0.1", "0.658", "0.873"),
    (1, "sin θ dφ dθ", "radiance 1", "0.000987", "0.99992"),
    (4, "table: mean", "n·v 0.1", "26.9", "0.99"),
    (4, "table: mean", "n·v 0.5", "1.0", "1.00"),
    (4, "table: mean", "n·v 1", "0.25", "1.00"),
    (4, "p(θ, φ)", "integral", "6.28319", "1.00000"),
];

fn assert_figure(what: &str, found: f64, derived: &str) {
    let decimals = derived.split_once('.').map_or(0, |(_, digits)| digits.len() as i32);
    let expected: f64 = derived.parse().unwrap();
    assert!((found - expected).abs() <= 10f64.powi(-decimals), "{what}: {found} against {derived}");
}

#[test]
fn figures_are_those_derived_elsewhere() {
    for &(document, formula, quantity, printed, right) in DERIVED {
        let mut slip = slips().filter(|(of, slip)| *of == document && slip.printed.contains(formula));
        let (_, first) = slip.next().unwrap_or_else(|| panic!("no slip has {formula}"));
        let figures = (first.figures)();
        assert!(slip.next().is_none(), "{formula} names more than one slip");
        // "n·v 0.1" is not "n·v 0.1, equator", unless nothing ends in it.
        let mut ends = figures.iter().filter(|figure| figure.quantity.ends_with(quantity));
        let mut has = figures.iter().filter(|figure| figure.quantity.contains(quantity));
        let figure = ends.next().or(has.next()).unwrap_or_else(|| panic!("{formula} has no {quantity}"));
        assert_figure(&format!("{formula}, {quantity}, as printed"), figure.printed, printed);
        assert_figure(&format!("{formula}, {quantity}, right"), figure.right, right);
    }
}

#[test]
fn every_slip_costs_something() {
    for (_, slip) in slips() {
        let figures = (slip.figures)();
        assert!(!figures.is_empty(), "{}", slip.printed);
        for figure in figures {
            assert!(figure.right.is_finite(), "{}: {}", slip.printed, figure.quantity);
            // A wrong formula may give the right value somewhere, but not a figure that is worth printing.
            assert!(figure.printed != figure.right, "{}: {}", slip.printed, figure.quantity);
        }
    }
}

#[test]
fn printed_direction_of_a_texel() {
    // (cos φ sin θ, sin φ sin θ, cos θ) is no inverse of the printed uv: it turns x to y, y to z and z to x.
    let printed = |uv: DVec2| {
        let d = direction_from_uv(uv);
        DVec3::new(d.z, d.x, d.y)
    };
    for (from, to) in [(DVec3::X, DVec3::Y), (DVec3::Y, DVec3::Z), (DVec3::Z, DVec3::X)] {
        assert!(printed(uv_from_direction(from)).abs_diff_eq(to, 1e-12), "{from}");
        assert!(direction_from_uv(uv_from_direction(from)).abs_diff_eq(from, 1e-12), "{from}");
    }
    let (phi, theta) = (2.0 * PI * (0.5 - 0.3), PI * 0.6);
    let literal = DVec3::new(phi.cos() * theta.sin(), phi.sin() * theta.sin(), theta.cos());
    assert!(printed(DVec2::new(0.3, 0.6)).abs_diff_eq(literal, 1e-12));
}

#[test]
fn rational_masking_of_phong_adds_energy() {
    let albedo = |model: &'static dyn Brdf, masking, n_dot_v| dfg(model, masking, n_dot_v, 1.0).albedo();
    let separable = MaskingShadowing::Separable;
    assert_figure("phong", albedo(&Phong, separable, 0.1), "1.141");
    assert_figure("beckmann", albedo(&Beckmann, separable, 0.1), "0.905");
    assert_figure("ggx", albedo(&Ggx, separable, 0.1), "0.558");
    assert_figure("phong at 0.01", albedo(&Phong, separable, 0.01), "1.319");
    assert_figure("phong correlated", albedo(&Phong, MaskingShadowing::Correlated, 0.1), "1.306");
    assert_figure("phong correlated at 0.01", albedo(&Phong, MaskingShadowing::Correlated, 0.01), "1.682");
    assert_figure("phong exact", albedo(&Phong, MaskingShadowing::SmithExact, 0.1), "0.558");
}

#[test]
fn a_slip_stands_for_its_worst_figure_of_light() {
    let costs = costs();
    assert_eq!(costs.len(), slips().count(), "each once");
    let of = |document: u32, part: &str| {
        let mut own = costs.iter().filter(|cost| cost.document == document && cost.slip.printed.contains(part));
        let found = own.next().unwrap_or_else(|| panic!("no slip has {part}"));
        assert!(own.next().is_none(), "{part} names more than one slip");
        found
    };
    // From the derived figures above: 0.04 / 0.0016, 26.9 / 0.99, 0.99992 / 0.000987.
    for (document, part, ratio) in
        [(0, "F f_cook-torrance", 25.0), (4, "table: mean", 27.2), (1, "sin θ dφ dθ", 1013.1)]
    {
        let found = of(document, part).light_ratio.unwrap();
        assert!((found / ratio - 1.0).abs() < 0.01, "{part}: {found}");
    }
    // Of figures of light and others those of light count.
    assert!(of(0, "G_g").figure.quantity.starts_with("albedo"));
    // Degrees, levels and exponents are no light, however wrong.
    for (document, part) in [(0, "texel to direction"), (0, "level"), (0, "a_p"), (1, "MAX_REFLECTION_LOD")] {
        assert_eq!(of(document, part).light_ratio, None, "{part}");
    }
    let figure = |printed, right| Figure { quantity: "albedo", printed, right, is_light: true };
    assert_eq!((figure(0.5, 1.0).light_ratio(), figure(2.0, 1.0).light_ratio()), (Some(2.0), Some(2.0)));
    assert_eq!((figure(0.5, 0.0).light_ratio(), figure(f64::NAN, 1.0).light_ratio()), (None, None));
}
