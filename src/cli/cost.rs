//! `splitsum cost`, and the hidden command of its child.

use super::{Failure, print, tell};
use clap::Args;
use splitsum::brdf::{Brdf, MODELS};
use splitsum::cost::child::{CompileFault, available, serve};
use splitsum::cost::family::{FAMILIES, Family, Texel, family_by_name};
use splitsum::cost::isa::Counts;
use splitsum::cost::model::{job, passes};
use splitsum::environment::layout::{LAYOUTS, MapLayout};
use splitsum::shade::{METHODS, Method};
use splitsum::spelling::suggestion;
use splitsum::study::cost::{Costs, Shaded};
use splitsum::study::figure::svg::{WIDTHS, svg};
use std::path::PathBuf;

/// Bounds what the specular pass would cost on AMD GPUs that are not here, by a model of its compiled code.
#[derive(Args, Debug)]
#[command(after_help = "\
Mesa's RADV compiles the program's own shaders for GPUs that this machine does not have (Debian: apt-get install mesa-vulkan-drivers). The
command counts their instructions inside and outside the loop over samples and bounds the cycles a pixel with published rates:
  lower end   all units work at the same time; the busiest one counts; boost clock
  upper end   one unit works at a time; all of them add up; game clock
It is a model: nothing is executed and nothing is timed. Caches always hit and waves hide all latency; docs/cost.md has the constants
with their sources.

--out DIR writes costs.csv (all numbers), cost.md (the tables that are printed) and cost.svg (both ends over N).

Examples:
  splitsum cost
  splitsum cost --method split-sum --method sampled --brdf ggx --samples 1,8,64 --family navi21
  splitsum cost --texel rgba32f --out costs")]
pub struct Arguments {
    /// Methods that shade; every one when left out.
    #[arg(long, value_name = "NAME", value_parser = method)]
    method: Vec<&'static Method>,
    /// BRDF models; ggx when left out.
    #[arg(long, value_name = "NAME", value_parser = brdf)]
    brdf: Vec<&'static dyn Brdf>,
    /// Samples a pixel, 1 to 65536.
    #[arg(
        long, value_name = "N,N,...", value_delimiter = ',', default_value = "1,2,4,8,16,32,64,128,256,512,1024",
        value_parser = clap::value_parser!(u32).range(1..=65536)
    )]
    samples: Vec<u32>,
    /// Families of GPUs; every one that the installed Mesa has when left out.
    #[arg(long, value_name = "NAME", value_parser = family)]
    family: Vec<&'static Family>,
    /// How the maps' texels are stored: rgba16f or rgba32f. The code is the same, the texture unit's rate is not.
    #[arg(long, value_name = "FORMAT", default_value = Texel::ALL[0].0, value_parser = texel)]
    texel: (&'static str, Texel),
    /// Layout of the filtered maps.
    #[arg(long, value_name = "NAME", default_value = LAYOUTS[0].name, value_parser = layout)]
    layout: &'static MapLayout,
    /// The folder to write; it is made where it is missing.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// What is found by name in a list, or a message with the list.
fn named<T>(text: &str, what: &str, found: Option<T>, known: &[&str]) -> Result<T, String> {
    found.ok_or_else(|| format!("{text:?} is no {what}{}; expected {}", suggestion(text, known), known.join(", ")))
}

fn method(text: &str) -> Result<&'static Method, String> {
    let all: Vec<&Method> = METHODS.iter().filter(|method| method.has_pass()).collect();
    let names: Vec<&str> = all.iter().map(|method| method.name).collect();
    named(text, "method with a shading pass", all.iter().find(|method| method.name == text).copied(), &names)
}

fn brdf(text: &str) -> Result<&'static dyn Brdf, String> {
    let names: Vec<&str> = MODELS.iter().map(|model| model.name()).collect();
    named(text, "BRDF model", MODELS.iter().find(|model| model.name() == text).copied(), &names)
}

fn family(text: &str) -> Result<&'static Family, String> {
    let names: Vec<&str> = FAMILIES.iter().map(|family| family.name).collect();
    named(text, "family of the model", family_by_name(text), &names)
}

fn texel(text: &str) -> Result<(&'static str, Texel), String> {
    let names: Vec<&str> = Texel::ALL.iter().map(|(name, _)| *name).collect();
    named(text, "texel format", Texel::ALL.iter().find(|(name, _)| *name == text).copied(), &names)
}

