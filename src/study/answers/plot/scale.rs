//! From numbers to places on an axis, and the ticks of an axis.

use crate::table::markdown::significant;

/// How an axis runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Linear,
    Log,
}

/// An axis over `lo..hi`, which holds all its data with a margin.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    pub kind: Kind,
    pub lo: f64,
    pub hi: f64,
    /// Value and text, ascending.
    pub ticks: Vec<(f64, String)>,
    /// Values of the marks between them.
    pub minor: Vec<f64>,
}

/// Room beyond the data, as a share of the axis.
const MARGIN: f64 = 0.05;
/// A logarithmic axis that spans less has ticks at 1, 2 and 5 of each decade.
const SPARSE_FROM_DECADES: f64 = 2.0;
/// A logarithmic axis never spans less than this factor: two equal values are not a blank plot.
const FACTOR_MIN: f64 = 2.0;
/// Neighbouring labels are at least this far apart, as a share of the axis over the number of labels it has room for.
const LABEL_DISTANCE: f64 = 0.75;
/// Longer numbers are rounded for a label.
const TICK_DIGITS: usize = 6;
/// About as many ticks has a linear axis.
const LINEAR_TICKS: f64 = 8.0;
/// An axis with fewer ticks does not tell how it runs.
const TICKS_MIN: usize = 3;
/// More decades than this are labelled two by two, and so on.
const DECADES_LABELLED: i32 = 8;

impl Scale {
    /// An axis for these values; those that it cannot show (not finite, and for a logarithm not positive) are left out. `None` when
    /// nothing is left.
    pub fn of(kind: Kind, values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let shown = |x: &f64| x.is_finite() && (kind == Kind::Linear || *x > 0.0);
        let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.into_iter().filter(shown) {
            (lo, hi) = (lo.min(value), hi.max(value));
        }
        if lo > hi {
            return None;
        }
        Some(match kind {
            Kind::Log => Self::log(lo, hi),
            Kind::Linear => Self::linear(lo, hi),
        })
    }

    fn log(lo: f64, hi: f64) -> Self {
        let (middle, half) = ((lo * hi).sqrt(), (hi / lo).max(FACTOR_MIN).sqrt());
        let margin = (half * half).powf(MARGIN);
        let (lo, hi) = (middle / half / margin, middle * half * margin);
        let decades = hi.log10() - lo.log10();
        let (first, last) = (lo.log10().floor() as i32, hi.log10().ceil() as i32);
        let step = (last - first) / DECADES_LABELLED + 1;
        let inside = |x: &f64| (lo..=hi).contains(x);
        let multiples = |of: &[u32]| -> Vec<f64> {
            (first..=last).flat_map(|e| of.iter().map(move |m| decade(*m, e))).filter(inside).collect()
        };
        let sparse = multiples(&[1, 2, 5]);
        let ticks: Vec<f64> = match () {
            // Less than a factor of 10 may hold one of them only: tenths between them.
            () if sparse.len() < TICKS_MIN => (first..=last)
                .flat_map(|e| [10, 12, 15, 20, 30, 50, 70].map(|m| decade(m, e - 1)))
                .filter(inside)
                .collect(),
            () if decades < SPARSE_FROM_DECADES => sparse,
            () => (first..=last).filter(|e| e.rem_euclid(step) == 0).map(|e| decade(1, e)).filter(inside).collect(),
        };
        let minor = multiples(&[1, 2, 3, 4, 5, 6, 7, 8, 9]).into_iter().filter(|x| !ticks.contains(x)).collect();
        Self { kind: Kind::Log, lo, hi, ticks: ticks.into_iter().map(|x| (x, tick_text(x))).collect(), minor }
    }

    fn linear(lo: f64, hi: f64) -> Self {
        let span = if hi > lo { hi - lo } else { lo.abs().max(1.0) };
        let (lo, hi) = (lo - MARGIN * span, hi + MARGIN * span);
        let rough = (hi - lo) / LINEAR_TICKS;
        let power = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|step| *step >= rough).unwrap_or(rough);
        let first = (lo / step).ceil() as i64;
        let last = (hi / step).floor() as i64;
        let decimals = (-step.log10().floor()).max(0.0) as usize;
        let tick = |i: i64| (i as f64 * step, format!("{:.decimals$}", i as f64 * step));
        Self { kind: Kind::Linear, lo, hi, ticks: (first..=last).map(tick).collect(), minor: Vec::new() }
    }

    /// The same axis with ticks at given values only: those that were tried. Where they are too dense for `most` labels some have none;
    /// the last one always has.
    pub fn with_ticks(mut self, values: &[f64], most: usize) -> Self {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        sorted.dedup();
        // Uneven values crowd: labels keep a distance.
        let distance = LABEL_DISTANCE / most.max(1) as f64;
        let mut last = f64::INFINITY;
        let (mut ticks, mut minor) = (Vec::new(), Vec::new());
        for value in sorted.into_iter().rev() {
            match self.place(value) {
                Some(place) if last - place >= distance => {
                    last = place;
                    ticks.push((value, tick_text(value)));
                }
                _ => minor.push(value),
            }
        }
        ticks.reverse();
        minor.reverse();
        (self.ticks, self.minor) = (ticks, minor);
        self
    }

    /// Where a value lies: 0 at `lo`, 1 at `hi`; `None` for what the axis cannot show.
    pub fn place(&self, value: f64) -> Option<f64> {
        let place = match self.kind {
            Kind::Linear => (value - self.lo) / (self.hi - self.lo),
            Kind::Log => (value / self.lo).ln() / (self.hi / self.lo).ln(),
        };
        place.is_finite().then_some(place)
    }
}

/// The nearest f64 to `m 10^e`.
fn decade(m: u32, e: i32) -> f64 {
    format!("{m}e{e}").parse().expect("digits and an exponent are a number")
}

/// `0.01`, `1`, `200`; powers of ten far from 1 as `10⁻⁵`.
pub fn tick_text(x: f64) -> String {
    const PLAIN: std::ops::RangeInclusive<f64> = 0.000_999..=99_999.0;
    if x == 0.0 || PLAIN.contains(&x.abs()) {
        let text = x.to_string();
        return if text.trim_start_matches(['-', '0', '.']).len() > TICK_DIGITS { significant(x, 3) } else { text };
    }
    let scientific = format!("{x:e}");
    let (mantissa, exponent) = scientific.split_once('e').expect("the exponent format has an e");
    let raised: String = exponent.chars().map(superscript).collect();
    if mantissa == "1" { format!("10{raised}") } else { format!("{mantissa}·10{raised}") }
}

fn superscript(c: char) -> char {
    match c {
        '-' => '⁻',
        '0' => '⁰',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit @ '4'..='9' => char::from_u32(digit as u32 - '4' as u32 + '⁴' as u32).unwrap_or(digit),
        other => other,
    }
}
