//! Checks the cells of one row of queries.

use super::{ALPHA_MIN, Anisotropy, Coat, F0_COLUMN, IOR_COLUMN, Integral, Kind, Sheen};
use crate::base::math::frame::east;
use crate::base::names::Listed;
use crate::instrument::brdf::{
    Brdf, IOR_MAX, MaskingShadowing, SHEEN_ALPHA_MIN, Stretch, WidthLaw, f0_from_ior,
};
use crate::instrument::precompute::PrecomputeSettings;
use crate::instrument::precompute::prefilter::{Kernel, Weight};
use crate::instrument::shade::reference::Surface;
use glam::DVec3;

/// Largest deviation of a direction's length from 1, below which it is normalised: five digits
/// suffice.
pub const LENGTH_TOLERANCE: f64 = 1e-5;

#[derive(Debug)]
pub(super) struct Fault {
    pub(super) line: u64,
    /// Empty if the whole line is meant.
    pub(super) column: String,
    pub(super) what: String,
}

const LEVELS: std::ops::RangeInclusive<u32> = 2..=12;

pub(super) struct Row<'a> {
    pub(super) line: u64,
    pub(super) columns: &'a [String],
    pub(super) record: &'a ::csv::StringRecord,
    pub(super) faults: Vec<Fault>,
}

