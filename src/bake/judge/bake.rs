//! Judges a whole bake: every part against its integral.

use super::blurred_chain;
use super::chain::{self, Chain};
use super::doubt::{Arrangement, AxesDoubt, Doubt, MapPart, RankedAxes, Warning, turned_back};
use super::faces::FaceTurn;
use super::guess::{self, AxesFit};
use super::level::{self, LevelScore};
use super::sh::{self, ShScore};
use super::table::{self, TableScore};
use super::verdict::{Part, PartVerdict, Verdict};
use super::{Cause, EXPLAINED, GOOD, Truth};
use crate::bake::container::FACE_COUNT;
use crate::bake::convention::{Axes, Convention, PRESETS, Preset};
use crate::bake::parts::{Bake, Map, Stated, TexelOrder};
use crate::base::names::Listed;
use crate::instrument::brdf::{Brdf, Ggx, MaskingShadowing};
use crate::instrument::environment::Environment;
use crate::instrument::precompute::prefilter::{Kernel, Weight};
use glam::{DQuat, DVec3};

/// The model and the conventions that a bake is judged by.
#[derive(Clone, Debug)]
pub struct Judging {
    pub brdf: &'static dyn Brdf,
    pub convention: Convention,
}

/// The scores of a bake.
#[derive(Clone, Debug)]
pub struct Judged {
    pub convention: Convention,
    /// The axes of each map: of the prefiltered map first.
    pub axes: Vec<RankedAxes>,
    /// How the file arranges its texels, if that explains why the light does not fit.
    pub arrangement: Option<Arrangement>,
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

impl Judging {
    /// Judges GGX by the conventions that the files state, else by the conventions of `splitsum
    /// bake`. Fails on an unknown name.
    pub fn stated(stated: &Stated) -> Result<Self, String> {
        let preset = match stated.preset.as_deref() {
            Some(name) => Preset::parse(name)?,
            None => &PRESETS[0],
        };
        Self::by(preset, stated)
    }

