//! Numbers as text, and rounded: every decimal rounding of the program.

use std::borrow::Cow;

/// Decimal exponents of numbers that [`significant`] writes without an exponent.
const FIXED_EXPONENTS: std::ops::Range<i32> = -4..6;

/// Writes a number to `digits` significant digits (at least 1), for people: `0.0123`, `1.50`,
/// `1.23e-7`, `inf`. Digits before the decimal point stay: `1234`.
pub fn significant(number: f64, digits: usize) -> String {
    if number == 0.0 {
        return "0".to_owned();
    }
    if !number.is_finite() {
        return number.to_string();
    }
    let decimals = digits.max(1) - 1;
    // Rounded first: 0.9996 to three digits is 1.00.
    let scientific = format!("{number:.decimals$e}");
    let exponent: i32 = scientific
        .split_once('e')
        .and_then(|(_, exponent)| exponent.parse().ok())
        .expect("the exponent format of a finite number ends in e and an integer");
    if FIXED_EXPONENTS.contains(&exponent) {
        let decimals = (decimals as i32 - exponent).max(0) as usize;
        format!("{number:.decimals$}")
    } else {
        scientific
    }
}

/// Rounds a number to `digits` significant digits, for tables: the nearest f64 to that decimal.
pub fn round_to_significant(number: f64, digits: usize) -> f64 {
    // The exponent form counts significant digits.
    format!("{number:.*e}", digits - 1)
        .parse()
        .expect("a number reads back")
}

/// Numbers from here on are written with an exponent.
const EXPONENT_FROM: f64 = 1e16;
/// Smallest magnitude that is written without an exponent.
const EXPONENT_BELOW: f64 = 1e-5;

/// Writes the shortest text that reads back to the same number.
pub fn shortest(number: f64) -> String {
    let magnitude = number.abs();
    if magnitude == 0.0
        || !magnitude.is_finite()
        || (EXPONENT_BELOW..EXPONENT_FROM).contains(&magnitude)
    {
        number.to_string()
    } else {
        format!("{number:e}")
    }
}

/// Significant digits of [`short_number`].
const SHORT_DIGITS: usize = 4;

/// Shortens the text of a number: `0.223606797749979` to 0.2236. Whole numbers and other text are
/// unchanged.
pub fn short_number(text: &str) -> Cow<'_, str> {
    let Some(number) = text.parse::<f64>().ok().filter(|number| number.is_finite()) else {
        return text.into();
    };
    if text.parse::<i64>().is_ok() {
        return text.into();
    }
    let short = round_to_significant(number, SHORT_DIGITS).to_string();
    if short.len() < text.len() {
        short.into()
    } else {
        text.into()
    }
}

#[cfg(test)]
mod tests;
