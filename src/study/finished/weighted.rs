//! Scores of the scene `design` under a weight of views, made from its bins of n·v.

use super::{Bin, Finished, FinishedCell, MetricValues};
use crate::base::names::{Listed, not_one_of};
use crate::experiment::axis::SCENE;
use crate::experiment::value::Value;
use crate::instrument::metrics::{Metric, Part, Weight};
use crate::instrument::scene::{SCENES, is_design};
use indexmap::IndexSet;
use std::sync::Arc;

impl Finished {
    /// The run scored by the pixels with n·v from `lo` to `hi` alone, under its weight; `None`
    /// without bins.
    pub fn within_n_dot_v(&self, [lo, hi]: [f64; 2]) -> Option<Self> {
        let density = self.density(&self.weight);
        let is_own = |bin: &Bin| bin.lo >= lo && bin.hi <= hi;
        let cell = |cell: &FinishedCell| {
            let (scores, noise_floors) =
                cell.pooled(
                    &self.weight,
                    |bin| if is_own(bin) { density(bin) } else { 0.0 },
                );
            let scores = cell.scores.as_ref().map(|_| scores);
            FinishedCell {
                scores,
                noise_floors,
                bins: Arc::default(),
                ..cell.clone()
            }
        };
        let has_bins = self.cells.iter().any(|cell| !cell.bins.is_empty());
        has_bins.then(|| Self {
            cells: self.cells.iter().map(cell).collect(),
            ..self.clone()
        })
    }

    /// The run with the scores of designs under a weight of views. Within a bin views count by
    /// their n·v, unless all count alike. A metric whose bins do not determine the whole has no
    /// score; a noise floor that older runs do not record by bin stays as it is.
    pub fn weighted(&self, weight: &Weight) -> Self {
        let density = self.density(weight);
        let cell = |cell: &FinishedCell| {
            if *weight == Weight::Uniform
                || !is_design(&cell.point[SCENE].to_string())
                || cell.bins.is_empty()
            {
                return cell.clone();
            }
            let (scores, floors) = cell.pooled(weight, &density);
            let floor = |name: &str| floors.get(name).or(cell.noise_floors.get(name));
            let scores = cell.scores.as_ref().map(|_| scores);
            FinishedCell {
                scores,
                noise_floors: MetricValues::of(floor),
                ..cell.clone()
            }
        };
        Self {
            cells: self.cells.iter().map(cell).collect(),
            weight: weight.clone(),
            ..self.clone()
        }
    }

    fn density(&self, weight: &Weight) -> impl Fn(&Bin) -> f64 + use<> {
        let of_scene = |scene: &str| {
            let cells = self
                .cells
                .iter()
                .filter(|cell| cell.point[SCENE].to_string() == scene);
            cells
                .map(|cell| &cell.bins)
                .find(|bins| !bins.is_empty())
                .cloned()
                .unwrap_or_default()
        };
        let (is_picture, shown) = match weight {
            Weight::Picture => (true, None),
            Weight::Uniform => (false, None),
            Weight::Scene(scene) => (false, Some(of_scene(scene))),
        };
        move |bin| match &shown {
            Some(shown) => shown
                .iter()
                .find(|other| other.lo == bin.lo)
                .map_or(0.0, |other| other.pixel_count as f64),
            None if is_picture => bin.hi.min(1.0).powi(2) - bin.lo.powi(2),
            None => bin.pixel_count as f64,
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
            (1..weights.len()).find(|place| weights[..*place].contains(&weights[*place]))
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
    match () {
        () if pictures.contains(scene) => Ok(()),
        () if is_design(scene) => Err(format!("the scene {scene} is not a picture; write uniform")),
        () if SCENES.iter().any(|known| known.name == scene) => Err(format!(
            "the scene {scene} is not rendered; add it to axes.scene, or choose {}",
            known.join(", ")
        )),
        () => Err(not_one_of("weight", scene, &known, "")),
    }
}

impl FinishedCell {
    /// Scores and noise floors of the bins together, each counted as `density` says.
    fn pooled(
        &self,
        weight: &Weight,
        density: impl Fn(&Bin) -> f64,
    ) -> (MetricValues, MetricValues) {
        let mut bins: Vec<(f64, &Bin)> = self.bins.iter().map(|bin| (density(bin), bin)).collect();
        bins.retain(|(_, bin)| bin.pixel_count > 0);
        bins.sort_by(|(_, a), (_, b)| a.lo.total_cmp(&b.lo));
        let parts = |of: fn(&Bin) -> &MetricValues, name: &str| {
            let part = |(weight, bin): &(f64, &Bin)| {
                let (n_dot_v, value) = ([bin.lo, bin.hi.min(1.0)], of(bin).get(name)?);
                Some(Part {
                    n_dot_v,
                    weight: *weight,
                    value,
                    reference_mean: bin.reference_mean,
                })
            };
            bins.iter().map(part).collect::<Option<Vec<Part>>>()
        };
        let (metric, is_tilted) = (|name| Metric::listed(name), *weight != Weight::Uniform);
        (
            MetricValues::of(|name| {
                metric(name).pooled(&parts(|bin| &bin.scores, name)?, is_tilted)
            }),
            MetricValues::of(|name| {
                metric(name).pooled_floor(&parts(|bin| &bin.noise_floors, name)?, is_tilted)
            }),
        )
    }
}
