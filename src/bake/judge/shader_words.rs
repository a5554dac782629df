//! Words of the errors of a shader.

use super::shader::{ErrorKind, PerError, ShaderVerdict, View, WorstError, WorstLocation};
use std::fmt;

impl ErrorKind {
    pub fn name(self) -> &'static str {
        match self {
            Self::Gain => "gain",
            Self::Width => "width",
            Self::Direction => "direction",
        }
    }

    pub fn unit(self) -> &'static str {
        match self {
            Self::Gain | Self::Width => "%",
            Self::Direction => "degrees",
        }
    }
}

impl View {
    fn in_words(&self, kind: ErrorKind) -> String {
        let error = self.errors.get(kind);
        let size = error.abs();
        let is_positive = error > 0.0;
        match kind {
            ErrorKind::Gain => {
                let side = if is_positive { "bright" } else { "dark" };
                format!("{:.1} % too {side}", 100.0 * size)
            }
            ErrorKind::Width => {
                let side = if is_positive { "blurred" } else { "sharp" };
                format!(
                    "the level is too {side} (as of alpha {:.2} for {:.2})",
                    self.alpha, self.right_alpha
                )
            }
            ErrorKind::Direction if size > 90.0 => format!(
                "looks away from the lobe, by {size:.1} degrees: check the signs of v and n"
            ),
            ErrorKind::Direction => {
                let side = if is_positive {
                    "mirror direction"
                } else {
                    "normal"
                };
                format!("direction {size:.1} degrees towards the {side}")
            }
        }
    }
}

impl fmt::Display for WorstError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match &self.location {
            WorstLocation::EverySurface(gain) => write!(f, "{gain} at every alpha and f0"),
            WorstLocation::Surface {
                alpha,
                f0,
                view,
                least,
            } => {
                write!(f, "{} at alpha {alpha}, f0 {f0}", view.in_words(self.kind))?;
                let Some(least) = least else {
                    return Ok(());
                };
                let least = self.kind.scale() * least;
                let unit = self.kind.unit();
                write!(f, " (at least {least:.1} {unit} off at every alpha and f0)")
            }
        }
    }
}

impl fmt::Display for ShaderVerdict {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::WithoutLight => f.write_str(
                "wrong: the light's direction has no effect; does the function look up the map?",
            ),
            Self::Good(PerError {
                gain,
                width,
                direction,
            }) => write!(
                f,
                "good: gain within {:.1} %, width {:.1} %, direction {:.1} degrees",
                ErrorKind::Gain.scale() * gain,
                ErrorKind::Width.scale() * width,
                ErrorKind::Direction.scale() * direction
            ),
            Self::Wrong(errors) => {
                let errors: Vec<String> = errors.iter().map(WorstError::to_string).collect();
                write!(f, "wrong: {}", errors.join("; "))
            }
        }
    }
}
