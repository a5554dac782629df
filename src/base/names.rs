//! Names that users type, and names in messages: lists, suggestions, escapes.

/// Most compared names: lists in files may be longer.
const NAMES_COMPARED: usize = 500;

/// Finds the most similar name (Damerau-Levenshtein) of which at most half differs.
pub fn nearest<'n>(wrong: &str, names: &[&'n str]) -> Option<&'n str> {
    let length = wrong.chars().count();
    // Skips names of very different length; a name may be as long as its file.
    let is_as_long = |name: &&&str| {
        let other = name.chars().count();
        length.max(other) <= 2 * length.min(other)
    };
    names
        .iter()
        .take(NAMES_COMPARED)
        .filter(is_as_long)
        .map(|name| {
            (
                strsim::normalized_damerau_levenshtein(&wrong.to_lowercase(), name),
                *name,
            )
        })
        .filter(|(similarity, _)| *similarity >= 0.5)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}

/// A list whose entries users choose by name.
pub trait Listed: 'static {
    /// Word for one entry: "sequence".
    const WHAT: &'static str;

    /// Where a user finds all names, if they are many: "a name of `program list sequences`".
    const LISTED_IN: Option<&'static str> = None;

    /// Lists every entry, the default first.
    fn all() -> impl Iterator<Item = &'static Self> + Clone;

    /// Name in files, on the command line and in tables.
    fn name(&self) -> &'static str;

    fn names() -> Vec<&'static str> {
        Self::all().map(Self::name).collect()
    }

    fn by_name(name: &str) -> Option<&'static Self> {
        Self::all().find(|entry| entry.name() == name)
    }

    /// Finds an entry; the error suggests the nearest one.
    fn parse(name: &str) -> Result<&'static Self, String> {
        Self::by_name(name)
            .ok_or_else(|| not_listed(Self::WHAT, name, &Self::names(), "", Self::LISTED_IN))
    }

    /// Finds an entry whose name was checked before. Panics on other names.
    fn listed(name: &str) -> &'static Self {
        Self::by_name(name).unwrap_or_else(|| panic!("{name:?} is not a listed {}", Self::WHAT))
    }
}

/// Implements [`Listed`] for slice entries with a field `name` (and their own `by_name`), or for an
/// enum's variants.
macro_rules! listed {
    ($entry:ty, $what:literal, $list:path $(, $($by_name:tt)+)?) => {
        impl crate::base::names::Listed for $entry {
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
        impl crate::base::names::Listed for $choice {
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

pub fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

/// Writes a name in words: `level_mapping` as "Level mapping".
pub fn in_words(name: &str) -> String {
    capitalised(&name.replace(['_', '-'], " "))
}

/// Writes "a camera", "an axis".
pub fn with_article(what: &str) -> String {
    let begins_with_vowel = what.starts_with(['a', 'e', 'i', 'o', 'u']);
    let article = if begins_with_vowel { "an" } else { "a" };
    format!("{article} {what}")
}

/// Reports an unlisted name with the nearest one, or with `or` and the expected names.
pub fn not_one_of(what: &str, text: &str, names: &[&str], or: &str) -> String {
    not_listed(what, text, names, or, None)
}

/// As [`not_one_of`]; a long list is replaced by `listed_in`, where a user finds it.
pub fn not_listed(
    what: &str,
    text: &str,
    names: &[&str],
    or: &str,
    listed_in: Option<&str>,
) -> String {
    let near = suggestion(text, names);
    let hint = if near.is_empty() {
        format!("; expected {or}{}", expected(names, listed_in))
    } else {
        near
    };
    format!("{text:?} is not {}{hint}", with_article(what))
}

/// Longest list of names in a message.
pub const NAMES_SHOWN: usize = 12;

/// Lists the expected names. A long list is replaced by `listed_in`, where a user finds it, or cut.
pub fn expected(names: &[&str], listed_in: Option<&str>) -> String {
    if names.len() < 2 {
        return names.first().unwrap_or(&"none").to_string();
    }
    if names.len() <= NAMES_SHOWN {
        return format!("one of {}", names.join(", "));
    }
    listed_in.map_or_else(
        || {
            let shown = names[..NAMES_SHOWN].join(", ");
            format!("one of {shown} and {} more", names.len() - NAMES_SHOWN)
        },
        str::to_owned,
    )
}

/// Writes `; did you mean "x"?` for the [`nearest`] of `names`, or nothing.
pub fn suggestion(wrong: &str, names: &[&str]) -> String {
    nearest(wrong, names).map_or_else(String::new, |name| format!("; did you mean {name:?}?"))
}

/// Escapes control and bidirectional characters, which a terminal would obey.
pub fn printable(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_control() || BIDIRECTIONAL_CONTROLS.contains(&c) {
            shown.extend(c.escape_default());
        } else {
            shown.push(c);
        }
    }
    shown
}

/// Invisible characters that change the order of others (UAX 9, section 2).
const BIDIRECTIONAL_CONTROLS: [char; 12] = [
    '\u{061c}', '\u{200e}', '\u{200f}', '\u{202a}', '\u{202b}', '\u{202c}', '\u{202d}', '\u{202e}',
    '\u{2066}', '\u{2067}', '\u{2068}', '\u{2069}',
];
