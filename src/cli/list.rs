//! `splitsum list`: every name for files and flags.

use super::{Failure, print, print_data};
use clap::{Args, ValueEnum};
use splitsum::base::math::sequence::SEQUENCES;
use splitsum::base::names::Listed;
use splitsum::draw::markdown::{Align, MarkdownTable};
use splitsum::experiment::axis::Named;
use splitsum::instrument::environment::layout::LAYOUTS;
use splitsum::instrument::environment::{BUILTINS, FORMATS};
use splitsum::instrument::precompute::prefilter::level_bias::LEVEL_BIASES;
use splitsum::instrument::precompute::prefilter::{LEVEL_MAPPINGS, WEIGHTS};
use splitsum::instrument::shade::bend::BENDS;
use splitsum::instrument::shade::coat::COAT_RENDERERS;
use splitsum::instrument::shade::sheen::SHEEN_LOOKUPS;
use splitsum::instrument::{brdf, metrics, scene, shade};
use splitsum::study::columns;
use splitsum::study::questions::QUESTIONS;

/// List names for files and flags.
#[derive(Args, Debug)]
#[command(after_help = "Examples:\n  splitsum list\n  splitsum list axes")]
pub struct Arguments {
    /// List only these [default: everything].
    what: Option<What>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum What {
    Methods,
    Diffuse,
    /// BRDF models.
    #[value(alias = "brdfs")]
    Models,
    Environments,
    Scenes,
    Metrics,
    Axes,
    Sequences,
    /// Layouts of filtered maps.
    Layouts,
    /// Roughness of the levels of a prefiltered map.
    LevelMappings,
    PrefilterWeights,
    /// Level biases of known prefilters.
    LevelBiases,
    /// Whose way to look up an anisotropic lobe.
    Bends,
    /// Whose way to shade a clear coat.
    CoatRenderers,
    /// Whose way to look up sheen.
    SheenLookups,
    Questions,
    /// The text of docs/columns.md.
    Columns,
}

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    match arguments.what {
        Some(What::Columns) => print_data(&columns::page()),
        Some(what) => print(&listing(what)),
        None => What::value_variants()
            .iter()
            .filter(|what| !matches!(what, What::Columns))
            .try_for_each(|what| {
                let name = what
                    .to_possible_value()
                    .map_or_else(String::new, |value| value.get_name().to_owned());
                print(&format!("# {name}\n\n{}\n", listing(*what)))
            }),
    }
}

fn listing(what: What) -> String {
    let mut table = MarkdownTable::new(&[("name", Align::Left), ("what it is", Align::Left)]);
    let mut add = |name: &str, about: &str| table.row(&[name, about]);
    match what {
        What::Methods => shade::METHODS
            .iter()
            .for_each(|method| add(method.name, method.about)),
        What::Diffuse => shade::DIFFUSE
            .iter()
            .for_each(|diffuse| add(diffuse.name, diffuse.about)),
        What::Layouts => LAYOUTS
            .iter()
            .for_each(|layout| add(layout.name, layout.about)),
        What::Models => brdf::MODELS
            .iter()
            .for_each(|model| add(model.name(), model.about())),
        What::Environments => {
            for builtin in BUILTINS {
                add(&format!("builtin:{}", builtin.name), builtin.about);
                for p in builtin.parameters {
                    let range = format!(
                        "{} (default {}, in [{}, {}])",
                        p.about, p.default, p.min, p.max
                    );
                    add(&format!("builtin:{}:{}=", builtin.name, p.name), &range);
                }
            }
            FORMATS
                .iter()
                .for_each(|format| add(&format!("FILE.{}", format.extension), format.about));
        }
        What::Scenes => {
            scene::SCENES
                .iter()
                .for_each(|entry| add(entry.name, entry.description));
            scene::SCENE_FORMATS
                .iter()
                .for_each(|format| add(&format!("FILE.{}", format.extension), format.about));
        }
        What::Metrics => {
            for metric in metrics::METRICS {
                let (space, better) = (metric.space.name(), metric.better.name());
                add(
                    metric.name,
                    &format!("{}; {space} values, {better} is better", metric.formula),
                );
            }
        }
        What::Bends => BENDS.iter().for_each(|bend| add(bend.name, bend.about)),
        What::CoatRenderers => COAT_RENDERERS
            .iter()
            .for_each(|renderer| add(renderer.name, renderer.about)),
        What::SheenLookups => SHEEN_LOOKUPS
            .iter()
            .for_each(|lookup| add(lookup.name, lookup.about)),
        What::Questions => QUESTIONS
            .iter()
            .for_each(|question| add(question.name, question.asks)),
        What::Columns => {}
        What::Sequences => SEQUENCES
            .iter()
            .for_each(|sequence| add(sequence.name, sequence.about)),
        What::LevelMappings => LEVEL_MAPPINGS
            .iter()
            .for_each(|mapping| add(mapping.name, mapping.about)),
        What::PrefilterWeights => WEIGHTS
            .iter()
            .for_each(|weight| add(weight.name, weight.about)),
        What::LevelBiases => {
            LEVEL_BIASES.iter().for_each(|bias| {
                add(
                    bias.name,
                    &format!("{:.4} levels: {}", bias.levels, bias.about),
                )
            });
        }
        What::Axes => {
            for named in Named::all() {
                let default = if named.is_second() {
                    String::new()
                } else {
                    (named.entry().default)().to_string()
                };
                let unset = if named.about().contains("[default") {
                    ""
                } else {
                    "; default the scene's own"
                };
                let default = if default.is_empty() {
                    unset.to_owned()
                } else {
                    format!("; default {default}")
                };
                let form = named
                    .kind()
                    .set_form()
                    .map_or_else(String::new, |form| format!("; with --set {form}"));
                add(
                    named.name(),
                    &format!(
                        "{}; {}{form}{default}",
                        named.about(),
                        named.kind().describe()
                    ),
                );
            }
        }
    }
    table.to_string()
}
