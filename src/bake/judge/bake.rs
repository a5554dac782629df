//! Judges a whole bake: every part against its integral.

use super::chain::{self, Chain};
use super::guess::{self, AxesFit};
use super::level::{self, GOOD_WORDS, LevelScore, UNEXPLAINED};
use super::sh::{self, ShScore};
use super::table::{self, TableScore};
use super::{Cause, EXPLAINED, GOOD, Truth};
use crate::bake::convention::{Axes, Convention, PRESETS, Preset};
use crate::bake::parts::{Bake, Map, Stated};
use crate::base::names::Listed;
use crate::instrument::brdf::{Brdf, Ggx, MaskingShadowing};
use crate::instrument::environment::Environment;
use crate::instrument::precompute::prefilter::{Kernel, Weight};
use glam::{DQuat, DVec3};

#[derive(Clone, Debug)]
pub struct Judging {
    pub brdf: &'static dyn Brdf,
    pub convention: Convention,
}

#[derive(Clone, Debug)]
pub struct Judged {
    pub convention: Convention,
    /// Name of each map, and its fits, best first.
    pub axes: Vec<(&'static str, Vec<AxesFit>)>,
    /// How the file orders its texels, if that explains why the light does not fit.
    pub order: Option<&'static str>,
    /// Finest level first.
    pub levels: Vec<LevelScore>,
    /// The chain that the widths of all levels have, unless it is the assumed one.
    pub chain: Option<Chain>,
    pub irradiance: Option<LevelScore>,
    pub dfg: Option<TableScore>,
    pub sh: Option<ShScore>,
    /// The same bake by the axes or the chain that the verdict names.
    pub fixed: Option<Box<Self>>,
}

/// Why the axes or the light seem wrong.
#[derive(Clone, Debug)]
pub struct Doubt {
    pub words: String,
    /// Details of the warning, after `words`.
    pub more: String,
    /// The axes that fit; `None` for another map.
    pub axes: Option<Axes>,
}

/// Before the name of a part that is judged by the axes or the chain that fit.
const IF_FIXED: &str = "if fixed, ";

/// Name of the irradiance map in [`Judged::axes`].
pub const IRRADIANCE: &str = "irradiance map";

impl Judging {
    /// Judges GGX by the conventions that the files state, else by the conventions of `splitsum
    /// bake`. Fails on an unknown name.
    pub fn stated(stated: &Stated) -> Result<Self, String> {
        Self::by(
            stated
                .preset
                .as_deref()
                .map_or(Ok(&PRESETS[0]), Preset::parse)?,
            stated,
        )
    }

    /// Judges GGX by the conventions of a preset; statements of the files override them, unless
    /// they name another preset.
    pub fn by(preset: &Preset, stated: &Stated) -> Result<Self, String> {
        let is_own = preset.name == stated.preset.as_deref().unwrap_or(PRESETS[0].name);
        let stated = if is_own { stated } else { &Stated::default() };
        let mut convention = preset.convention();
        convention.alphas = stated.alphas.clone().or(convention.alphas);
        if let Some(name) = &stated.masking {
            convention.masking = *MaskingShadowing::parse(name)?;
        }
        if let Some(name) = &stated.weight {
            convention.weight = Weight::parse(name)?;
        }
        Ok(Self {
            brdf: &Ggx,
            convention,
        })
    }

