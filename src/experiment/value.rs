//! Values in a file or on the command line, and their checks.

pub use super::number::{COORDINATE, Range, Raw};

use super::number::number;
use crate::base::glsl::constants;
use crate::base::names::{Listed, NAMES_SHOWN, not_listed, not_one_of, with_article};
use crate::base::numbers::round_to_significant;
use crate::instrument::shade::FILE_PREFIX;
use std::fmt;
use std::hash::{Hash, Hasher};
use std::sync::Arc;

/// A checked value. Tables, cell ids and `--set` use its `Display` text.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Not set: the scene's own material applies, or the method does not use the parameter. Empty
    /// in tables.
    Unset,
    Number(f64),
    Count(u32),
    /// Linear RGB.
    Color([f32; 3]),
    /// Width and height, or another pair of counts.
    Pair([u32; 2]),
    /// A listed name or the name of an input; shared by all cells of a plan.
    Text(Arc<String>),
}

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        text.to_owned().into()
    }
}

impl From<String> for Value {
    fn from(text: String) -> Self {
        Self::Text(Arc::new(text))
    }
}

/// No range contains a NaN.
impl Eq for Value {}

impl Hash for Value {
    fn hash<H: Hasher>(&self, state: &mut H) {
        std::mem::discriminant(self).hash(state);
        // Equal zeros need equal hashes.
        match self {
            Self::Unset => {}
            Self::Number(x) => (x + 0.0).to_bits().hash(state),
            Self::Count(n) => n.hash(state),
            Self::Color(c) => c.map(|x| (x + 0.0).to_bits()).hash(state),
            Self::Pair(p) => p.hash(state),
            Self::Text(text) => text.hash(state),
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Unset => Ok(()),
            Self::Number(x) => write!(f, "{x}"),
            Self::Count(n) => write!(f, "{n}"),
            Self::Color([r, g, b]) if r == g && g == b => write!(f, "{r}"),
            Self::Color([r, g, b]) => write!(f, "{r}:{g}:{b}"),
            Self::Pair([w, h]) => write!(f, "{w}x{h}"),
            Self::Text(text) => f.write_str(text),
        }
    }
}

impl Value {
    pub fn is_zero(&self) -> bool {
        [Self::Number(0.0), Self::Color([0.0; 3])].contains(self)
    }

    /// Returns a number, a count, the product of a pair or a grey; `None` for names and colours.
    pub fn size(&self) -> Option<f64> {
        match self {
            Self::Number(x) => Some(*x),
            Self::Count(n) => Some(f64::from(*n)),
            Self::Pair([w, h]) => Some(f64::from(*w) * f64::from(*h)),
            Self::Color([r, g, b]) if r == g && g == b => Some(f64::from(*r)),
            _ => None,
        }
    }

    /// # Panics
    ///
    /// This and the next functions panic if the value has another kind than their axis or flag.
    pub fn number(&self) -> f64 {
        let Self::Number(x) = self else {
            self.is_not("a number")
        };
        *x
    }

    pub fn count(&self) -> u32 {
        let Self::Count(n) = self else {
            self.is_not("a count")
        };
        *n
    }

    pub fn color(&self) -> [f32; 3] {
        let Self::Color(c) = self else {
            self.is_not("a colour")
        };
        *c
    }

    pub fn pair(&self) -> [u32; 2] {
        let Self::Pair(p) = self else {
            self.is_not("a pair")
        };
        *p
    }

    pub fn text(&self) -> &str {
        let Self::Text(text) = self else {
            self.is_not("a name")
        };
        text
    }

    fn is_not(&self, what: &str) -> ! {
        panic!("{self:?} is not {what}: its axis has another kind")
    }
}

/// Parses command-line text as a number if it is one.
fn from_text(text: &str) -> Raw {
    match (text.parse::<i64>(), text.parse::<f64>()) {
        (Ok(n), _) => Raw::Integer(n),
        (_, Ok(x)) => Raw::Float(x),
        _ => Raw::String(text.to_owned()),
    }
}