impl Row<'_> {
    /// Returns the row's integral; `None` after a fault.
    pub(super) fn integral(&mut self, kind: Kind) -> Option<Integral> {
        match kind {
            Kind::Shading | Kind::Ladder => self.lit_point(kind),
            Kind::Dfg => self.dfg(),
            Kind::Prefilter => self.prefilter(),
            Kind::Irradiance => self
                .direction(["nx", "ny", "nz"])
                .map(|n| Integral::Irradiance { n }),
            Kind::Sh9 => Some(Integral::Sh9),
        }
    }

    // All cells are checked before any is used, so that a row reports all its faults.

    fn lit_point(&mut self, kind: Kind) -> Option<Integral> {
        let model = self.model();
        let masking = self.masking();
        let alpha = self.alpha("alpha");
        let levels = self.levels();
        let coat = self.coat();
        let sheen = self.sheen();
        let anisotropy = self.anisotropy();
        let f0 = self.f0();
        let n = self.direction(["nx", "ny", "nz"]);
        let v = self.direction(["vx", "vy", "vz"]);
        if let (Some(n), Some(v)) = (n, v)
            && n.dot(v) <= 0.0
        {
            self.fault(
                "vx,vy,vz",
                format!(
                    "v is not above the horizon: n·v is {}; expected above 0",
                    n.dot(v)
                ),
            );
        }
        let alpha = alpha?;
        let mut surface = Surface::new(model?, masking?, alpha, f0?, [n?, v?]);
        if let Some(anisotropy) = anisotropy? {
            surface = surface.stretched(Stretch {
                widths: anisotropy.law.widths(alpha, anisotropy.strength),
                tangent: east(surface.n, anisotropy.turn),
            });
        }
        if kind == Kind::Ladder {
            return Some(Integral::Ladder {
                surface,
                levels: levels?,
            });
        }
        Some(Integral::Shading {
            surface,
            coat: coat?,
            sheen: sheen?,
        })
    }

    fn dfg(&mut self) -> Option<Integral> {
        let model = self.model();
        let masking = self.masking();
        let alpha = self.alpha("alpha");
        let n_dot_v = self.above_zero_to_one("n_dot_v");
        Some(Integral::Dfg {
            model: model?,
            masking: masking?,
            alpha: alpha?,
            n_dot_v: n_dot_v?,
        })
    }

    fn prefilter(&mut self) -> Option<Integral> {
        let model = self.model();
        let alpha = self.alpha("alpha");
        let r = self.direction(["rx", "ry", "rz"]);
        let weight = self.weight();
        let masking = self.masking();
        Some(Integral::Prefilter {
            kernel: Kernel::new(model?, weight?, masking?),
            alpha: alpha?,
            r: r?,
        })
    }

    pub(super) fn fault(&mut self, column: &str, what: impl Into<String>) {
        self.faults.push(Fault {
            line: self.line,
            column: column.to_owned(),
            what: what.into(),
        });
    }

    fn optional_cell(&self, column: &str) -> Option<&str> {
        let index = self.columns.iter().position(|name| name == column)?;
        self.record.get(index)
    }

    /// Returns a cell of a required column, which the header has.
    pub(super) fn cell(&self, column: &str) -> &str {
        self.optional_cell(column).unwrap_or_default()
    }

    fn number(&mut self, column: &str, text: &str) -> Option<f64> {
        let number = text.parse::<f64>().ok().filter(|x| x.is_finite());
        if number.is_none() {
            let what = if self.optional_cell(column).is_some() {
                format!("{text:?} is not a finite number")
            } else {
                "the header lacks this column".to_owned()
            };
            self.fault(column, what);
        }
        number
    }

    fn above_zero_to_one(&mut self, column: &str) -> Option<f64> {
        let text = self.cell(column).to_owned();
        let number = self.number(column, &text)?;
        let is_inside = number > 0.0 && number <= 1.0;
        if !is_inside {
            self.fault(column, format!("{text} is outside (0, 1]"));
        }
        is_inside.then_some(number)
    }

    fn alpha(&mut self, column: &str) -> Option<f64> {
        let text = self.cell(column).to_owned();
        let alpha = self.above_zero_to_one(column)?;
        if alpha < ALPHA_MIN {
            self.fault(
                column,
                format!("{text} is below {ALPHA_MIN}, the narrowest lobe that is integrated"),
            );
        }
        (alpha >= ALPHA_MIN).then_some(alpha)
    }

    /// Returns the cell of a column that others need; `None` after a fault, `Some(None)` if the
    /// table lacks them all.
    fn asking_cell(&mut self, column: &str, others: &[&str]) -> Option<Option<String>> {
        if let Some(text) = self.optional_cell(column) {
            return Some(Some(text.to_owned()));
        }
        let stray = others
            .iter()
            .find(|name| self.optional_cell(name).is_some());
        stray.inspect(|name| self.fault(name, format!("it needs the column {column}")));
        stray.is_none().then_some(None)
    }

    /// Returns the row's anisotropy, if it has any; `None` after a fault.
    fn anisotropy(&mut self) -> Option<Option<Anisotropy>> {
        let others = ["anisotropy_rotation_deg", "anisotropy_widths"];
        let Some(text) = self.asking_cell("anisotropy", &others)? else {
            return Some(None);
        };
        let strength = self.number("anisotropy", &text)?;
        if !(0.0..=1.0).contains(&strength) {
            self.fault("anisotropy", format!("{text} is outside [0, 1]"));
        }
        let turn = self.optional_cell(others[0]).unwrap_or("0").to_owned();
        let turn = self.number(others[0], &turn)?;
        let law = *self.optional::<WidthLaw>(others[1])?;
        if strength > 0.0
            && let Some(what) = self
                .model()
                .zip(self.masking())
                .and_then(|(m, k)| law.fault(m, k))
        {
            self.fault("anisotropy", what);
        }
        let anisotropy = Anisotropy {
            strength,
            turn: turn.to_radians(),
            law,
        };
        Some((strength > 0.0).then_some(anisotropy))
    }

    /// Returns the row's coat, if the table has any; `None` after a fault.
    fn coat(&mut self) -> Option<Option<Coat>> {
        let Some(text) = self.asking_cell("coat", &["coat_alpha", "coat_layering"])? else {
            return Some(None);
        };
        let weight = self.number("coat", &text)?;
        if !(0.0..=1.0).contains(&weight) {
            self.fault("coat", format!("{text} is outside [0, 1]"));
        }
        let alpha = self.alpha("coat_alpha");
        let layering = self.optional("coat_layering").copied();
        Some(Some(Coat {
            weight,
            alpha: alpha?,
            layering: layering?,
        }))
    }

    /// Returns the row's sheen, if the table has any; `None` after a fault.
    fn sheen(&mut self) -> Option<Option<Sheen>> {
        let Some(text) = self.asking_cell("sheen_color", &["sheen_alpha", "sheen_visibility"])?
        else {
            return Some(None);
        };
        let color = self.color("sheen_color", &text, [0.0, 1.0]);
        let alpha = self.above_zero_to_one("sheen_alpha");
        let alpha = alpha?;
        let visibility = self.optional("sheen_visibility");
        if alpha < SHEEN_ALPHA_MIN {
            self.fault(
                "sheen_alpha",
                format!("{alpha} is below {SHEEN_ALPHA_MIN}, the smallest width of sheen"),
            );
        }
        Some(Some(Sheen {
            color: color?,
            alpha,
            visibility: visibility?,
        }))
    }

    /// Returns F0, given as itself or by an index of refraction.
    fn f0(&mut self) -> Option<DVec3> {
        if let Some(text) = self.optional_cell(IOR_COLUMN).map(str::to_owned) {
            let ior = self.color(IOR_COLUMN, &text, [1.0, IOR_MAX])?;
            return Some(ior.map(f0_from_ior));
        }
        let text = self.cell(F0_COLUMN).to_owned();
        self.color(F0_COLUMN, &text, [0.0, 1.0])
    }

    /// Parses `x` or `R:G:B` with channels from `least` to `most`.
    fn color(&mut self, column: &str, text: &str, [least, most]: [f64; 2]) -> Option<DVec3> {
        let parts: Vec<&str> = text.split(':').collect();
        let channels: Option<Vec<f64>> =
            parts.iter().map(|part| self.number(column, part)).collect();
        let color = match channels?[..] {
            [x] => DVec3::splat(x),
            [r, g, b] => DVec3::new(r, g, b),
            _ => {
                self.fault(column, format!("{text:?} is neither a number nor R:G:B"));
                return None;
            }
        };
        let is_inside =
            color.cmpge(DVec3::splat(least)).all() && color.cmple(DVec3::splat(most)).all();
        if !is_inside {
            self.fault(column, format!("{text} is outside [{least}, {most}]"));
        }
        is_inside.then_some(color)
    }

    fn model(&mut self) -> Option<&'static dyn Brdf> {
        let name = self.cell("brdf").to_owned();
        self.listed("brdf", &name)
    }

    /// Returns the levels of the prefiltered map, by default as in the default tables.
    fn levels(&mut self) -> Option<u32> {
        let Some(text) = self
            .optional_cell("levels")
            .filter(|text| !text.is_empty())
            .map(str::to_owned)
        else {
            return Some(PrecomputeSettings::default().prefilter_level_count);
        };
        let levels = text.parse().ok().filter(|levels| LEVELS.contains(levels));
        if levels.is_none() {
            let least = LEVELS.start();
            let most = LEVELS.end();
            self.fault(
                "levels",
                format!("{text:?} is not a count from {least} to {most}"),
            );
        }
        levels
    }

    fn masking(&mut self) -> Option<MaskingShadowing> {
        self.optional("masking").copied()
    }

    fn weight(&mut self) -> Option<&'static Weight> {
        self.optional("weight")
    }

    /// Returns the entry named by the cell, or the default if the cell is empty or its column
    /// missing.
    fn optional<T: Listed>(&mut self, column: &str) -> Option<&'static T> {
        let name = self
            .optional_cell(column)
            .filter(|name| !name.is_empty())
            .unwrap_or(T::names()[0])
            .to_owned();
        self.listed(column, &name)
    }

    fn listed<T: Listed + ?Sized>(&mut self, column: &str, name: &str) -> Option<&'static T> {
        T::parse(name)
            .map_err(|fault| self.fault(column, fault))
            .ok()
    }

    /// Parses a unit vector from three columns and normalises it in f64.
    fn direction(&mut self, columns: [&str; 3]) -> Option<DVec3> {
        let numbers = columns.map(|column| {
            let text = self.cell(column).to_owned();
            self.number(column, &text)
        });
        let [Some(x), Some(y), Some(z)] = numbers else {
            return None;
        };
        let vector = DVec3::new(x, y, z);
        let joined_columns = columns.join(",");
        let length = vector.length();
        if length == 0.0 {
            self.fault(
                &joined_columns,
                "the vector is zero; expected a unit vector",
            );
            return None;
        }
        if (length - 1.0).abs() > LENGTH_TOLERANCE {
            let what = format!(
                "({x}, {y}, {z}) has length {length}; expected 1 within {LENGTH_TOLERANCE}"
            );
            self.fault(&joined_columns, what);
            return None;
        }
        Some(vector / length)
    }
}
