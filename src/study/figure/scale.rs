//! From data to pixels, and the ticks of an axis.

use super::ScaleKind;

/// A scale along a length of the picture.
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

/// Where a value lies along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Pixels; the border for a value outside of the domain.
    pub at: f64,
    /// -1 below the domain, 1 above it, 0 within.
    pub beyond: i8,
}

/// A value outside of the domain by more shares of it than this is drawn as if it lay there, so that coordinates stay finite.
const FARTHEST: f64 = 2.0;
/// Rounding may move an end of the domain out of it.
const ROUNDING: f64 = 1e-9;
/// What an empty domain is widened by.
const WIDENING: f64 = 2.0;

impl Axis {
    /// `from` and `to` are the pixels of the ends of the domain.
    pub fn new(kind: &ScaleKind, from: f64, to: f64) -> Self {
        let (is_log, steps, lo, hi) = match kind {
            ScaleKind::Linear { lo, hi } => (false, 0, *lo, *hi),
            ScaleKind::Log { lo, hi } => (true, 0, *lo, *hi),
            ScaleKind::Steps(names) => (false, names.len().max(1), -0.5, names.len().max(1) as f64 - 0.5),
        };
        let (lo, hi) = match is_log {
            true if lo > 0.0 && hi > lo && hi.is_finite() => (lo, hi),
            true if hi > 0.0 && hi.is_finite() => (hi / WIDENING, hi * WIDENING),
            true => (1.0 / WIDENING, WIDENING),
            false if hi > lo && (hi - lo).is_finite() => (lo, hi),
            false if lo.is_finite() => (lo - 0.5, lo + 0.5),
            false => (0.0, 1.0),
        };
        Self { is_log, steps, lo, hi, from, to }
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

    /// 0 at the start of the domain, 1 at its end; infinite for what a logarithm does not reach.
    pub fn share(&self, value: f64) -> f64 {
        match self.is_log {
            true if value <= 0.0 => f64::NEG_INFINITY,
            true => (value / self.lo).ln() / (self.hi / self.lo).ln(),
            false => (value - self.lo) / (self.hi - self.lo),
        }
    }

    /// The value at a share; the inverse of [`Axis::share`].
    pub fn value(&self, share: f64) -> f64 {
        match self.is_log {
            true => self.lo * (self.hi / self.lo).powf(share),
            false => self.lo + share * (self.hi - self.lo),
        }
    }

    /// Pixels, outside of the panel for a value outside of the domain; `None` for NaN.
    pub fn open(&self, value: f64) -> Option<f64> {
        let share = self.share(value);
        (!share.is_nan()).then(|| self.from + share.clamp(-FARTHEST, 1.0 + FARTHEST) * (self.to - self.from))
    }

    /// Pixels, at most at the border; `None` for NaN.
    pub fn place(&self, value: f64) -> Option<Place> {
        let share = self.share(value);
        let beyond = if share < -ROUNDING { -1 } else { i8::from(share > 1.0 + ROUNDING) };
        (!share.is_nan()).then(|| Place { at: self.from + share.clamp(0.0, 1.0) * (self.to - self.from), beyond })
    }
}

/// A labelled place of an axis of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    pub value: f64,
    pub label: String,
}

/// About as many labels at most.
const LABELS: f64 = 8.0;
/// An axis with fewer labels does not tell how it runs.
const LABELS_LEAST: usize = 3;
/// Exponents of the smallest and largest f64.
const EXPONENTS: std::ops::RangeInclusive<i32> = -323..=308;

/// The densest round ticks that `fits` accepts. `tried` are the data: powers of two are labelled as such.
pub fn ticks(kind: &ScaleKind, tried: &[f64], fits: impl Fn(&[Tick]) -> bool) -> Vec<Tick> {
    let [lo, hi] = Axis::new(kind, 0.0, 1.0).domain();
    let candidates = match kind {
        ScaleKind::Steps(_) => Vec::new(),
        ScaleKind::Linear { .. } => linear(lo, hi),
        ScaleKind::Log { .. } => {
            powers_of_two(lo, hi, tried).into_iter().chain(decades(lo, hi)).chain(linear(lo, hi)).collect()
        }
    };
    let fitting: Vec<Vec<Tick>> = candidates.into_iter().filter(|ticks| fits(ticks)).collect();
    let best = fitting.iter().find(|ticks| ticks.len() >= LABELS_LEAST);
    best.or_else(|| fitting.iter().max_by_key(|ticks| ticks.len())).cloned().unwrap_or_default()
}

/// The multiples of powers of ten of a logarithmic axis whose labels are such, too.
pub fn minor(kind: &ScaleKind, labelled: &[f64]) -> Vec<f64> {
    let ScaleKind::Log { .. } = kind else { return Vec::new() };
    let has_all_decades = labelled.len() > 1 && labelled.windows(2).all(|pair| pair[1] / pair[0] < 10.5);
    let is_decimal = |value: &f64| format!("{value:e}").split('e').next().is_some_and(|digits| digits.len() == 1);
    if !has_all_decades || !labelled.iter().all(is_decimal) {
        return Vec::new();
    }
    let [lo, hi] = Axis::new(kind, 0.0, 1.0).domain();
    multiples(lo, hi, &[1, 2, 3, 4, 5, 6, 7, 8, 9], 1)
}

