//! Scores of the scene `design` under a weight of views, made from its bins of n·v.

use super::{Bin, BinRange, Bins, Finished, FinishedCell, MetricValues};
use crate::base::names::{Listed, not_one_of};
use crate::experiment::axis::SCENE;
use crate::experiment::value::Value;
use crate::instrument::metrics::{Metric, Part, Weight};
use crate::instrument::scene::{SCENES, is_design};
use indexmap::IndexSet;

/// How much a bin counts.
enum Density {
    /// As its n·v in a picture of a sphere: its part of ∫ 2 n·v dn·v.
    Picture,
    /// By its pixels.
    Uniform,
    /// By the pixels of a scene's bins with the same n·v.
    Scene(Vec<BinRange>),
}

impl Density {
    fn of_bin(&self, bin: &BinRange) -> f64 {
        match self {
            Self::Picture => bin.hi.min(1.0).powi(2) - bin.lo.powi(2),
            Self::Uniform => bin.pixel_count as f64,
            Self::Scene(ranges) => ranges
                .iter()
                .find(|other| other.lo == bin.lo)
                .map_or(0.0, |other| other.pixel_count as f64),
        }
    }
}

/// A bin and how much it counts.
struct WeightedBin {
    weight: f64,
    bin: Bin,
}

/// The numbers of several bins together.
struct Pooled {
    scores: MetricValues,
    noise_floors: MetricValues,
}

impl Finished {
    /// The run scored by the pixels with n·v from `lo` to `hi` alone, under its weight; `None`
    /// without bins.
    pub fn within_n_dot_v(&self, [lo, hi]: [f64; 2]) -> Option<Self> {
        if self.cells.iter().all(|cell| cell.bins.is_empty()) {
            return None;
        }
        let density = self.density(&self.weight);
        let of_bin = |bin: &BinRange| {
            if bin.lo >= lo && bin.hi <= hi {
                density.of_bin(bin)
            } else {
                0.0
            }
        };
        let cells = self.cells.iter().map(|cell| {
            let pooled = cell.pooled(&self.weight, of_bin);
            FinishedCell {
                scores: cell.scores.as_ref().map(|_| pooled.scores),
                noise_floors: pooled.noise_floors,
                bins: Bins::default(),
                ..cell.clone()
            }
        });
        Some(Self {
            cells: cells.collect(),
            ..self.clone()
        })
    }

    /// The run with the scores of designs under a weight of views. Within a bin views count by
    /// their n·v, unless all count alike. A metric whose bins do not determine the whole has no
    /// score; a noise floor that older runs do not record by bin stays as it is.
    pub fn weighted(&self, weight: &Weight) -> Self {
        let density = self.density(weight);
        let cells = self.cells.iter().map(|cell| {
            let is_design = is_design(&cell.point[SCENE].to_string());
            if *weight == Weight::Uniform || !is_design || cell.bins.is_empty() {
                return cell.clone();
            }
            let pooled = cell.pooled(weight, |bin| density.of_bin(bin));
            let floor = |name: &str| {
                let pooled = pooled.noise_floors.get(name);
                pooled.or(cell.noise_floors.get(name))
            };
            FinishedCell {
                noise_floors: MetricValues::from_fn(floor),
                scores: cell.scores.as_ref().map(|_| pooled.scores),
                ..cell.clone()
            }
        });
        Self {
            cells: cells.collect(),
            weight: weight.clone(),
            ..self.clone()
        }
    }

    fn density(&self, weight: &Weight) -> Density {
        match weight {
            Weight::Picture => Density::Picture,
            Weight::Uniform => Density::Uniform,
            Weight::Scene(scene) => {
                let cells = self.cells.iter();
                let bins = cells
                    .filter(|cell| cell.point[SCENE].to_string() == *scene)
                    .map(|cell| &cell.bins)
                    .find(|bins| !bins.is_empty());
                Density::Scene(bins.map_or_else(Vec::new, |bins| bins.ranges().to_vec()))
            }
        }
    }

    /// Answers by these weights, the leading one first; an error says which one the run does not
    /// have.
    pub fn with_weights(self, names: &[String]) -> Result<Self, String> {
        let weights: Vec<Weight> = names.iter().map(|name| Weight::of_name(name)).collect();
        let scenes: IndexSet<Value> = self
            .cells
            .iter()
            .map(|cell| cell.point[SCENE].clone())
            .collect();
        weights
            .iter()
            .try_for_each(|weight| check_weight(weight, &scenes))?;
        if let Some(twice) =
            (1..weights.len()).find(|index| weights[..*index].contains(&weights[*index]))
        {
            return Err(format!("{} is listed twice", names[twice]));
        }
        if self.cells.iter().all(|cell| cell.bins.is_empty()) {
            return Err(
                "needs errors_by_n_dot_v.csv, which the run does not have; run the \
                        experiment again"
                    .to_owned(),
            );
        }
        Ok(Self { weights, ..self })
    }
}

/// Checks that the scene of a weight is among the rendered ones.
pub fn check_weight<'v>(
    weight: &Weight,
    rendered: impl IntoIterator<Item = &'v Value>,
) -> Result<(), String> {
    let Weight::Scene(scene) = weight else {
        return Ok(());
    };
    let pictures: Vec<String> = rendered
        .into_iter()
        .map(Value::to_string)
        .filter(|scene| !scene.is_empty() && !is_design(scene))
        .collect();
    let known: Vec<&str> = Weight::NAMES
        .into_iter()
        .chain(pictures.iter().map(String::as_str))
        .collect();
    if pictures.contains(scene) {
        Ok(())
    } else if is_design(scene) {
        Err(format!("the scene {scene} is not a picture; write uniform"))
    } else if SCENES.iter().any(|known| known.name == scene) {
        Err(format!(
            "the scene {scene} is not rendered; add it to axes.scene, or choose {}",
            known.join(", ")
        ))
    } else {
        Err(not_one_of("weight", scene, &known, ""))
    }
}

impl FinishedCell {
    /// The bins together, each counted as `density` says.
    fn pooled(&self, weight: &Weight, density: impl Fn(&BinRange) -> f64) -> Pooled {
        let mut bins: Vec<WeightedBin> = self
            .bins
            .iter()
            .map(|bin| WeightedBin {
                weight: density(&bin.range),
                bin,
            })
            .collect();
        bins.retain(|weighted| weighted.bin.range.pixel_count > 0);
        bins.sort_by(|a, b| a.bin.range.lo.total_cmp(&b.bin.range.lo));
        let is_tilted = *weight != Weight::Uniform;
        Pooled {
            scores: MetricValues::from_fn(|name| {
                let parts = parts(&bins, |bin| bin.scores.get(name))?;
                Metric::listed(name).pooled(&parts, is_tilted)
            }),
            noise_floors: MetricValues::from_fn(|name| {
                let parts = parts(&bins, |bin| bin.noise_floors.get(name))?;
                Metric::listed(name).pooled_floor(&parts, is_tilted)
            }),
        }
    }
}

/// A number of each weighted bin; `None` if a bin has none.
fn parts(bins: &[WeightedBin], number: impl Fn(&Bin) -> Option<f64>) -> Option<Vec<Part>> {
    let part = |WeightedBin { weight, bin }: &WeightedBin| {
        Some(Part {
            n_dot_v: [bin.range.lo, bin.range.hi.min(1.0)],
            weight: *weight,
            value: number(bin)?,
            reference_mean: bin.reference_mean,
        })
    };
    bins.iter().map(part).collect()
}