#[derive(Clone, Copy, Debug)]
pub enum Kind {
    Number(Range),
    /// A whole number in `[min, max]`.
    Count {
        min: u32,
        max: u32,
    },
    /// `x` for grey or `[r, g, b]`. As text: `x`, `r:g:b` or `r,g,b`.
    Color(Range),
    /// Two whole numbers in `[min, max]`; one number means both. As text: `WxH`.
    Pair {
        min: u32,
        max: u32,
    },
    /// A listed name; `what` is the word for one, `listed_in` where a user finds a long list.
    Name {
        what: &'static str,
        names: fn() -> Vec<&'static str>,
        listed_in: Option<&'static str>,
    },
    /// A listed name, or [`FILE_PREFIX`] and the path of a file, which is checked on loading.
    NameOrFile {
        what: &'static str,
        names: fn() -> Vec<&'static str>,
        listed_in: Option<&'static str>,
    },
    /// A listed name, or a list of numbers, whose name has colons between them. As text:
    /// `0:0.5:1`.
    NameOrList {
        what: &'static str,
        names: fn() -> Vec<&'static str>,
        /// Checks a list.
        name_of: fn(&[f64]) -> Result<&'static str, String>,
        /// How a user writes one: "r:r:r".
        form: &'static str,
    },
    /// A number, or a name for one. The value is always the number.
    NumberOrName {
        range: Range,
        what: &'static str,
        named: fn() -> Vec<(&'static str, f64)>,
    },
    /// A built-in name or the path of a file, which is checked on loading.
    Input,
}

/// Narrowest lobe that the device shades. Smaller values are refused; materials of files are raised
/// to it.
pub const ALPHA_MIN: f64 = 1e-3;
const _: () = assert!(ALPHA_MIN as f32 == constants::ALPHA_MIN);
/// Square root of [`ALPHA_MIN`].
pub const PERCEPTUAL_ROUGHNESS_MIN: f64 = 0.0316227766016838;

/// Sides of an image; devices of the last ten years support 16384.
pub const IMAGE_SIZE: Kind = Kind::Pair { min: 1, max: 16384 };

/// Rounds to 15 digits, so that 0.1 + 0.2 is 0.3 and 0.7 squared is 0.49.
pub fn decimal(number: f64) -> f64 {
    round_to_significant(number, 15)
}

impl Kind {
    pub const fn one_of<T: Listed + ?Sized>() -> Self {
        Self::Name {
            what: T::WHAT,
            names: T::names,
            listed_in: T::LISTED_IN,
        }
    }

    /// Parses a value; the error contains it and the expected values.
    pub fn parse(&self, raw: &Raw) -> Result<Value, String> {
        match self {
            Self::Number(range) => range.parse(raw).map(Value::Number),
            Self::Count { min, max } => parse_count(raw, *min, *max).map(Value::Count),
            Self::Color(range) => parse_color(raw, range).map(Value::Color),
            Self::Pair { min, max } => parse_pair(raw, *min, *max).map(Value::Pair),
            Self::Name {
                what,
                names,
                listed_in,
            } => parse_name(raw, what, &names(), *listed_in, false),
            Self::NameOrFile {
                what,
                names,
                listed_in,
            } => parse_name(raw, what, &names(), *listed_in, true),
            Self::NameOrList {
                what,
                names,
                name_of,
                form,
            } => parse_name_or_list(raw, what, &names(), *name_of, form).map(Value::from),
            Self::NumberOrName { range, what, named } => {
                if let Raw::String(text) = raw {
                    parse_named_number(text, range, what, &named()).map(Value::Number)
                } else {
                    range.parse(raw).map(Value::Number)
                }
            }
            Self::Input => match raw {
                Raw::String(text) if !text.is_empty() => Ok(Value::from(text.as_str())),
                _ => Err(format!(
                    "{raw} is not a builtin's name or a file's path in quotes"
                )),
            },
        }
    }

