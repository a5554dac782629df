//! `splitsum cost`, and the hidden command of its child.

use super::flags::AxisFlags;
use super::shared::{check_out, load_file_method};
use super::{Failure, log, print};
use clap::builder::ValueParser;
use clap::{Arg, ArgAction, Args};
use splitsum::base::names::Listed;
use splitsum::cost::child::{CompileFault, Compiler, available, serve};
use splitsum::cost::family::{FAMILIES, Family};
use splitsum::cost::isa::Counts;
use splitsum::cost::pass::passes;
use splitsum::cost::table::{Shaded, csv, markdown};
use splitsum::experiment::axis::{AXES, BRDF, METHOD, Named, Point};
use splitsum::experiment::value::Value;
use splitsum::instrument::gpu::ShaderVariant;
use splitsum::instrument::shade::METHODS;
use std::path::PathBuf;

const ALL: &str = "all";
const AXES_OF_CODE: [&str; 9] = [
    "method",
    "brdf",
    "layout",
    "masking",
    "compensation",
    "pixel_points",
    "level_mapping",
    "dfg",
    "bend",
];
/// A sampled method, and the split sums with the fewest and the most lookups.
const LEADING: [&str; 3] = ["sampled", "split-sum", "split-sum-four"];

/// Count instructions, registers and lookups of compiled shaders for AMD GPUs.
#[derive(Args, Debug)]
#[command(after_help = after_help(), mut_args(shown), mut_arg(AXES[METHOD].name, several))]
pub struct Arguments {
    /// Compile for these families, or all that Mesa has [default: the newest].
    #[arg(long, value_name = "NAME", value_delimiter = ',', value_parser = family)]
    family: Vec<Asked>,
    /// Write all counts to FILE as CSV.
    #[arg(long, value_name = "FILE.csv")]
    out: Option<PathBuf>,
    #[command(flatten)]
    axes: AxisFlags,
}

/// A family; `None` for all.
#[derive(Clone, Debug)]
struct Asked(Option<&'static Family>);

/// Hides the flags of axes that change no code.
fn shown(arg: Arg) -> Arg {
    let is_other = |name: &str| Named::find(name).is_some() && !AXES_OF_CODE.contains(&name);
    if is_other(arg.get_id().as_str()) {
        arg.hide(true)
    } else {
        arg
    }
}

/// Lets the flag of the method take several of them.
fn several(arg: Arg) -> Arg {
    let parse = |text: &str| {
        if text == ALL {
            Ok(Value::from(ALL))
        } else {
            AXES[METHOD].kind.parse_text(text)
        }
    };
    arg.help("Methods after commas, or all (`splitsum list methods`)")
        .action(ArgAction::Append)
        .value_delimiter(',')
        .value_parser(ValueParser::new(parse))
        .default_values(LEADING)
}

fn after_help() -> String {
    let families = FAMILIES.iter().map(
        |Family {
             name,
             generation,
             card,
             ..
         }| format!("  {name:8} {generation}, {card}\n"),
    );
    format!(
        "\
Mesa's RADV compiles the program's own shaders for GPUs that this machine does not have (Debian: \
apt-get install mesa-vulkan-drivers). \
The command counts their instructions inside and outside the loop over samples. Nothing is \
executed or timed.

Families, each with one of its cards:
{}
Examples:
  splitsum cost
  splitsum cost --method all --family all --out costs.csv
  splitsum cost --method file:my.glsl,split-sum --layout octahedral --family navi21",
        families.collect::<String>()
    )
}

fn family(text: &str) -> Result<Asked, String> {
    match Family::parse(text) {
        Err(_) if text == ALL => Ok(Asked(None)),
        family => family.map(|family| Asked(Some(family))),
    }
}

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(out) = &arguments.out {
        check_out("--out", out, &["csv"], [])?;
    }
    let passes = compiled(arguments)?;
    if let Some(out) = &arguments.out {
        std::fs::write(out, csv(&passes))
            .map_err(|error| Failure::input(format!("--out: {}: {error}", out.display())))?;
    }
    print(&markdown(&passes))
}

