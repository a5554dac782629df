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

/// A domain that is not empty, in place of any two numbers.
fn linear_domain(lo: f64, hi: f64) -> [f64; 2] {
    if hi > lo && (hi - lo).is_finite() {
        [lo, hi]
    } else if lo.is_finite() {
        [lo - 0.5, lo + 0.5]
    } else {
        [0.0, 1.0]
    }
}

/// As [`linear_domain`], of positive numbers.
fn log_domain(lo: f64, hi: f64) -> [f64; 2] {
    if lo > 0.0 && hi > lo && hi.is_finite() {
        [lo, hi]
    } else if hi > 0.0 && hi.is_finite() {
        [hi / WIDENING, hi * WIDENING]
    } else {
        [1.0 / WIDENING, WIDENING]
    }
}

impl Axis {
    /// `from` and `to` are the ends in pixels.
    pub fn new(kind: &ScaleKind, from: f64, to: f64) -> Self {
        let is_log = matches!(kind, ScaleKind::Log { .. });
        let steps = match kind {
            ScaleKind::Steps(names) => names.len().max(1),
            _ => 0,
        };
        let [lo, hi] = match *kind {
            ScaleKind::Linear { lo, hi } => linear_domain(lo, hi),
            ScaleKind::Log { lo, hi } => log_domain(lo, hi),
            ScaleKind::Steps(_) => [-0.5, steps as f64 - 0.5],
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
        if !self.is_log {
            (value - self.lo) / (self.hi - self.lo)
        } else if value <= 0.0 {
            f64::NEG_INFINITY
        } else {
            (value.ln() - self.lo.ln()) / (self.hi.ln() - self.lo.ln())
        }
    }

    /// Pixels, clamped to the ends; NaN for NaN.
    pub fn pixel(&self, value: f64) -> f64 {
        self.from + self.share(value).clamp(0.0, 1.0) * (self.to - self.from)
    }

    /// The side on which a value leaves the domain: -1 below, 1 above, 0 within.
    pub fn outside(&self, value: f64) -> f64 {
        let share = self.share(value);
        f64::from(u8::from(share > 1.0 + ROUNDING)) - f64::from(u8::from(share < -ROUNDING))
    }
}

/// A labelled value on an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    pub value: f64,
    pub label: String,
}

/// About the most labels.
const LABELS: f64 = 8.0;
/// Fewer labels do not show the scale.
const LABELS_LEAST: usize = 3;
/// Exponents of the smallest and largest f64.
const EXPONENTS: std::ops::RangeInclusive<i32> = -323..=308;

/// The densest round ticks that `has_room` accepts. `data` are the values of the marks; powers of
/// two are labelled as such.
pub fn ticks(kind: &ScaleKind, data: &[f64], has_room: impl Fn(&[Tick]) -> bool) -> Vec<Tick> {
    let [lo, hi] = Axis::new(kind, 0.0, 1.0).domain();
    let candidates = match kind {
        ScaleKind::Steps(_) => Vec::new(),
        ScaleKind::Linear { .. } => linear(lo, hi),
        ScaleKind::Log { .. } => powers_of_two(lo, hi, data)
            .into_iter()
            .chain(decades(lo, hi))
            .chain(linear(lo, hi))
            .collect(),
    };
    // Whole numbers are counts: between them a tick would mean nothing.
    let is_whole = |value: f64| value.fract() == 0.0;
    let are_counts = !data.is_empty() && data.iter().all(|value| is_whole(*value));
    let accepted: Vec<Vec<Tick>> = candidates
        .into_iter()
        .filter(|ticks| !are_counts || ticks.iter().all(|tick| is_whole(tick.value)))
        .filter(|ticks| has_room(ticks))
        .collect();
    let dense_enough = accepted.iter().find(|ticks| ticks.len() >= LABELS_LEAST);
    dense_enough
        .or_else(|| accepted.iter().max_by_key(|ticks| ticks.len()))
        .cloned()
        .unwrap_or_default()
}