    /// Judges GGX by the conventions of a preset; statements of the files override them, unless
    /// they name another preset.
    pub fn by(preset: &Preset, stated: &Stated) -> Result<Self, String> {
        let is_stated = preset.name == stated.preset.as_deref().unwrap_or(PRESETS[0].name);
        let stated = if is_stated {
            stated
        } else {
            &Stated::default()
        };
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
        let alphas = match &bake.specular {
            Some(map) => convention.alphas(map.levels.len())?,
            None => Vec::new(),
        };
        doing("integrating the exact maps");
        let mut truth = Truth::judging(environment, kernel, &alphas);
        truth.has_rounded_up_scale = bake.has_rounded_up_scale;
        doing("comparing the axes");
        let mut axes = Vec::new();
        let mut arrangement = None;
        if let Some(map) = &bake.specular {
            let fits = guess::axes(&truth, map, convention)?;
            truth.is_other = fits[0].correlation < guess::SAME_LIGHT;
            if truth.is_other {
                arrangement = fitting_arrangement(&truth, map, convention);
            }
            axes.push(RankedAxes {
                map: MapPart::Prefiltered,
                ranking: fits,
            });
        }
        if let Some(map) = &bake.irradiance {
            axes.push(RankedAxes {
                map: MapPart::Irradiance,
                ranking: guess::irradiance_axes(&truth, map),
            });
        }
        doing("scoring levels");
        let judged = scored(&truth, self.brdf, bake, convention.clone())?;
        let mut judged = Judged {
            axes,
            arrangement,
            ..judged
        };
        // The slips of a level look for the light of another map no longer.
        truth.is_other &= arrangement.is_none();
        judged.fix_convention(&truth, self.brdf, bake, &doing)?;
        Ok(judged)
    }
}

/// Finds the order of the file's texels, or the turn of every face, in which the light fits.
fn fitting_arrangement(truth: &Truth, map: &Map, convention: &Convention) -> Option<Arrangement> {
    let sure_fit = |map: &Map| {
        let fits = guess::axes(truth, map, convention).ok()?;
        (fits[0].correlation >= guess::SURE).then_some(fits[0])
    };
    let order = TexelOrder::ALL
        .into_iter()
        .find(|order| sure_fit(&map.reordered(*order)).is_some());
    if let Some(order) = order {
        return Some(Arrangement::Order(order));
    }
    if map.layout.face_count as usize != FACE_COUNT {
        return None;
    }
    // Rows from the bottom are the usual case.
    std::iter::once(FaceTurn::FlippedTopBottom)
        .chain(FaceTurn::ALL)
        .find_map(|turn| {
            let best = sure_fit(&turned_back(map, turn))?;
            Some(Arrangement::TurnedFaces { turn, best })
        })
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
    let blurred_chain = || {
        let map = bake.specular.as_ref()?;
        blurred_chain::slip(truth, map, &convention, &levels)
    };
    Ok(Judged {
        chain: chain::slip(&convention, &levels).or_else(blurred_chain),
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
        arrangement: None,
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
        let convention = self.fixed_convention(doubt.as_ref());
        let arranged = self.arrangement.zip(bake.specular.as_ref());
        let arranged = arranged.map(|(arrangement, map)| Bake {
            specular: Some(arrangement.undone(map)),
            ..bake.clone()
        });
        let bake = arranged.as_ref().unwrap_or(bake);
        let is_changed = convention.axes != self.convention.axes
            || convention.alphas != self.convention.alphas
            || arranged.is_some();
        if is_changed {
            doing("looking for further slips");
            let mut fixed = scored(truth, brdf, bake, convention)?;
            if arranged.is_none() && doubt.is_some() && self.is_simpler_than(&fixed) {
                let used = self.convention.axes;
                self.axes[0].ranking.retain(|fit| fit.axes == used);
                return self.fix_convention(truth, brdf, bake, doing);
            }
            fixed.axes.clone_from(&self.axes);
            if let Some(map) = arranged.as_ref().and_then(|bake| bake.specular.as_ref()) {
                fixed.axes[0].ranking = guess::axes(truth, map, &fixed.convention)?;
            }
            // A part that is good needs no fix.
            if self
                .irradiance
                .iter()
                .any(|score| score.errors.relmse <= GOOD)
            {
                fixed.irradiance = None;
            }
            if self.sh.iter().any(|score| score.errors.relmse <= GOOD) {
                fixed.sh = None;
            }
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

    /// Returns the convention with the axes or the chain that fit.
    fn fixed_convention(&self, doubt: Option<&Doubt>) -> Convention {
        let mut convention = self.convention.clone();
        if let Some(doubt) = doubt {
            convention.axes = doubt.axes().unwrap_or(convention.axes);
        } else if let Some(chain) = &self.chain {
            convention.alphas = Some(chain.alphas.clone());
        }
        convention
    }

    /// Whether its slips explain all that is wrong, and by less than other axes with the slips that
    /// these leave.
    fn is_simpler_than(&self, other: &Self) -> bool {
        let left: f64 = self
            .maps()
            .map(|score| score.left().unwrap_or(score.errors.relmse))
            .sum();
        let other_error: f64 = other.maps().map(|score| score.errors.relmse).sum();
        let is_other_unknown = other.maps().any(|score| score.has(Cause::is_unknown));
        self.maps().all(LevelScore::is_explained)
            && left < EXPLAINED * other_error
            && (is_other_unknown || self.most_causes() <= other.most_causes())
    }

    /// Returns the largest number of causes of a level.
    fn most_causes(&self) -> Option<usize> {
        self.maps().map(|score| score.verdict.causes().len()).max()
    }

    /// Lists the levels, and the irradiance map.
    pub(super) fn maps(&self) -> impl Iterator<Item = &LevelScore> {
        self.levels.iter().chain(&self.irradiance)
    }

    /// The doubt of the prefiltered map, else of the irradiance map: with a prefiltered map, a
    /// turned irradiance map is a slip of that part alone.
    fn first_doubt(&self) -> Option<Doubt> {
        self.axes.first().and_then(|ranked| self.doubt(ranked))
    }

    /// Describes why the axes or the light of a map seem wrong, if they do.
    pub fn doubt(&self, ranked: &RankedAxes) -> Option<Doubt> {
        let fits = &ranked.ranking;
        let best = fits[0];
        // A good level proves the light, as does one that a slip explains. With a constant light
        // nothing correlates.
        let is_wrong = self.maps().all(|score| !score.is_explained());
        let alike: Vec<Axes> = fits
            .iter()
            .filter(|fit| !guess::is_clear(best, **fit))
            .map(|fit| fit.axes)
            .collect();
        let is_sure = best.correlation >= guess::SURE;
        let is_same_light =
            best.correlation >= guess::SAME_LIGHT && (is_sure || alike.len() < guess::ALIKE_MAX);
        let arrangement = self
            .arrangement
            .filter(|_| ranked.map != MapPart::Irradiance);
        match arrangement {
            Some(Arrangement::Order(order)) => return Some(Doubt::Order(order)),
            Some(Arrangement::TurnedFaces { turn, best }) => {
                return Some(Doubt::TurnedFaces {
                    turn,
                    best,
                    has_other_axes: best.axes != self.convention.axes,
                });
            }
            None if is_wrong && !is_same_light => return Some(Doubt::OtherLight(best)),
            None => {}
        }
        let used = *fits.iter().find(|fit| fit.axes == self.convention.axes)?;
        let is_explained = !is_sure
            && (self.levels.iter().all(LevelScore::is_explained) || !is_same_light && !is_wrong);
        let is_doubtful = best.axes != used.axes && guess::is_clear(best, used) && !is_explained;
        is_doubtful.then(|| {
            Doubt::Axes(AxesDoubt {
                best,
                used,
                alike: alike.into_iter().skip(1).collect(),
                turn: turn_about_y(used, best),
            })
        })
    }

    /// Lists the doubts of the maps.
    pub fn warnings(&self) -> Vec<Warning> {
        self.axes
            .iter()
            .filter_map(|ranked| self.warning(ranked))
            .collect()
    }

    /// Describes the doubt of a map, if there is one.
    pub fn warning(&self, ranked: &RankedAxes) -> Option<Warning> {
        Some(Warning {
            map: ranked.map,
            doubt: self.doubt(ranked)?,
        })
    }

    /// Returns the cause in all parts: a doubt, or other widths.
    pub(super) fn whole_cause(&self) -> Option<Cause> {
        let chain = || Some(Cause::Chain(self.chain.as_ref()?.slip.clone()));
        self.first_doubt().map(Cause::Doubt).or_else(chain)
    }

    /// Lists what the verdict names, each once as printed.
    pub fn causes(&self) -> Vec<Cause> {
        let mut causes = match self.whole_cause() {
            Some(cause) => vec![cause],
            None => self.causes_of_parts(),
        };
        causes.extend(self.fixed.iter().flat_map(|fixed| fixed.causes()));
        let mut unique: Vec<Cause> = Vec::new();
        for cause in causes {
            if !unique.iter().any(|known| known.is_printed_as(&cause)) {
                unique.push(cause);
            }
        }
        unique
    }

    fn causes_of_parts(&self) -> Vec<Cause> {
        let maps = self.maps().map(|score| &score.verdict);
        let sh = self.sh.iter().map(|score| &score.verdict);
        let dfg = self.dfg.iter().map(|score| &score.verdict);
        maps.chain(sh)
            .chain(dfg)
            .flat_map(Verdict::causes)
            .cloned()
            .collect()
    }

    /// Lists each part with its verdict; neighbouring levels of one printed verdict share a line.
    /// Levels of other axes or another chain are listed as they are if that is fixed.
    pub fn parts(&self) -> Vec<PartVerdict> {
        let part = |part: Part, verdict: Verdict| PartVerdict {
            part,
            is_if_fixed: false,
            verdict,
        };
        let is_listed = |relmse: f64| self.fixed.is_none() || relmse <= GOOD;
        let mut parts = Vec::new();
        if self.fixed.is_none() {
            parts.extend(self.level_parts());
        }
        if let Some(score) = &self.irradiance
            && is_listed(score.errors.relmse)
        {
            parts.push(part(Part::Irradiance, score.verdict.clone()));
        }
        if let Some(score) = &self.sh
            && is_listed(score.errors.relmse)
        {
            parts.push(part(Part::Sh, score.verdict.clone()));
        }
        let Some(fixed) = &self.fixed else {
            let dfg = self.dfg.iter();
            parts.extend(dfg.map(|score| part(Part::Table, score.verdict.clone())));
            return parts;
        };
        if let Some(cause) = self.whole_cause() {
            let whole = match cause {
                Cause::Doubt(_) => Part::Map(self.axes[0].map),
                _ => Part::Widths,
            };
            parts.push(part(whole, Verdict::from_causes(vec![cause])));
        }
        for mut part in fixed.parts() {
            // Axes and widths have no effect on a table.
            part.is_if_fixed |= part.part != Part::Table;
            parts.push(part);
        }
        parts
    }

    fn level_parts(&self) -> Vec<PartVerdict> {
        let mut parts: Vec<PartVerdict> = Vec::new();
        let mut first = 0;
        for (level, score) in self.levels.iter().enumerate() {
            if level > 0 && self.levels[level - 1].verdict.is_printed_as(&score.verdict) {
                parts.pop();
            } else {
                first = level;
            }
            let part = if first == level {
                Part::Level(level)
            } else {
                Part::Levels(first, level)
            };
            parts.push(PartVerdict {
                part,
                is_if_fixed: false,
                verdict: score.verdict.clone(),
            });
        }
        parts
    }
}

/// Returns the quarter or half turn about y that takes the used axes to the best, degrees.
fn turn_about_y(used: AxesFit, best: AxesFit) -> Option<f64> {
    let turns_by = |degrees: f64| {
        let turn = DQuat::from_rotation_y(degrees.to_radians());
        DVec3::AXES.into_iter().all(|world| {
            let turned = best.axes.to_world(used.axes.to_file(world));
            turned.distance(turn * world) < 1e-6
        })
    };
    [90.0, 180.0, -90.0]
        .into_iter()
        .find(|degrees| turns_by(*degrees))
}