    /// Scores each part of `bake` against its integral over `environment`, and reports each step to
    /// `doing`.
    ///
    /// Fails unless the convention has one width per level.
    pub fn judge(
        &self,
        environment: &Environment,
        bake: &Bake,
        doing: impl Fn(&'static str),
    ) -> Result<Judged, String> {
        let convention = &self.convention;
        let kernel = Kernel::new(self.brdf, convention.weight, convention.masking);
        let alphas = bake
            .specular
            .as_ref()
            .map_or(Ok(Vec::new()), |map| convention.alphas(map.levels.len()))?;
        doing("integrating the exact maps");
        let truth = &mut Truth::judging(environment, kernel, &alphas);
        doing("comparing the axes");
        let mut axes = Vec::new();
        if let Some(map) = &bake.specular {
            axes.push(("prefiltered map", guess::axes(truth, map, convention)?));
        }
        if let Some(map) = &bake.irradiance {
            axes.push((IRRADIANCE, guess::irradiance_axes(truth, map)));
        }
        truth.is_other = bake.specular.is_some() && axes[0].1[0].correlation < guess::SAME_LIGHT;
        let fits = |map: &Map| {
            guess::axes(truth, map, convention).is_ok_and(|fits| fits[0].correlation >= guess::SURE)
        };
        let order = bake
            .specular
            .iter()
            .filter(|_| truth.is_other)
            .flat_map(Map::reordered)
            .find(|(_, map)| fits(map))
            .map(|(words, _)| words);
        doing("scoring levels");
        let mut judged = scored(truth, self.brdf, bake, convention.clone())?;
        (judged.axes, judged.order) = (axes, order);
        judged.fix_convention(truth, self.brdf, bake, &doing)?;
        Ok(judged)
    }
}

fn scored(
    truth: &Truth,
    brdf: &'static dyn Brdf,
    bake: &Bake,
    convention: Convention,
) -> Result<Judged, String> {
    let levels = match &bake.specular {
        Some(map) => level::score(truth, map, &convention)?,
        None => Vec::new(),
    };
    Ok(Judged {
        chain: chain::slip(&convention, &levels),
        irradiance: bake
            .irradiance
            .as_ref()
            .map(|map| level::score_irradiance(truth, map, &convention)),
        dfg: bake
            .dfg
            .as_ref()
            .map(|image| table::score(image, brdf, &convention)),
        sh: bake
            .sh
            .as_ref()
            .map(|found| sh::score(truth, found, convention.axes)),
        fixed: None,
        convention,
        axes: Vec::new(),
        order: None,
        levels,
    })
}

impl Judged {
    /// Scores the bake again by the axes or the chain that fit, to find further slips.
    fn fix_convention(
        &mut self,
        truth: &Truth,
        brdf: &'static dyn Brdf,
        bake: &Bake,
        doing: &impl Fn(&'static str),
    ) -> Result<(), String> {
        let doubt = self.first_doubt();
        let mut convention = self.convention.clone();
        match (&doubt, &self.chain) {
            (
                Some(Doubt {
                    axes: Some(axes), ..
                }),
                _,
            ) => convention.axes = *axes,
            (None, Some(chain)) => convention.alphas = Some(chain.alphas.clone()),
            _ => {}
        }
        if convention.axes != self.convention.axes || convention.alphas != self.convention.alphas {
            doing("looking for further slips");
            let mut fixed = scored(truth, brdf, bake, convention)?;
            if doubt.is_some() && self.is_simpler_than(&fixed) {
                let used = self.convention.axes;
                self.axes[0].1.retain(|fit| fit.axes == used);
                return self.fix_convention(truth, brdf, bake, doing);
            }
            fixed.axes.clone_from(&self.axes);
            // A part that is good as it is needs no mending.
            fixed.irradiance = fixed
                .irradiance
                .filter(|_| self.irradiance.iter().all(|own| own.errors.relmse > GOOD));
            fixed.sh = fixed
                .sh
                .filter(|_| self.sh.iter().all(|own| own.errors.relmse > GOOD));
            fixed.fix_convention(truth, brdf, bake, doing)?;
            self.fixed = Some(Box::new(fixed));
        }
        // A fit explains nothing if the light or the axes are wrong.
        if doubt.is_some() {
            self.levels
                .iter_mut()
                .chain(&mut self.irradiance)
                .for_each(LevelScore::doubt);
            self.sh.iter_mut().for_each(ShScore::doubt);
        }
        Ok(())
    }

    /// Whether its slips explain all that is wrong, and by less than other axes with the slips that
    /// these leave.
    fn is_simpler_than(&self, other: &Self) -> bool {
        let most = |of: &Self| of.maps().map(|score| score.causes.len()).max();
        let left: f64 = self
            .maps()
            .map(|score| score.left().unwrap_or(score.errors.relmse))
            .sum();
        self.maps().all(LevelScore::is_explained)
            && left < EXPLAINED * other.maps().map(|score| score.errors.relmse).sum::<f64>()
            && (other.maps().any(|score| score.names("unknown")) || most(self) <= most(other))
    }

    fn maps(&self) -> impl Iterator<Item = &LevelScore> {
        self.levels.iter().chain(&self.irradiance)
    }

    /// The doubt of the prefiltered map, else of the irradiance map: beside a prefiltered map, a
    /// turned irradiance map is a slip of its own.
    fn first_doubt(&self) -> Option<Doubt> {
        self.axes
            .first()
            .and_then(|(what, fits)| self.doubt(what, fits))
    }

    /// Describes why the axes or the light seem wrong, if they do.
    pub fn doubt(&self, what: &str, fits: &[AxesFit]) -> Option<Doubt> {
        let used: Axes = self.convention.axes;
        let hint = if what == IRRADIANCE {
            "; if it is the map itself, name it specular=FILE"
        } else {
            ""
        };
        // A good level proves the light, as does one that a slip explains. With a constant light
        // nothing correlates.
        let is_wrong = self.maps().all(|score| !score.is_explained());
        let best: Vec<String> = fits
            .iter()
            .filter(|fit| !guess::is_clear(fits[0], **fit))
            .map(|fit| fit.axes.to_string())
            .collect();
        let is_sure = fits[0].correlation >= guess::SURE;
        let is_like =
            fits[0].correlation >= guess::SAME_LIGHT && (is_sure || best.len() < guess::ALIKE_MAX);
        if is_wrong && !is_like || self.order.is_some() && what != IRRADIANCE {
            let AxesFit {
                axes,
                correlation: c,
            } = fits[0];
            let other = format!(
                "seems to be a bake of another map: its best axes, {axes}, have correlation {c:.2}"
            );
            let words = self.order.map_or(other, str::to_owned);
            return Some(Doubt {
                words,
                more: hint.to_owned(),
                axes: None,
            });
        }
        let own = *fits.iter().find(|fit| fit.axes == used)?;
        let is_explained =
            !is_sure && (self.levels.iter().all(LevelScore::is_explained) || !is_like && !is_wrong);
        let is_doubtful = fits[0].axes != used && guess::is_clear(fits[0], own) && !is_explained;
        let (AxesFit { axes, correlation }, of_own) = (fits[0], own.correlation);
        let alike = if best.len() > 1 {
            format!("; as good: {}", best[1..].join(", "))
        } else {
            String::new()
        };
        let turns_by = |degrees: &f64| {
            let turn = DQuat::from_rotation_y(degrees.to_radians());
            DVec3::AXES
                .iter()
                .all(|d| axes.to_world(used.to_file(*d)).distance(turn * *d) < 1e-6)
        };
        let turn = [90.0, 180.0, -90.0]
            .iter()
            .find(|degrees| turns_by(degrees));
        let words = turn.map_or_else(
            || format!("axes {axes} fit far better than {used}"),
            |degrees| format!("turned by {degrees}° about y"),
        );
        is_doubtful.then(|| Doubt {
            words: format!("{words}: --axes={axes}"),
            more: format!("; correlation {correlation:.4}, not {of_own:.4}{alike}{hint}"),
            axes: Some(axes),
        })
    }

    /// Lists what the verdict names, each once.
    pub fn causes(&self) -> Vec<Cause> {
        let whole = |kind, words: &str| {
            vec![Cause {
                kind,
                words: words.to_owned(),
            }]
        };
        let mut causes = match (self.first_doubt(), &self.chain) {
            (Some(doubt), _) => whole(
                if doubt.axes.is_some() { "axes" } else { "map" },
                &doubt.words,
            ),
            (None, Some(chain)) => whole("levels", &chain.words),
            _ => {
                let levels = self.maps().flat_map(|score| &score.causes);
                let sh = self.sh.iter().flat_map(|score| &score.causes);
                levels
                    .chain(sh)
                    .chain(self.dfg.iter().flat_map(|score| &score.causes))
                    .cloned()
                    .collect()
            }
        };
        causes.extend(self.fixed.iter().flat_map(|fixed| fixed.causes()));
        let mut seen = Vec::new();
        for cause in causes {
            if !seen.contains(&cause) {
                seen.push(cause);
            }
        }
        seen
    }

    /// Lists each part with its verdict; neighbouring levels of one verdict share a line. Levels of
    /// other axes or another chain are listed as they are if that is fixed.
    pub fn parts(&self) -> Vec<(String, String)> {
        let mut parts: Vec<(String, String)> = Vec::new();
        let mut first = 0;
        for (level, score) in self
            .levels
            .iter()
            .enumerate()
            .filter(|_| self.fixed.is_none())
        {
            if level > 0 && self.levels[level - 1].verdict == score.verdict {
                parts.pop();
            } else {
                first = level;
            }
            let name = if first == level {
                format!("level {level}")
            } else {
                format!("levels {first} to {level}")
            };
            parts.push((name, score.verdict.clone()));
        }
        let is_listed = |relmse: f64| self.fixed.is_none() || relmse <= GOOD;
        let irradiance = self
            .irradiance
            .iter()
            .filter(|own| is_listed(own.errors.relmse));
        parts.extend(irradiance.map(|own| ("irradiance".to_owned(), own.verdict.clone())));
        let sh = self.sh.iter().filter(|own| is_listed(own.errors.relmse));
        parts.extend(sh.map(|own| ("SH".to_owned(), own.verdict.clone())));
        let Some(fixed) = &self.fixed else {
            parts.extend(
                self.dfg
                    .iter()
                    .map(|own| ("DFG table".to_owned(), own.verdict.clone())),
            );
            return parts;
        };
        let chain = self
            .chain
            .iter()
            .map(|chain| ("widths", chain.words.clone()));
        let cause = self
            .first_doubt()
            .map(|doubt| (self.axes[0].0, doubt.words))
            .into_iter()
            .chain(chain)
            .next();
        let named = |(name, verdict): (String, String)| match name.starts_with(IF_FIXED)
            || name == "DFG table"
        {
            true => (name, verdict),
            false => (format!("{IF_FIXED}{name}"), verdict),
        };
        parts.extend(cause.map(|(name, words)| (name.to_owned(), words)));
        parts.extend(fixed.parts().into_iter().map(named));
        parts
    }

    /// Summarises the faults in one line, faults of several levels first; `None` without faults.
    pub fn wrong(&self) -> Option<String> {
        self.faults().map(|faults| format!("wrong: {faults}"))
    }

    fn faults(&self) -> Option<String> {
        let doubt = self.first_doubt().map(|doubt| doubt.words);
        if let Some(cause) = doubt.or_else(|| Some(self.chain.as_ref()?.words.clone())) {
            let rest = self.fixed.as_ref().map(|fixed| match fixed.faults() {
                Some(more) => format!("; besides, {more}"),
                None => "; nothing else".to_owned(),
            });
            return Some(cause + &rest.unwrap_or_default());
        }
        let wrong = self
            .parts()
            .into_iter()
            .filter(|(_, verdict)| !verdict.starts_with(GOOD_WORDS));
        let mut said: Vec<String> = wrong
            .map(|(name, verdict)| format!("{name}: {verdict}"))
            .collect();
        said.sort_by_key(|said| [said.ends_with(UNEXPLAINED), !said.starts_with("levels")]);
        let is_known = self.causes().iter().all(|cause| cause.kind != "unknown");
        let left = self
            .maps()
            .filter_map(LevelScore::left)
            .max_by(f64::total_cmp)
            .filter(|_| is_known);
        let left = left.map(|left| format!("; {:.1} % rms if fixed", 100.0 * left.sqrt()));
        (!said.is_empty()).then(|| said.join("; ") + &left.unwrap_or_default())
    }

    /// Sums up the whole bake in one line.
    pub fn verdict(&self) -> String {
        let coarse = self.levels.iter().filter_map(LevelScore::coarseness);
        let is_table = self.axes.is_empty() && self.sh.is_none();
        self.wrong()
            .unwrap_or_else(|| match coarse.max_by(f64::total_cmp) {
                None if is_table => {
                    "good: the DFG table is within a step of 8 bits of its integral".to_owned()
                }
                None => "good: every part is within 3 % rms of its integral".to_owned(),
                Some(relmse) => {
                    format!(
                        "good, but coarse: lookups between texels err by up to {:.1} % rms",
                        100.0 * relmse.sqrt()
                    )
                }
            })
    }
}
