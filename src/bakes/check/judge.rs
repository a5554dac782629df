//! Judges a whole bake: every part against its integral.

use super::chain;
use super::guess::{self, AxesFit};
use super::image::{self, ImageScore};
use super::level::{self, GOOD_WORDS, LevelScore};
use super::sh::{self, ShScore};
use super::table::{self, TableScore};
use super::{GOOD, Truth};
use crate::bakes::convention::{Axes, Convention, PRESETS, Preset};
use crate::bakes::parts::{Bake, Stated};
use crate::brdf::{Brdf, Ggx, MaskingShadowing};
use crate::environment::Environment;
use crate::precompute::prefilter::{Kernel, Weight};
use crate::spelling::Listed;

#[derive(Clone, Debug)]
pub struct Judging {
    pub brdf: &'static dyn Brdf,
    pub convention: Convention,
    /// Tries every convention and uses the best.
    pub is_guessed: bool,
    /// Scores the effect on an image, which doubles the time.
    pub has_image: bool,
}

#[derive(Clone, Debug)]
pub struct Judged {
    /// The given conventions, or the best fit.
    pub convention: Convention,
    /// Name of each map, and its fits, best first.
    pub axes: Vec<(&'static str, Vec<AxesFit>)>,
    /// How well conventions fit the table, if they were searched.
    pub table_way: Option<String>,
    /// Finest level first.
    pub levels: Vec<LevelScore>,
    /// Verdict on the chain from the widths of all levels, unless it is the assumed chain.
    pub chain: Option<String>,
    pub irradiance: Option<LevelScore>,
    pub dfg: Option<TableScore>,
    pub sh: Option<ShScore>,
    /// Empty unless requested.
    pub image: Vec<ImageScore>,
}

/// Name of the irradiance map in [`Judged::axes`].
pub const IRRADIANCE: &str = "irradiance map";

impl Judging {
    /// Judges GGX by the conventions that the files state, else by the conventions of `splitsum bake`. Fails on an unknown name.
    pub fn stated(stated: &Stated) -> Result<Self, String> {
        Self::by(stated.preset.as_deref().map_or(Ok(&PRESETS[0]), Preset::parse)?, stated)
    }

    /// Judges GGX by the conventions of a preset; statements of the files override them, unless they name another preset.
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
        Ok(Self { brdf: &Ggx, convention, is_guessed: false, has_image: false })
    }

    /// Scores each part of `bake` against its integral over `environment`.
    ///
    /// Fails unless the convention has one width per level.
    pub fn judge(&self, environment: &Environment, bake: &Bake) -> Result<Judged, String> {
        self.judge_saying(environment, bake, |_| ())
    }