    /// Parses command-line text in the form that each kind documents.
    pub fn parse_text(&self, text: &str) -> Result<Value, String> {
        let text = text.trim();
        let raw = match self {
            Self::Name { .. } | Self::NameOrFile { .. } | Self::NameOrList { .. } | Self::Input => {
                Raw::String(text.to_owned())
            }
            Self::Color(_) if text.contains([':', ',']) => Raw::Array(
                text.split([':', ','])
                    .map(|part| from_text(part.trim()))
                    .collect(),
            ),
            Self::Pair { .. } if text.contains(['x', 'X']) => Raw::Array(
                text.split(['x', 'X'])
                    .map(|part| from_text(part.trim()))
                    .collect(),
            ),
            _ => from_text(text),
        };
        self.parse(&raw).map_err(|fault| match self {
            Self::Pair { min, max } => {
                format!("{text:?} is not WxH with whole numbers in [{min}, {max}]")
            }
            _ => fault,
        })
    }

    /// Returns the path in a value's text, if it may be a file.
    pub fn path_in<'t>(&self, text: &'t str) -> Option<&'t str> {
        match self {
            Self::Input => Some(text),
            // A `#` precedes the conventions of the file.
            Self::NameOrFile { .. } => text
                .strip_prefix(FILE_PREFIX)
                .map(|path| path.rsplit_once('#').map_or(path, |(path, _)| path)),
            _ => None,
        }
    }

    /// The names, one of which a value must be; empty if other values are allowed.
    pub fn only_names(&self) -> Vec<&'static str> {
        match self {
            Self::Name { names, .. } => names(),
            _ => Vec::new(),
        }
    }

    pub fn describe(&self) -> String {
        match self {
            Self::Number(range) => format!("number in {range}"),
            Self::Count { min, max } => format!("whole number in [{min}, {max}]"),
            Self::Color(range) => format!("one number or three (red, green, blue) in {range}"),
            Self::Pair { min, max } => format!("two whole numbers in [{min}, {max}]"),
            Self::Name { names, .. } | Self::NameOrFile { names, .. }
                if names().len() > NAMES_SHOWN =>
            {
                self.value_name().to_owned()
            }
            Self::Name { names, .. } => names().join(" | "),
            Self::NameOrFile { names, .. } => {
                format!("{} | {FILE_PREFIX}PATH", names().join(" | "))
            }
            Self::NameOrList { names, form, .. } => format!("{} | {form}", names().join(" | ")),
            Self::NumberOrName { range, named, .. } => {
                let names: Vec<&str> = named().iter().map(|(name, _)| *name).collect();
                format!("number in {range} | {}", names.join(" | "))
            }
            Self::Input => "builtin name or file".to_owned(),
        }
    }

    /// Whether values may begin with a minus sign.
    pub fn has_negative(&self) -> bool {
        matches!(self, Self::Number(range) | Self::NumberOrName { range, .. } if range.min < 0.0)
    }

    /// Describes how `--set` takes several numbers.
    pub fn set_form(&self) -> Option<&'static str> {
        match self {
            Self::Color(_) => Some("x or r:g:b"),
            Self::Pair { .. } => Some("WxH"),
            Self::NameOrList { form, .. } => Some(form),
            _ => None,
        }
    }

    /// Returns the placeholder of a flag's value.
    pub fn value_name(&self) -> &'static str {
        match self {
            Self::Number(_) => "X",
            Self::Count { .. } => "N",
            Self::Color(_) => "R,G,B",
            Self::Pair { .. } => "WxH",
            Self::Name { .. } => "NAME",
            Self::NameOrFile { .. } => "NAME|file:PATH",
            Self::NameOrList { .. } => "NAME|LIST",
            Self::NumberOrName { .. } => "X|NAME",
            Self::Input => "NAME|FILE",
        }
    }
}

