//! `splitsum cost`, and the hidden command of its child.

use super::flags::flag;
use super::shared::{check_out, own_method};
use super::{Failure, log, print};
use clap::builder::ValueParser;
use clap::{ArgAction, ArgMatches, Args, Command, FromArgMatches};
use splitsum::cost::child::{CompileFault, Compiler, Job, available, serve};
use splitsum::cost::family::{FAMILIES, Family};
use splitsum::cost::isa::Counts;
use splitsum::cost::pass::passes;
use splitsum::cost::table::{Shaded, csv, markdown};
use splitsum::experiment::axis::{AXES, BRDF, METHOD, Named, Point};
use splitsum::experiment::value::{Kind, Value};
use splitsum::shade::{FILE_PREFIX, METHODS};
use splitsum::spelling::{Listed, expected};
use std::path::PathBuf;

const ALL: &str = "all";

/// Count instructions, registers and lookups of compiled shaders for AMD GPUs.
#[derive(Args, Debug)]
#[command(after_help = after_help())]
pub struct Arguments {
    /// Compile for these families, or all [default: the newest that Mesa has].
    #[arg(long, value_name = "NAME", value_delimiter = ',', value_parser = family)]
    family: Vec<Asked>,
    /// Write all counts to FILE as CSV.
    #[arg(long, value_name = "FILE.csv")]
    out: Option<PathBuf>,
    #[command(flatten)]
    compiled: SweptFlags,
}