/// Ticks at tried powers of two, dense to sparse; nothing where others were tried.
fn powers_of_two(lo: f64, hi: f64, tried: &[f64]) -> Vec<Vec<Tick>> {
    let is_power = |value: &f64| *value >= 1.0 && value.is_finite() && value.log2().fract() == 0.0;
    if !tried.iter().all(is_power) {
        return Vec::new();
    }
    let mut exponents: Vec<i32> = tried.iter().map(|value| value.log2() as i32).collect();
    exponents.sort_unstable();
    exponents.dedup();
    // The largest step that meets all of them.
    let step = exponents.windows(2).fold(0, |step, pair| greatest_divisor(step, pair[1] - pair[0]));
    let (Some(start), 1..) = (exponents.first(), step) else { return Vec::new() };
    let (first, last) = (lo.log2().ceil().max(0.0) as i32, hi.log2().floor() as i32);
    let tick = |exponent: i32| Tick { value: f64::from(exponent).exp2(), label: plain(f64::from(exponent).exp2(), 0) };
    let every = |by: i32| (first..=last).filter(|e| (e - start) % (by * step) == 0).map(tick).collect();
    (1..=EXPONENTS_LEFT_OUT).map(every).collect()
}

/// Each of so many tried powers of two has a label at least.
const EXPONENTS_LEFT_OUT: i32 = 4;

fn greatest_divisor(a: i32, b: i32) -> i32 {
    if b == 0 { a } else { greatest_divisor(b, a % b) }
}

/// Ticks of a logarithmic axis, dense to sparse.
fn decades(lo: f64, hi: f64) -> Vec<Vec<Tick>> {
    let digits: [&[u32]; 3] = [&[1, 2, 5], &[1, 3], &[1]];
    let dense = digits.into_iter().map(|digits| multiples(lo, hi, digits, 1));
    let sparse = (2..=EXPONENTS.end() / 2).map(|by| multiples(lo, hi, &[1], by));
    dense.chain(sparse).take_while(|values| !values.is_empty()).map(|values| labelled(&values)).collect()
}

/// `digit 10^e` within a domain for every `by`th exponent.
fn multiples(lo: f64, hi: f64, digits: &[u32], by: i32) -> Vec<f64> {
    let (first, last) = (lo.log10().floor() as i32, hi.log10().ceil() as i32);
    let exponents = (first.max(*EXPONENTS.start())..=last.min(*EXPONENTS.end())).filter(|e| e.rem_euclid(by) == 0);
    let all = exponents.flat_map(|e| digits.iter().map(move |digit| decimal(*digit, e)));
    all.filter(|value| (lo * (1.0 - ROUNDING)..=hi * (1.0 + ROUNDING)).contains(value)).collect()
}

/// The f64 nearest to `digit 10^e`, which a product is not.
fn decimal(digit: u32, e: i32) -> f64 {
    format!("{digit}e{e}").parse().unwrap_or(f64::NAN)
}

/// Ticks of a linear axis, dense to sparse.
fn linear(lo: f64, hi: f64) -> Vec<Vec<Tick>> {
    let least = (hi - lo) / LABELS;
    let first = least.log10().floor() as i32;
    let steps = (first..first + 3).flat_map(|e| [(1, e), (2, e), (5, e)]);
    let of = |(digit, e): (u32, i32)| {
        let step = decimal(digit, e);
        let range = (lo / step - ROUNDING).ceil() as i64..=(hi / step + ROUNDING).floor() as i64;
        let value = |i: i64| {
            // The nearest f64 to the label.
            let whole = i * i64::from(digit);
            format!("{whole}e{e}").parse().unwrap_or(f64::NAN)
        };
        let values: Vec<f64> = range.map(value).collect();
        let is_plain =
            values.iter().all(|value| *value == 0.0 || PLAIN.contains(&value.abs())) && step >= *PLAIN.start();
        let label = |value: f64| if is_plain { plain(value, (-e).max(0) as usize) } else { power(value) };
        values.into_iter().map(|value| Tick { value, label: label(value) }).collect::<Vec<Tick>>()
    };
    steps.filter(|(digit, e)| decimal(*digit, *e) >= least).map(of).filter(|ticks| !ticks.is_empty()).collect()
}

/// Numbers that are written out; smaller and larger ones as powers of ten.
const PLAIN: std::ops::RangeInclusive<f64> = 0.000_999..=99_999.0;

fn labelled(values: &[f64]) -> Vec<Tick> {
    let is_plain = values.iter().all(|value| PLAIN.contains(value));
    let label = |value: f64| if is_plain { value.to_string() } else { power(value) };
    values.iter().map(|value| Tick { value: *value, label: label(*value) }).collect()
}

fn plain(value: f64, decimals: usize) -> String {
    // Without the sign of a zero.
    format!("{:.decimals$}", value + 0.0).replace('-', "\u{2212}")
}

/// `10⁻⁴`, `2·10⁵`, and small whole numbers as they are.
pub fn power(value: f64) -> String {
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
    letter.to_digit(10).and_then(|digit| DIGITS.get(digit as usize)).copied().unwrap_or('⁻')
}