fn parse_count(raw: &Raw, min: u32, max: u32) -> Result<u32, String> {
    match raw {
        Raw::Integer(n) => count(*n, min, max),
        _ => Err(format!("{raw} is not a whole number in [{min}, {max}]")),
    }
}

fn count(n: i64, min: u32, max: u32) -> Result<u32, String> {
    u32::try_from(n)
        .ok()
        .filter(|n| (min..=max).contains(n))
        .ok_or_else(|| format!("{n} is outside [{min}, {max}]"))
}

fn parse_color(raw: &Raw, range: &Range) -> Result<[f32; 3], String> {
    match raw {
        Raw::Array(items) if items.len() == 3 => {
            let mut color = [0.0; 3];
            for (channel, item) in color.iter_mut().zip(items) {
                *channel = range.parse(item)? as f32;
            }
            Ok(color)
        }
        Raw::Integer(_) | Raw::Float(_) => Ok([range.parse(raw)? as f32; 3]),
        _ => Err(format!(
            "{raw} is not a colour: one number in {range} or [r, g, b]"
        )),
    }
}

fn parse_pair(raw: &Raw, min: u32, max: u32) -> Result<[u32; 2], String> {
    if let Raw::Array(items) = raw
        && let [Raw::Integer(width), Raw::Integer(height)] = items[..]
    {
        return Ok([count(width, min, max)?, count(height, min, max)?]);
    }
    match raw {
        Raw::Integer(side) => count(*side, min, max).map(|side| [side; 2]),
        _ => Err(format!(
            "{raw} is not a pair of whole numbers in [{min}, {max}], such as [256, 128]"
        )),
    }
}

/// Parses a listed name or, if `takes_files`, [`FILE_PREFIX`] and a path.
fn parse_name(
    raw: &Raw,
    what: &str,
    names: &[&str],
    listed_in: Option<&str>,
    takes_files: bool,
) -> Result<Value, String> {
    let Raw::String(text) = raw else {
        return Err(format!(
            "{raw} is not the name of {} in quotes",
            with_article(what)
        ));
    };
    let path = text.strip_prefix(FILE_PREFIX).filter(|_| takes_files);
    if path.is_some_and(|path| !path.is_empty()) || names.contains(&text.as_str()) {
        return Ok(Value::from(text.as_str()));
    }
    let or_file = if takes_files { "file:PATH or " } else { "" };
    Err(not_listed(what, text, names, or_file, listed_in))
}

/// Parses a listed name or a list of numbers: the name of either.
fn parse_name_or_list(
    raw: &Raw,
    what: &str,
    names: &[&str],
    name_of: fn(&[f64]) -> Result<&'static str, String>,
    form: &str,
) -> Result<String, String> {
    let list = |items: &[Raw]| {
        let numbers = items
            .iter()
            .map(|item| number(item).ok_or_else(|| format!("{raw}: {item} is not a number")));
        name_of(&numbers.collect::<Result<Vec<f64>, String>>()?).map(str::to_owned)
    };
    match raw {
        Raw::String(text) if names.contains(&text.as_str()) => Ok(text.clone()),
        Raw::String(text) if text.contains(':') => {
            let parts = text.split(':').map(|part| from_text(part.trim()));
            list(&parts.collect::<Vec<_>>())
        }
        Raw::String(text) => Err(not_one_of(what, text, names, &format!("{form} or "))),
        Raw::Array(items) => list(items),
        _ => Err(format!(
            "{raw} is not the name of {} in quotes, or a list of numbers",
            with_article(what)
        )),
    }
}

/// Finds the number that a name stands for.
fn parse_named_number(
    text: &str,
    range: &Range,
    what: &str,
    named: &[(&str, f64)],
) -> Result<f64, String> {
    if let Some((_, number)) = named.iter().find(|(name, _)| *name == text) {
        return Ok(*number);
    }
    let names: Vec<&str> = named.iter().map(|(name, _)| *name).collect();
    Err(not_one_of(
        what,
        text,
        &names,
        &format!("a number in {range}, or "),
    ))
}