fn layout(text: &str) -> Result<&'static MapLayout, String> {
    let names: Vec<&str> = LAYOUTS.iter().map(|layout| layout.name).collect();
    named(text, "layout", LAYOUTS.iter().find(|layout| layout.name == text), &names)
}

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let costs = costs(arguments)?;
    let text = costs.markdown();
    if let Some(out) = &arguments.out {
        let fault = |error| Failure::input(format!("--out: {}: {error}", out.display()));
        std::fs::create_dir_all(out).map_err(fault)?;
        let mut files = vec![("costs.csv", costs.csv()), ("cost.md", text.clone().into_bytes())];
        match costs.figure() {
            Some(figure) => files.push(("cost.svg", svg(&figure, WIDTHS[0]).into_bytes())),
            None => tell("no cost.svg: it shows costs over sample counts; expected --samples with two or more"),
        }
        files.into_iter().try_for_each(|(name, bytes)| std::fs::write(out.join(name), bytes)).map_err(fault)?;
    }
    print(&text)
}

fn costs(arguments: &Arguments) -> Result<Costs, Failure> {
    let program = std::env::current_exe().map_err(Failure::failed)?;
    let found = available(&program).map_err(failure)?;
    let names: Vec<&str> = found.iter().map(|(family, _)| family.name).collect();
    if let Some(lacking) = arguments.family.iter().find(|family| !names.contains(&family.name)) {
        let (lacking, driver, names) = (lacking.name, &found[0].1.driver, names.join(", "));
        return Err(Failure::input(format!("--family {lacking}: {driver} does not compile for it; it has {names}")));
    }
    for family in FAMILIES.iter().filter(|family| arguments.family.is_empty() && !names.contains(&family.name)) {
        tell(&format!("left out: {}: {} does not compile for it", family.name, found[0].1.driver));
    }
    let methods: Vec<&'static Method> = match arguments.method.is_empty() {
        true => METHODS.iter().filter(|method| method.has_pass()).collect(),
        false => arguments.method.clone(),
    };
    let brdfs = if arguments.brdf.is_empty() { vec![MODELS[0]] } else { arguments.brdf.clone() };
    let mut asked = Vec::new();
    for method in methods {
        for brdf in &brdfs {
            let job = job(arguments.layout, method, *brdf);
            // A method that does not use the model has one shader for all.
            if asked.iter().all(|(known, _, _)| *known != job) {
                let brdf = if method.uses_samples { brdf.name() } else { "" };
                asked.push((job, method, brdf));
            }
        }
    }
    let jobs: Vec<_> = asked.iter().map(|(job, _, _)| job.clone()).collect();
    let mut shaded = Vec::new();
    for (family, compiler) in found {
        if !arguments.family.is_empty() && arguments.family.iter().all(|asked| asked.name != family.name) {
            continue;
        }
        let made = passes(&program, family, &jobs).map_err(failure)?;
        for ((job, method, brdf), pass) in asked.iter().zip(made) {
            let fault = |text: String| Failure::failed(format!("{}: '{}': {text}", family.name, job.shader));
            if method.uses_samples && pass.counts.inside == Counts::default() {
                return Err(fault("no loop over samples is found in its assembly".to_owned()));
            }
            if pass.counts.other_loops > 0 {
                tell(&format!(
                    "{}: '{}' has {} more loops; the model counts each once",
                    family.name, job.shader, pass.counts.other_loops
                ));
            }
            let (method, uses_samples) = (method.name, method.uses_samples);
            shaded.push(Shaded { family, compiler: compiler.clone(), method, brdf, uses_samples, pass });
        }
    }
    let mut sample_counts = arguments.samples.clone();
    sample_counts.sort_unstable();
    sample_counts.dedup();
    Ok(Costs { shaded, sample_counts, texel: arguments.texel, layout: arguments.layout.name })
}

/// A host without the compiler lacks what is needed; one whose compiler fails has found a fault.
fn failure(fault: CompileFault) -> Failure {
    Failure::of(matches!(fault, CompileFault::NoRadv { .. }), fault)
}

/// The child's command.
pub fn compile_shaders() -> Result<(), Failure> {
    serve(std::io::stdin().lock(), std::io::stdout().lock()).map_err(Failure::failed)
}
