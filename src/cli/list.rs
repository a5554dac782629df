//! `splitsum list`: every name for files and flags.

use super::{Failure, print, print_data};
use clap::{Args, ValueEnum};
use splitsum::bake::ENVIRONMENT_FORMATS;
use splitsum::base::math::sequence::SEQUENCES;
use splitsum::base::names::Listed;
use splitsum::draw::markdown::{Align, MarkdownTable};
use splitsum::experiment::axis::Named;
use splitsum::experiment::value::Value;
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
    for (name, about) in entries(what) {
        table.row(&[name, about]);
    }
    table.to_string()
}

/// The entries of a list: name and meaning.
fn entries(what: What) -> Vec<(String, String)> {
    match what {
        What::Methods => named(shade::METHODS, |method| (method.name, method.about)),
        What::Diffuse => named(shade::DIFFUSE, |diffuse| (diffuse.name, diffuse.about)),
        What::Layouts => named(LAYOUTS, |layout| (layout.name, layout.about)),
        What::Models => named(brdf::MODELS, |model| (model.name(), model.about())),
        What::Bends => named(BENDS, |bend| (bend.name, bend.about)),
        What::CoatRenderers => named(COAT_RENDERERS, |coat| (coat.name, coat.about)),
        What::SheenLookups => named(SHEEN_LOOKUPS, |lookup| (lookup.name, lookup.about)),
        What::Questions => named(QUESTIONS, |question| (question.name, question.asks)),
        What::Sequences => named(SEQUENCES, |sequence| (sequence.name, sequence.about)),
        What::LevelMappings => named(LEVEL_MAPPINGS, |mapping| (mapping.name, mapping.about)),
        What::PrefilterWeights => named(WEIGHTS, |weight| (weight.name, weight.about)),
        What::LevelBiases => LEVEL_BIASES
            .iter()
            .map(|bias| {
                let about = format!("{:.4} levels: {}", bias.levels, bias.about);
                (bias.name.to_owned(), about)
            })
            .collect(),
        What::Environments => environments(),
        What::Scenes => {
            let mut scenes = named(scene::SCENES, |scene| (scene.name, scene.description));
            for format in scene::SCENE_FORMATS {
                scenes.push((
                    format!("FILE.{}", format.extension),
                    format.about.to_owned(),
                ));
            }
            scenes
        }
        What::Metrics => metrics::METRICS
            .iter()
            .map(|metric| {
                let about = format!(
                    "{}; {} values, {} is better",
                    metric.formula,
                    metric.space.name(),
                    metric.better.name()
                );
                (metric.name.to_owned(), about)
            })
            .collect(),
        What::Axes => Named::all()
            .map(|axis| (axis.name().to_owned(), about_axis(axis)))
            .collect(),
        What::Columns => Vec::new(),
    }
}

/// The entries of a list whose items have a name and a meaning.
fn named<T>(
    list: &[T],
    name_and_about: impl Fn(&T) -> (&'static str, &'static str),
) -> Vec<(String, String)> {
    list.iter()
        .map(name_and_about)
        .map(|(name, about)| (name.to_owned(), about.to_owned()))
        .collect()
}

fn environments() -> Vec<(String, String)> {
    let mut entries = Vec::new();
    for builtin in BUILTINS {
        let name = format!("builtin:{}", builtin.name);
        entries.push((name.clone(), builtin.about.to_owned()));
        for parameter in builtin.parameters {
            let about = format!(
                "{} (default {}, in [{}, {}])",
                parameter.about, parameter.default, parameter.min, parameter.max
            );
            entries.push((format!("{name}:{}=", parameter.name), about));
        }
    }
    for format in FORMATS.iter().chain(ENVIRONMENT_FORMATS) {
        entries.push((
            format!("FILE.{}", format.extension),
            format.about.to_owned(),
        ));
    }
    entries
}

/// The meaning of an axis, its values and its default.
fn about_axis(axis: Named) -> String {
    let mut about = format!("{}; {}", axis.about(), axis.kind().describe());
    if let Some(form) = axis.kind().set_form() {
        about += &format!("; with --set {form}");
    }
    let default = (axis.entry().default)();
    if default != Value::Unset && !axis.is_second() {
        about += &format!("; default {default}");
    } else if axis.entry().unset.is_none() {
        // The text of an axis whose default depends on the layout has it.
        about += "; default the scene's own";
    }
    about
}