/// The exponent of a power of two from 1 on; `None` for other numbers.
fn exponent_of_two(value: f64) -> Option<i32> {
    let is_power = value >= 1.0 && value.is_finite() && value.log2().fract() == 0.0;
    is_power.then(|| value.log2() as i32)
}

/// Ticks at powers of two as far apart as the data, at every second, and so on; none for other
/// data.
fn powers_of_two(lo: f64, hi: f64, data: &[f64]) -> Vec<Vec<Tick>> {
    let exponents: Option<Vec<i32>> = data.iter().map(|value| exponent_of_two(*value)).collect();
    let Some(mut exponents) = exponents else {
        return Vec::new();
    };
    exponents.sort_unstable();
    let step = exponents
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|step| *step > 0)
        .min();
    let Some(step) = step else {
        return Vec::new();
    };
    let first = lo.log2().ceil().max(0.0) as i32;
    let last = hi.log2().floor() as i32;
    let mut candidates = Vec::new();
    for every in 1..=POWERS_LEFT_OUT {
        let powers: Vec<f64> = (first..=last)
            .filter(|exponent| (exponent - exponents[0]) % (every * step) == 0)
            .map(|exponent| f64::from(exponent).exp2())
            .collect();
        candidates.push(labelled(&powers, Some(0)));
    }
    candidates
}

/// At least one in this many powers of two has a label.
const POWERS_LEFT_OUT: i32 = 4;

/// Ticks of a logarithmic axis, dense to sparse.
fn decades(lo: f64, hi: f64) -> Vec<Vec<Tick>> {
    let digits: [&[i64]; 3] = [&[1, 2, 5], &[1, 3], &[1]];
    let dense = digits
        .into_iter()
        .map(|digits| multiples(lo, hi, digits, 1));
    let sparse = (2..=EXPONENTS.end() / 2).map(|every| multiples(lo, hi, &[1], every));
    dense
        .chain(sparse)
        .take_while(|values| !values.is_empty())
        .map(|values| labelled(&values, None))
        .collect()
}

/// `digit 10^e` in the domain, for the exponents that `every` divides.
fn multiples(lo: f64, hi: f64, digits: &[i64], every: i32) -> Vec<f64> {
    let first = (lo.log10().floor() as i32).max(*EXPONENTS.start());
    let last = (hi.log10().ceil() as i32).min(*EXPONENTS.end());
    (first..=last)
        .filter(|e| e.rem_euclid(every) == 0)
        .flat_map(|e| digits.iter().map(move |digit| decimal(*digit, e)))
        .filter(|value| (lo * (1.0 - ROUNDING)..=hi * (1.0 + ROUNDING)).contains(value))
        .collect()
}

/// The f64 nearest to `whole 10^e`.
fn decimal(whole: i64, e: i32) -> f64 {
    format!("{whole}e{e}").parse().unwrap_or(f64::NAN)
}

/// Ticks of a linear axis, dense to sparse.
fn linear(lo: f64, hi: f64) -> Vec<Vec<Tick>> {
    let least_step = (hi - lo) / LABELS;
    let first = least_step.log10().floor() as i32;
    let mut candidates = Vec::new();
    for e in first..first + 3 {
        for digit in [1, 2, 5] {
            let step = decimal(digit, e);
            if step < least_step {
                continue;
            }
            let from = (lo / step - ROUNDING).ceil() as i64;
            let to = (hi / step + ROUNDING).floor() as i64;
            let values: Vec<f64> = (from..=to).map(|i| decimal(i * digit, e)).collect();
            if !values.is_empty() {
                candidates.push(labelled(&values, Some(e.min(0).unsigned_abs() as usize)));
            }
        }
    }
    candidates
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
    values
        .iter()
        .map(|&value| Tick {
            value,
            label: label(value),
        })
        .collect()
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

#[cfg(test)]
mod tests;
