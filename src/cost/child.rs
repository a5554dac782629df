//! The process that compiles: its driver is chosen by environment variables, which a process reads once.
//!
//! The parent starts its own program with a hidden command and writes the jobs to its standard input, as JSON. The child answers with one
//! line for itself and one a job, so that the parent knows at which one a compiler died.

use super::family::{FAMILIES, Family};
use crate::gbuffer;
use crate::gpu::{DeviceChoice, Executable, Gpu, GpuError, Options, add_shader, added_shader};
use serde::{Deserialize, Serialize};
use std::io::{self, BufRead, Read, Write};
use std::path::Path;
use std::process::{Command, Stdio};

/// The hidden command.
pub const COMMAND: &str = "compile-shaders";

/// The name that RADV gives its assembly.
pub const ASSEMBLY: &str = "Assembly";

/// One shader to compile.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// A permutation: a compute shader, or the fragment shader of a draw.
    pub shader: String,
    pub constants: Vec<u32>,
    /// The SPIR-V of a method in a file, which the child does not have.
    pub code: Option<Vec<u32>>,
}

impl Job {
    pub fn new(shader: String, constants: &[u32]) -> Self {
        let code = added_shader(&shader);
        Self { shader, constants: constants.to_vec(), code }
    }
}

/// What a child says of itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Compiler {
    /// The device as the driver words it.
    pub device: String,
    /// The driver's name and version.
    pub driver: String,
}

/// The stages of a job's pipeline.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Compiled {
    pub executables: Vec<Executable>,
}

/// Why nothing was compiled.
#[derive(Debug, thiserror::Error)]
pub enum CompileFault {
    #[error("{program}: {source}")]
    Start { program: String, source: io::Error },
    #[error(
        "no Vulkan driver here compiles for AMD GPUs: Mesa's RADV is missing or does not open (Debian: apt-get install \
         mesa-vulkan-drivers; check VK_DRIVER_FILES and VK_ICD_FILENAMES where they are set){}",
        .said.lines().last().map_or_else(String::new, |line| format!("; it said: {line}"))
    )]
    NoRadv { said: String },
    #[error("{family}: '{shader}' does not compile: {said}")]
    Shader { family: &'static str, shader: String, said: String },
}

/// What a child answers for a family by one of its names.
fn try_name(program: &Path, name: &str, jobs: &[Job]) -> Result<Answer, io::Error> {
    let mut child = Command::new(program)
        .arg(COMMAND)
        .env("RADV_FORCE_FAMILY", name)
        // What an earlier run of the compiler made has no assembly.
        .env("MESA_SHADER_CACHE_DISABLE", "true")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()?;
    let text = serde_json::to_string(jobs).map_err(io::Error::other)?;
    let mut input = child.stdin.take().expect("piped");
    let fed = std::thread::spawn(move || input.write_all(text.as_bytes()));
    let output = child.wait_with_output()?;
    // A child that died early did not read: its answer tells.
    let _ = fed.join();
    let mut lines = output.stdout.lines().map_while(Result::ok);
    let compiler = lines.next().and_then(|line| serde_json::from_str(&line).ok());
    let results = lines.map_while(|line| serde_json::from_str(&line).ok()).collect();
    Ok(Answer { compiler, results, said: String::from_utf8_lossy(&output.stderr).trim().to_owned() })
}

struct Answer {
    /// Nothing where the driver did not open.
    compiler: Option<Compiler>,
    /// As far as the child came.
    results: Vec<Result<Compiled, String>>,
    said: String,
}

/// The families that the installed driver compiles for; an error where it has none.
pub fn available(program: &Path) -> Result<Vec<(&'static Family, Compiler)>, CompileFault> {
    let (mut found, mut said) = (Vec::new(), String::new());
    for family in FAMILIES {
        for name in family.driver_names {
            let answer = try_name(program, name, &[]).map_err(|source| start(program, source))?;
            said = answer.said;
            if let Some(compiler) = answer.compiler {
                found.push((family, compiler));
                break;
            }
        }
    }
    if found.is_empty() { Err(CompileFault::NoRadv { said }) } else { Ok(found) }
}

fn start(program: &Path, source: io::Error) -> CompileFault {
    CompileFault::Start { program: program.display().to_string(), source }
}

/// Compiles every job for a family, in the order of the jobs. `program` is this program's file.
pub fn compile(program: &Path, family: &'static Family, jobs: &[Job]) -> Result<Vec<Compiled>, CompileFault> {
    let mut last = CompileFault::NoRadv { said: String::new() };
    for name in family.driver_names {
        let answer = try_name(program, name, jobs).map_err(|source| start(program, source))?;
        if answer.compiler.is_none() {
            last = CompileFault::NoRadv { said: answer.said };
            continue;
        }
        let fault = |index: usize, said: &str| CompileFault::Shader {
            family: family.name,
            shader: jobs[index].shader.clone(),
            said: said.to_owned(),
        };
        let count = answer.results.len();
        let done =
            answer.results.into_iter().enumerate().map(|(index, result)| result.map_err(|said| fault(index, &said)));
        let done: Vec<Compiled> = done.collect::<Result<_, _>>()?;
        return if count < jobs.len() {
            Err(fault(count, &format!("the compiler died; {}", answer.said)))
        } else {
            Ok(done)
        };
    }
    Err(last)
}

/// The child's side: reads the jobs, compiles on RADV, writes the answers.
pub fn serve(input: impl Read, mut output: impl Write) -> Result<(), ServeFault> {
    let jobs: Vec<Job> = serde_json::from_reader(input)?;
    let gpu = Gpu::new(Options { device: DeviceChoice::Radv, executables: true, ..Options::default() })?;
    let info = gpu.info();
    let compiler = Compiler { device: info.name.clone(), driver: info.driver.clone() };
    writeln!(output, "{}", serde_json::to_string(&compiler)?)?;
    for job in &jobs {
        let result = pipeline(&gpu, job).map_err(|error| error.to_string());
        writeln!(output, "{}", serde_json::to_string(&result)?)?;
        output.flush()?;
    }
    // A device without hardware crashes when it is closed (Mesa 22.3.6); the process ends anyway.
    std::mem::forget(gpu);
    Ok(())
}

/// Why a child ends without an answer.
#[derive(Debug, thiserror::Error)]
pub enum ServeFault {
    #[error(transparent)]
    Gpu(#[from] GpuError),
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    #[error(transparent)]
    Io(#[from] io::Error),
}

fn pipeline(gpu: &Gpu, job: &Job) -> Result<Compiled, GpuError> {
    if let Some(code) = &job.code {
        add_shader(job.shader.clone(), code);
    }
    let draw = gbuffer::pass::PIPELINES.into_iter().find(|draw| draw.shaders[1] == job.shader);
    let mut executables = match draw {
        Some(draw) => gpu.graphics_executables(draw, gbuffer::ATTACHMENT_NAMES.len())?,
        None => gpu.executables(&job.shader, &job.constants)?,
    };
    for stage in &mut executables {
        stage.texts.retain(|(name, _)| name == ASSEMBLY);
    }
    Ok(Compiled { executables })
}
