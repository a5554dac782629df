//! Names and numbers in messages: what a misspelt one was meant to be, how a hostile one is shown, how a long one is cut.

use std::borrow::Cow;

/// Names that are compared with a misspelt one: the product's own lists are shorter, those of a file may not be.
const NAMES_COMPARED: usize = 500;

/// The nearest of `names` to a misspelt one, where one is near: at most half of the longer word differs (Damerau-Levenshtein), so that noise
/// suggests nothing.
pub fn nearest<'n>(wrong: &str, names: &[&'n str]) -> Option<&'n str> {
    let length = wrong.chars().count();
    // Of names more than twice as long, or less than half, more than half differs: not asked, since a name may be as long as its file.
    let is_as_long = |name: &&&str| {
        let other = name.chars().count();
        length.max(other) <= 2 * length.min(other)
    };
    names
        .iter()
        .take(NAMES_COMPARED)
        .filter(is_as_long)
        .map(|name| (strsim::normalized_damerau_levenshtein(&wrong.to_lowercase(), name), *name))
        .filter(|(similarity, _)| *similarity >= 0.5)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}

/// Something that users choose by name from a list.
pub trait Listed: 'static {
    /// Word for one entry: "sequence".
    const WHAT: &'static str;

    /// Returns every entry, the default first.
    fn all() -> impl Iterator<Item = &'static Self> + Clone;

    /// Name in files, on the command line and in tables.
    fn name(&self) -> &'static str;

    fn names() -> Vec<&'static str> {
        Self::all().map(Self::name).collect()
    }

    fn by_name(name: &str) -> Option<&'static Self> {
        Self::all().find(|entry| entry.name() == name)
    }

    /// Finds the entry of that name; the error suggests the nearest one.
    fn parse(name: &str) -> Result<&'static Self, String> {
        Self::by_name(name).ok_or_else(|| not_one_of(Self::WHAT, name, &Self::names(), ""))
    }

    /// Finds an entry whose name was checked before. Panics on other names.
    fn listed(name: &str) -> &'static Self {
        Self::by_name(name).unwrap_or_else(|| panic!("{name:?} is not a listed {}", Self::WHAT))
    }
}

/// Implements [`Listed`] for the entries of a slice with a field `name`, perhaps with a `by_name` of their own, or for the variants of an enum.
macro_rules! listed {
    ($entry:ty, $what:literal, $list:path $(, $($by_name:tt)+)?) => {
        impl crate::spelling::Listed for $entry {
            const WHAT: &'static str = $what;

            fn all() -> impl Iterator<Item = &'static Self> + Clone {
                $list.iter()
            }

            fn name(&self) -> &'static str {
                self.name
            }

            $($($by_name)+)?
        }
    };
    ($choice:ident, $what:literal, { $($name:literal: $variant:ident $(($part:path))?),+ $(,)? }) => {
        impl crate::spelling::Listed for $choice {
            const WHAT: &'static str = $what;

            fn all() -> impl Iterator<Item = &'static Self> + Clone {
                const ALL: &[$choice] = &[$($choice::$variant $(($part))?),+];
                ALL.iter()
            }

            fn name(&self) -> &'static str {
                match self {
                    $($choice::$variant $(($part))? => $name),+
                }
            }
        }
    };
}
pub(crate) use listed;

/// "a camera", "an axis".
pub fn with_article(what: &str) -> String {
    format!("{} {what}", if what.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" })
}

/// Says that `text` names none of `names`; `or` lists what else is accepted.
pub fn not_one_of(what: &str, text: &str, names: &[&str], or: &str) -> String {
    format!("{text:?} is not {}{}; expected {or}{}", with_article(what), suggestion(text, names), names.join(", "))
}

/// `; did you mean "x"?` for the [`nearest`] of `names`, or nothing.
pub fn suggestion(wrong: &str, names: &[&str]) -> String {
    nearest(wrong, names).map_or_else(String::new, |name| format!("; did you mean {name:?}?"))
}

/// `text` with its control characters, and those that turn the direction of writing, written as escapes: names come from files of anyone's
/// making, and a terminal obeys what it shows.
pub fn printable(text: &str) -> String {
    text.chars().fold(String::with_capacity(text.len()), |mut shown, c| {
        if c.is_control() || TURNS.contains(&c) {
            shown.extend(c.escape_default())
        } else {
            shown.push(c)
        }
        shown
    })
}

/// Characters without a shape that change the order in which others are shown [Unicode bidirectional algorithm, UAX 9, section 2].
const TURNS: [char; 12] = [
    '\u{061c}', '\u{200e}', '\u{200f}', '\u{202a}', '\u{202b}', '\u{202c}', '\u{202d}', '\u{202e}', '\u{2066}',
    '\u{2067}', '\u{2068}', '\u{2069}',
];

/// Digits that tell values of an axis apart for a person.
const DIGITS: usize = 4;

/// A number as people read it: `0.223606797749979` is 0.2236. Other text, and numbers that are as short already, stay as they are.
pub fn short_number(text: &str) -> Cow<'_, str> {
    let Some(number) = text.parse::<f64>().ok().filter(|number| number.is_finite()) else { return text.into() };
    if text.parse::<i64>().is_ok() {
        return text.into();
    }
    // Through the exponent form, which counts digits from the first that is not 0.
    let rounded: f64 = format!("{number:.*e}", DIGITS - 1).parse().unwrap_or(number);
    let short = rounded.to_string();
    if short.len() < text.len() { short.into() } else { text.into() }
}