fn points(arguments: &Arguments) -> Result<Vec<Point>, Failure> {
    let axes = &arguments.axes;
    if let Some(given) = axes
        .iter()
        .find(|given| !AXES_OF_CODE.contains(&AXES[given.axis].name))
    {
        return Err(Failure::input(format!(
            "--{}: changes no code; leave it out",
            given.flag
        )));
    }
    let mut methods: Vec<Value> = axes
        .iter()
        .filter(|given| given.axis == METHOD)
        .map(|given| given.value.clone())
        .collect();
    if methods.contains(&Value::from(ALL)) {
        methods = METHODS
            .iter()
            .filter(|method| method.has_pass())
            .map(|method| Value::from(method.name))
            .collect();
    }
    let point = |method: Value| {
        load_file_method(method.text())?;
        let mut point = axes.point();
        point[METHOD] = method;
        if !point.method().has_pass() {
            return Err(Failure::input(format!(
                "--method {}: has no shading pass to compile; leave it out",
                point.method().name
            )));
        }
        Ok(point)
    };
    methods.into_iter().map(point).collect()
}

fn compiled(arguments: &Arguments) -> Result<Vec<Shaded>, Failure> {
    let points = points(arguments)?;
    let program = std::env::current_exe().map_err(Failure::failed)?;
    super::progress::doing("compiling shaders");
    let found = available(&program).map_err(failure)?;
    let jobs: Vec<ShaderVariant> = points
        .iter()
        .map(|point| point.collapsed().settings().specular_variant())
        .collect();
    let options = arguments
        .axes
        .iter()
        .filter(|given| ![METHOD, BRDF].contains(&given.axis));
    let options: Vec<String> = options
        .map(|given| format!("{}={}", AXES[given.axis].name, given.value))
        .collect();
    let mut shaded = Vec::new();
    for (family, compiler) in families(&arguments.family, found)? {
        for ((point, job), pass) in points
            .iter()
            .zip(&jobs)
            .zip(passes(&program, family, &jobs).map_err(failure)?)
        {
            let method = point.method();
            let fault = |text: String| {
                Failure::failed(format!("{}: '{}': {text}", family.name, job.shader))
            };
            if method.uses_samples && pass.counts.inside == Counts::default() {
                return Err(fault(
                    "no loop over samples found in its assembly".to_owned(),
                ));
            }
            if pass.counts.other_loops > 0 {
                log(&format!(
                    "{}: '{}' has {} more loops; each counts once",
                    family.name, job.shader, pass.counts.other_loops
                ));
            }
            let shading = point.settings().shading;
            // Methods that do not use the model have one shader for all models.
            let has_model = job.shader.ends_with(&format!(":{}", shading.brdf.name()));
            shaded.push(Shaded {
                family,
                driver: compiler.driver.clone(),
                method: method.name,
                brdf: if has_model { shading.brdf.name() } else { "" },
                layout: shading.precompute.layout.name,
                options: options.join(" "),
                uses_samples: method.uses_samples,
                pass,
            });
        }
    }
    Ok(shaded)
}

/// Selects the requested families among the families of the driver; by default the newest.
fn families(
    asked: &[Asked],
    mut found: Vec<(&'static Family, Compiler)>,
) -> Result<Vec<(&'static Family, Compiler)>, Failure> {
    let driver = found[0].1.driver.clone();
    let names: Vec<&str> = found.iter().map(|(family, _)| family.name).collect();
    if let Some(lacking) = asked
        .iter()
        .filter_map(|asked| asked.0)
        .find(|family| !names.contains(&family.name))
    {
        return Err(Failure::input(format!(
            "--family {}: {driver} does not compile for it; it has {}",
            lacking.name,
            names.join(", ")
        )));
    }
    if asked.is_empty() {
        return Ok(found.pop().into_iter().collect());
    }
    found.retain(|(family, _)| {
        asked
            .iter()
            .any(|asked| asked.0.is_none_or(|asked| asked.name == family.name))
    });
    Ok(found)
}

/// A missing compiler is bad input, a failing one a failure.
fn failure(fault: CompileFault) -> Failure {
    Failure::by_misuse(matches!(fault, CompileFault::NoRadv { .. }), fault)
}

/// Runs the hidden command.
pub fn compile_shaders() -> Result<(), Failure> {
    serve(std::io::stdin().lock(), std::io::stdout().lock()).map_err(Failure::failed)
}
