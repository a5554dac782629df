//! Maps data to pixels; ticks of an axis.

use super::ScaleKind;

/// A scale along a length of the figure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    is_log: bool,
    /// Number of steps; 0 for numbers.
    steps: usize,
    lo: f64,
    hi: f64,
    from: f64,
    to: f64,
}

/// Tolerance at the ends of the domain.
const ROUNDING: f64 = 1e-9;
/// Widens an empty domain.
const WIDENING: f64 = 2.0;

impl Axis {
    /// `from` and `to` are the ends in pixels.
    pub fn new(kind: &ScaleKind, from: f64, to: f64) -> Self {
        let (is_log, steps, lo, hi) = match kind {
            ScaleKind::Linear { lo, hi } => (false, 0, *lo, *hi),
            ScaleKind::Log { lo, hi } => (true, 0, *lo, *hi),
            ScaleKind::Steps(names) => (
                false,
                names.len().max(1),
                -0.5,
                names.len().max(1) as f64 - 0.5,
            ),
        };
        let (lo, hi) = match is_log {
            true if lo > 0.0 && hi > lo && hi.is_finite() => (lo, hi),
            true if hi > 0.0 && hi.is_finite() => (hi / WIDENING, hi * WIDENING),
            true => (1.0 / WIDENING, WIDENING),
            false if hi > lo && (hi - lo).is_finite() => (lo, hi),
            false if lo.is_finite() => (lo - 0.5, lo + 0.5),
            false => (0.0, 1.0),
        };
        Self {
            is_log,
            steps,
            lo,
            hi,
            from,
            to,
        }
    }

    pub fn domain(&self) -> [f64; 2] {
        [self.lo, self.hi]
    }

    /// Pixels from one step to the next.
    pub fn step(&self) -> f64 {
        (self.to - self.from).abs() / self.steps.max(1) as f64
    }

    pub fn has_steps(&self) -> bool {
        self.steps > 0
    }

    /// 0 at the start of the domain, 1 at its end; -∞ for a logarithm of 0 or less.
    pub fn share(&self, value: f64) -> f64 {
        match self.is_log {
            true if value <= 0.0 => f64::NEG_INFINITY,
            true => (value.ln() - self.lo.ln()) / (self.hi.ln() - self.lo.ln()),
            false => (value - self.lo) / (self.hi - self.lo),
        }
    }

    /// Pixels, clamped to the ends; NaN for NaN.
    pub fn at(&self, value: f64) -> f64 {
        self.from + self.share(value).clamp(0.0, 1.0) * (self.to - self.from)
    }

    /// -1 below the domain, 1 above it, 0 within.
    pub fn beyond(&self, value: f64) -> f64 {
        let share = self.share(value);
        f64::from(u8::from(share > 1.0 + ROUNDING)) - f64::from(u8::from(share < -ROUNDING))
    }
}

pub type Tick = (f64, String);

/// About the most labels.
const LABELS: f64 = 8.0;
/// Fewer labels do not show the scale.
const LABELS_LEAST: usize = 3;
/// Exponents of the smallest and largest f64.
const EXPONENTS: std::ops::RangeInclusive<i32> = -323..=308;

/// The densest round ticks that `fits` accepts. `tried` are the data; powers of two are labelled as
/// such.
pub fn ticks(kind: &ScaleKind, tried: &[f64], fits: impl Fn(&[Tick]) -> bool) -> Vec<Tick> {
    let [lo, hi] = Axis::new(kind, 0.0, 1.0).domain();
    let candidates = match kind {
        ScaleKind::Steps(_) => Vec::new(),
        ScaleKind::Linear { .. } => linear(lo, hi),
        ScaleKind::Log { .. } => powers_of_two(lo, hi, tried)
            .into_iter()
            .chain(decades(lo, hi))
            .chain(linear(lo, hi))
            .collect(),
    };
    // Whole numbers are counts.
    let is_whole = |value: f64| value.fract() == 0.0;
    let are_counts = !tried.is_empty() && tried.iter().all(|value| is_whole(*value));
    let is_count = |ticks: &[Tick]| !are_counts || ticks.iter().all(|tick| is_whole(tick.0));
    let fitting: Vec<Vec<Tick>> = candidates
        .into_iter()
        .filter(|ticks| is_count(ticks) && fits(ticks))
        .collect();
    let best = fitting.iter().find(|ticks| ticks.len() >= LABELS_LEAST);
    best.or_else(|| fitting.iter().max_by_key(|ticks| ticks.len()))
        .cloned()
        .unwrap_or_default()
}