/// A family; `None` for all.
#[derive(Clone, Debug)]
struct Asked(Option<&'static Family>);

/// Axes with any number of values: flags repeated, with commas, or `all` of a list.
#[derive(Debug, Default)]
struct SweptFlags(Vec<(usize, Vec<Value>)>);

impl SweptFlags {
    fn get(&self, axis: usize) -> Option<&[Value]> {
        self.0.iter().find(|(own, _)| *own == axis).map(|(_, values)| &values[..])
    }
}

impl Args for SweptFlags {
    /// Adds a flag for every axis and hides those that change no code.
    fn augment_args(command: Command) -> Command {
        let values = |named: Named| {
            move |text: &str| match named.kind() {
                Kind::Name { names, .. } | Kind::NameOrFile { names, .. } if text == ALL => {
                    Ok(names().into_iter().map(Value::from).collect())
                }
                _ => text.split(',').map(|part| named.parse_text(part)).collect::<Result<Vec<Value>, String>>(),
            }
        };
        let methods = leading();
        let is_shown = |axis| axis == METHOD || changes_code(axis, &[], &methods);
        let flag = |named: Named| flag(named, ValueParser::new(values(named))).action(ArgAction::Append);
        let flags = Named::all().map(|named| flag(named).hide(!is_shown(named.axis)));
        let names = methods.iter().map(Value::to_string).collect::<Vec<_>>().join(",");
        let help = format!("Methods, or all (`splitsum list methods`) [default: {names}]");
        command.args(flags).mut_arg(AXES[METHOD].name, |arg| arg.help(help))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for SweptFlags {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut flags = Self::default();
        flags.update_from_arg_matches(matches).map(|()| flags)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        let values = |named: Named| Some((named.axis, matches.get_many::<Vec<Value>>(named.name())?));
        self.0 =
            Named::all().filter_map(values).map(|(axis, values)| (axis, values.flatten().cloned().collect())).collect();
        Ok(())
    }
}

fn after_help() -> String {
    let families =
        FAMILIES.iter().map(|Family { name, generation, card, .. }| format!("  {name:8} {generation}, {card}\n"));
    format!(
        "\
Mesa's RADV compiles the program's own shaders for GPUs that this machine does not have (Debian: apt-get install mesa-vulkan-drivers). \
The command counts their instructions inside and outside the loop over samples. Nothing is executed or timed.

Families, each with one of its cards:
{}
Every flag but --out takes several values after commas, or all; each combination is compiled.

Examples:
  splitsum cost
  splitsum cost --method all --family all --out costs.csv
  splitsum cost --method file:my.glsl,split-sum --masking all --compensation none,turquin --family navi21",
        families.collect::<String>()
    )
}

/// Returns the first sampled method, and the split sums with the fewest and the most lookups.
fn leading() -> Vec<Value> {
    let split_sums = || METHODS.iter().filter(|method| method.has_pass() && method.uses_dfg);
    let methods = [
        METHODS.iter().find(|method| method.has_pass() && method.uses_samples),
        split_sums().min_by_key(|method| method.lookups),
        split_sums().max_by_key(|method| method.lookups),
    ];
    methods.into_iter().flatten().map(|method| Value::from(method.name)).collect()
}

/// Returns the job of a point with another value on an axis.
fn job(point: &Point, axis: usize, value: &Value) -> Job {
    let mut point = point.clone();
    point[axis] = value.clone();
    point.collapsed(false).settings().specular_job()
}

/// Whether other values of an axis, listed or given, would change the code.
fn depends_on(point: &Point, axis: usize, given: &[Value]) -> bool {
    let names = match AXES[axis].kind {
        Kind::Name { names, .. } | Kind::NameOrFile { names, .. } => names().into_iter().map(Value::from).collect(),
        _ => vec![(AXES[axis].default)()],
    };
    let mut jobs = names.iter().chain(given).map(|value| job(point, axis, value));
    let first = jobs.next();
    jobs.any(|job| Some(job) != first)
}

fn changes_code(axis: usize, given: &[Value], methods: &[Value]) -> bool {
    methods.iter().any(|method| {
        let mut point = Point::default();
        point[METHOD] = method.clone();
        depends_on(&point, axis, given)
    })
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

/// Combines the given values; drops passes whose code is known.
fn asked(flags: &SweptFlags) -> Result<Vec<(Point, Job)>, Failure> {
    let methods = flags.get(METHOD).map_or_else(leading, <[Value]>::to_vec);
    for file in methods.iter().filter(|method| method.text().starts_with(FILE_PREFIX)) {
        own_method(file.text())?;
    }
    let mut points: Vec<Point> = methods
        .iter()
        .map(|method| {
            let mut point = Point::default();
            point[METHOD] = method.clone();
            point
        })
        .collect();
    let (shaded, left_out): (Vec<Point>, Vec<Point>) = points.drain(..).partition(|point| point.method().has_pass());
    let names = |points: &[Point]| points.iter().map(|point| point.method().name).collect::<Vec<_>>().join(", ");
    if shaded.is_empty() {
        let known = METHODS.iter().filter(|method| method.has_pass()).map(|method| method.name).collect::<Vec<_>>();
        let (names, known) = (names(&left_out), expected("method", &known));
        return Err(Failure::input(format!("--method {names}: no shading pass to compile; expected {known}")));
    }
    if !left_out.is_empty() {
        log(&format!("skipped {}: no shading pass to compile", names(&left_out)));
    }
    points = shaded;
    for (axis, values) in flags.0.iter().filter(|(axis, _)| *axis != METHOD) {
        let methods: Vec<Value> = points.iter().map(|point| point[METHOD].clone()).collect();
        if !changes_code(*axis, values, &methods) {
            let (name, methods) = (AXES[*axis].name.replace('_', "-"), names(&points));
            return Err(Failure::input(format!("--{name}: has no effect on {methods}; leave it out")));
        }
    }
    for (axis, values) in flags.0.iter().filter(|(axis, _)| *axis != METHOD) {
        let with = |point: &Point, value: &Value| {
            let mut point = point.clone();
            point[*axis] = value.clone();
            point
        };
        points = points.iter().flat_map(|point| values.iter().map(move |value| with(point, value))).collect();
    }
    let mut asked: Vec<(Point, Job)> = Vec::new();
    for point in points {
        let job = point.collapsed(false).settings().specular_job();
        if asked.iter().all(|(_, known)| *known != job) {
            asked.push((point, job));
        }
    }
    Ok(asked)
}

fn compiled(arguments: &Arguments) -> Result<Vec<Shaded>, Failure> {
    let flags = &arguments.compiled;
    let asked = asked(flags)?;
    let program = std::env::current_exe().map_err(Failure::failed)?;
    super::progress::doing("compiling shaders");
    let found = available(&program).map_err(failure)?;
    let jobs: Vec<Job> = asked.iter().map(|(_, job)| job.clone()).collect();
    let mut shaded = Vec::new();
    for (family, compiler) in families(&arguments.family, found)? {
        for ((point, job), pass) in asked.iter().zip(passes(&program, family, &jobs).map_err(failure)?) {
            let method = point.method();
            let fault = |text: String| Failure::failed(format!("{}: '{}': {text}", family.name, job.shader));
            if method.uses_samples && pass.counts.inside == Counts::default() {
                return Err(fault("no loop over samples found in its assembly".to_owned()));
            }
            if pass.counts.other_loops > 0 {
                log(&format!(
                    "{}: '{}' has {} more loops; each counts once",
                    family.name, job.shader, pass.counts.other_loops
                ));
            }
            let is_shown = |axis: usize, values: &[Value]| depends_on(point, axis, values);
            let options =
                flags.0.iter().filter(|(axis, values)| ![METHOD, BRDF].contains(axis) && is_shown(*axis, values));
            let options: Vec<String> =
                options.map(|(axis, _)| format!("{}={}", AXES[*axis].name, point[*axis])).collect();
            let settings = point.settings();
            shaded.push(Shaded {
                family,
                driver: compiler.driver.clone(),
                method: method.name,
                brdf: if is_shown(BRDF, &[]) { settings.shading.brdf.name() } else { "" },
                layout: settings.shading.precompute.layout.name,
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
    let missing = |family: &&Family| !names.contains(&family.name);
    if let Some(lacking) = asked.iter().filter_map(|asked| asked.0).find(missing) {
        let (lacking, names) = (lacking.name, names.join(", "));
        return Err(Failure::input(format!("--family {lacking}: {driver} does not compile for it; it has {names}")));
    }
    if asked.iter().any(|asked| asked.0.is_none()) {
        for family in FAMILIES.iter().filter(missing) {
            log(&format!("skipped {}: {driver} does not compile for it", family.name));
        }
        return Ok(found);
    }
    if asked.is_empty() {
        return Ok(found.pop().into_iter().collect());
    }
    found.retain(|(family, _)| asked.iter().any(|asked| asked.0.is_some_and(|asked| asked.name == family.name)));
    Ok(found)
}

/// A missing compiler is bad input, a failing one a failure.
fn failure(fault: CompileFault) -> Failure {
    Failure::of(matches!(fault, CompileFault::NoRadv { .. }), fault)
}

/// Runs the hidden command.
pub fn compile_shaders() -> Result<(), Failure> {
    serve(std::io::stdin().lock(), std::io::stdout().lock()).map_err(Failure::failed)
}