    /// Does the same and reports each step to `doing`.
    pub fn judge_saying(
        &self,
        environment: &Environment,
        bake: &Bake,
        doing: impl Fn(&'static str),
    ) -> Result<Judged, String> {
        let mut convention = self.convention.clone();
        let kernel = Kernel::new(self.brdf, convention.weight, convention.masking);
        let alphas = bake.specular.as_ref().map_or(Ok(Vec::new()), |map| convention.alphas(map.levels.len()))?;
        doing("integrating the exact maps");
        // The surfaces of an image have their own widths.
        let truth = &Truth::judging(environment, kernel, &[&alphas[..], &image::ALPHAS].concat());
        doing("comparing the axes");
        let mut axes = Vec::new();
        if let Some(map) = &bake.specular {
            axes.push(("prefiltered map", guess::axes(truth, map, &convention)?));
        }
        if let Some(map) = &bake.irradiance {
            axes.push((IRRADIANCE, guess::irradiance_axes(truth, map)));
        }
        let mut table_way = None;
        if self.is_guessed {
            if let Some((_, fits)) = axes.first() {
                convention.axes = fits[0].axes;
            }
            if let Some(image) = &bake.dfg {
                doing("searching the conventions of the DFG table");
                let found = table::search(image, self.brdf);
                let best = &found[0];
                (convention.table_axes, convention.table_channels) = (best.axes, best.channels);
                convention.masking = best.masking;
                table_way = Some(format!("{best}; next {}", found[1]));
            }
        }
        doing("scoring levels");
        let levels = match &bake.specular {
            Some(map) => level::score(truth, map, &convention)?,
            None => Vec::new(),
        };
        doing("scoring diffuse maps and the DFG table");
        let mut judged = Judged {
            chain: chain::slip(&convention, &levels),
            irradiance: bake.irradiance.as_ref().map(|map| level::score_irradiance(truth, map, &convention)),
            dfg: bake.dfg.as_ref().map(|image| table::score(image, self.brdf, &convention)),
            sh: bake.sh.as_ref().map(|found| sh::score(truth, found, convention.axes)),
            image: Vec::new(),
            convention,
            axes,
            table_way,
            levels,
        };
        // A fit explains nothing if the light or the axes are wrong.
        if judged.axes.iter().any(|(what, fits)| judged.doubt(what, fits).is_some()) {
            judged.levels.iter_mut().chain(&mut judged.irradiance).for_each(LevelScore::doubt);
            judged.sh.iter_mut().for_each(ShScore::doubt);
        }
        if self.has_image {
            doing("shading images with the bake");
            judged.image = image::score(truth, bake, &judged.convention)?;
        }
        Ok(judged)
    }
}

impl Judged {
    /// Describes why the axes or the light seem wrong, if they do.
    pub fn doubt(&self, what: &str, fits: &[AxesFit]) -> Option<String> {
        let used: Axes = self.convention.axes;
        let hint =
            if what == IRRADIANCE { "; a cube of one level that holds the map itself is specular=FILE" } else { "" };
        // A good level proves the light, as does one that a slip explains. With a constant light nothing correlates.
        let mut levels = self.levels.iter().chain(&self.irradiance);
        let is_wrong = levels.all(|score| score.errors.relmse > GOOD && score.slip.is_none());
        let best: Vec<String> =
            fits.iter().filter(|fit| !guess::is_clear(fits[0], **fit)).map(|fit| fit.axes.to_string()).collect();
        let is_sure = fits[0].correlation >= guess::SURE;
        let is_like = fits[0].correlation >= guess::SAME_LIGHT && (is_sure || best.len() < guess::ALIKE_MAX);
        if is_wrong && !is_like {
            let (axes, correlation) = (fits[0].axes, fits[0].correlation);
            return Some(format!(
                "seems to be a bake of another map: the best axes, {axes}, only have correlation {correlation:.2}{hint}"
            ));
        }
        let own = *fits.iter().find(|fit| fit.axes == used)?;
        let is_slip = |score: &LevelScore| score.errors.relmse <= GOOD || score.slip.is_some();
        let is_explained = !is_sure && (self.levels.iter().all(is_slip) || !is_like && !is_wrong);
        let is_doubtful = fits[0].axes != used && guess::is_clear(fits[0], own) && !is_explained;
        let alike = if best.len() > 1 { ", which this map does not tell apart," } else { "" };
        let presets = PRESETS.iter().filter(|preset| preset.convention().axes == fits[0].axes);
        let presets: Vec<&str> = presets.map(|preset| preset.name).collect();
        let of = if presets.is_empty() { String::new() } else { format!(", of --preset {}", presets.join(" or ")) };
        is_doubtful.then(|| {
            format!(
                "axes {}{alike} fit far better than {used} (correlation {:.4}, not {:.4}): --axes={}{of}, or --guess{hint}",
                best.join(" or "),
                fits[0].correlation,
                own.correlation,
                fits[0].axes
            )
        })
    }

    /// Lists each part with its verdict; neighbouring levels of one verdict share a line.
    pub fn parts(&self) -> Vec<(String, &str)> {
        let mut parts: Vec<(String, &str)> = Vec::new();
        let mut first = 0;
        for (level, score) in self.levels.iter().enumerate() {
            if level > 0 && self.levels[level - 1].verdict == score.verdict {
                parts.pop();
            } else {
                first = level;
            }
            let name = if first == level { format!("level {level}") } else { format!("levels {first} to {level}") };
            parts.push((name, &score.verdict));
        }
        let one = |name: &str, verdict| (name.to_owned(), verdict);
        parts.extend(self.irradiance.iter().map(|score| one("irradiance", score.verdict.as_str())));
        parts.extend(self.sh.iter().map(|score| one("SH", score.verdict.as_str())));
        parts.extend(self.dfg.iter().map(|score| one("DFG table", score.verdict.as_str())));
        parts
    }

    /// Summarises the faults in one line, the cause of the most levels first; `None` without faults.
    pub fn wrong(&self) -> Option<String> {
        let doubt = self.axes.iter().find_map(|(what, fits)| self.doubt(what, fits));
        if let Some(cause) = doubt.or_else(|| self.chain.clone()) {
            return Some(format!("wrong: {cause}"));
        }
        let wrong = self.parts().into_iter().filter(|(_, verdict)| !verdict.starts_with(GOOD_WORDS));
        let said: Vec<String> = wrong.map(|(name, verdict)| format!("{name}: {verdict}")).collect();
        (!said.is_empty()).then(|| format!("wrong: {}", said.join("; ")))
    }

    /// Sums up the whole bake in one line.
    pub fn verdict(&self) -> String {
        let coarse = self.levels.iter().filter_map(LevelScore::coarseness);
        self.wrong().unwrap_or_else(|| match coarse.max_by(f64::total_cmp) {
            None => "good: every part is within 3 % rms of its integral".to_owned(),
            Some(relmse) => format!(
                "good, but coarse: linear lookups between texels err by up to {:.1} % rms",
                100.0 * relmse.sqrt()
            ),
        })
    }
}