/// Ticks at powers of two as far apart as the data, at every second, and so on; none for other
/// data.
fn powers_of_two(lo: f64, hi: f64, tried: &[f64]) -> Vec<Vec<Tick>> {
    let is_power = |value: &f64| *value >= 1.0 && value.is_finite() && value.log2().fract() == 0.0;
    let mut exponents: Vec<i32> = tried
        .iter()
        .filter(|value| is_power(value))
        .map(|value| value.log2() as i32)
        .collect();
    exponents.sort_unstable();
    let step = exponents
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|step| *step > 0)
        .min();
    let Some(step) = step.filter(|_| exponents.len() == tried.len()) else {
        return Vec::new();
    };
    let (first, last) = (lo.log2().ceil().max(0.0) as i32, hi.log2().floor() as i32);
    let every = |by: i32| {
        let own = (first..=last).filter(|exponent| (exponent - exponents[0]) % (by * step) == 0);
        labelled(
            &own.map(|exponent| f64::from(exponent).exp2())
                .collect::<Vec<f64>>(),
            Some(0),
        )
    };
    (1..=POWERS_LEFT_OUT).map(every).collect()
}

/// At least one in this many powers of two has a label.
const POWERS_LEFT_OUT: i32 = 4;

/// Ticks of a logarithmic axis, dense to sparse.
fn decades(lo: f64, hi: f64) -> Vec<Vec<Tick>> {
    let digits: [&[i64]; 3] = [&[1, 2, 5], &[1, 3], &[1]];
    let dense = digits
        .into_iter()
        .map(|digits| multiples(lo, hi, digits, 1));
    let sparse = (2..=EXPONENTS.end() / 2).map(|by| multiples(lo, hi, &[1], by));
    dense
        .chain(sparse)
        .take_while(|values| !values.is_empty())
        .map(|values| labelled(&values, None))
        .collect()
}

/// `digit 10^e` in the domain, for every `by`th exponent.
fn multiples(lo: f64, hi: f64, digits: &[i64], by: i32) -> Vec<f64> {
    let (first, last) = (lo.log10().floor() as i32, hi.log10().ceil() as i32);
    let exponents = (first.max(*EXPONENTS.start())..=last.min(*EXPONENTS.end()))
        .filter(|e| e.rem_euclid(by) == 0);
    let all = exponents.flat_map(|e| digits.iter().map(move |digit| decimal(*digit, e)));
    all.filter(|value| (lo * (1.0 - ROUNDING)..=hi * (1.0 + ROUNDING)).contains(value))
        .collect()
}

/// The f64 nearest to `whole 10^e`.
fn decimal(whole: i64, e: i32) -> f64 {
    format!("{whole}e{e}").parse().unwrap_or(f64::NAN)
}

/// Ticks of a linear axis, dense to sparse.
fn linear(lo: f64, hi: f64) -> Vec<Vec<Tick>> {
    let least = (hi - lo) / LABELS;
    let first = least.log10().floor() as i32;
    let steps = (first..first + 3).flat_map(|e| [(1, e), (2, e), (5, e)]);
    let of = |(digit, e): (i64, i32)| {
        let step = decimal(digit, e);
        let range = (lo / step - ROUNDING).ceil() as i64..=(hi / step + ROUNDING).floor() as i64;
        labelled(
            &range.map(|i| decimal(i * digit, e)).collect::<Vec<f64>>(),
            Some(e.min(0).unsigned_abs() as usize),
        )
    };
    steps
        .filter(|(digit, e)| decimal(*digit, *e) >= least)
        .map(of)
        .filter(|ticks| !ticks.is_empty())
        .collect()
}

/// Numbers that are not written as powers of ten.
const PLAIN: std::ops::RangeInclusive<f64> = 0.000_999..=999_999.0;

/// Labels values, all with this many decimals or all as powers of ten.
fn labelled(values: &[f64], decimals: Option<usize>) -> Vec<Tick> {
    let is_plain = values
        .iter()
        .all(|value| *value == 0.0 || PLAIN.contains(&value.abs()));
    let label = |value: f64| match decimals {
        _ if !is_plain => power(value),
        // The sum removes the sign of a zero.
        Some(decimals) => format!("{:.decimals$}", value + 0.0).replace('-', "\u{2212}"),
        None => value.to_string(),
    };
    values.iter().map(|value| (*value, label(*value))).collect()
}

/// `10⁻⁴`, `2·10⁵`.
fn power(value: f64) -> String {
    if value == 0.0 || value == 1.0 || value == 10.0 {
        return value.to_string();
    }
    let scientific = format!("{value:e}");
    let (digits, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let raised: String = exponent.chars().map(superscript).collect();
    match digits {
        "1" => format!("10{raised}"),
        _ => format!("{}·10{raised}", digits.replace('-', "\u{2212}")),
    }
}

fn superscript(letter: char) -> char {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    letter
        .to_digit(10)
        .and_then(|digit| DIGITS.get(digit as usize))
        .copied()
        .unwrap_or('⁻')
}
