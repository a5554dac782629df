//! The child process that compiles shaders: environment variables choose its driver, and a process
//! reads them once.
//!
//! The parent starts its own program with a hidden command and writes the shader variants to its
//! standard input as JSON. The child answers with a line about itself and one per variant, so the
//! parent knows which variant a compiler died on.

use super::family::{FAMILIES, Family};
use crate::instrument::gpu::{
    DeviceChoice, Executable, Gpu, GpuError, Options, ShaderVariant, add_shader,
};
use serde::{Deserialize, Serialize};
use std::io::{self, BufRead, Read, Write};
use std::path::Path;
use std::process::{Command, Stdio};

/// Name of the hidden command.
pub const COMMAND: &str = "compile-shaders";

/// RADV's name for its assembly.
pub const ASSEMBLY: &str = "Assembly";

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Compiler {
    pub driver: String,
}

#[derive(Debug, thiserror::Error)]
pub enum CompileFault {
    #[error("{program}: {source}")]
    Start { program: String, source: io::Error },
    #[error(
        "no Vulkan driver here compiles for AMD GPUs: Mesa's RADV is missing or does not open \
         (Debian: apt-get install \
         mesa-vulkan-drivers; check VK_DRIVER_FILES and VK_ICD_FILENAMES where they are set){}",
        .stderr.lines().last().map_or_else(String::new, |line| format!("; it said: {line}"))
    )]
    NoRadv { stderr: String },
    #[error("{family}: '{shader}' does not compile: {stderr}")]
    Shader {
        family: &'static str,
        shader: String,
        stderr: String,
    },
}

/// Runs a child that compiles for a family by one of its driver names.
fn try_name(program: &Path, name: &str, variants: &[ShaderVariant]) -> Result<Answer, io::Error> {
    let mut child = Command::new(program)
        .arg(COMMAND)
        .env("RADV_FORCE_FAMILY", name)
        // The cache's entries have no assembly.
        .env("MESA_SHADER_CACHE_DISABLE", "true")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()?;
    let text = serde_json::to_string(variants).map_err(io::Error::other)?;
    let mut input = child.stdin.take().expect("piped");
    let fed = std::thread::spawn(move || input.write_all(text.as_bytes()));
    let output = child.wait_with_output()?;
    // A child that died early did not read; its answer shows that.
    let _ = fed.join();
    let mut lines = output.stdout.lines().map_while(Result::ok);
    let compiler = lines
        .next()
        .and_then(|line| serde_json::from_str(&line).ok());
    let results = lines
        .map_while(|line| serde_json::from_str(&line).ok())
        .collect();
    Ok(Answer {
        compiler,
        results,
        stderr: String::from_utf8_lossy(&output.stderr).trim().to_owned(),
    })
}

struct Answer {
    /// `None` if the driver did not open.
    compiler: Option<Compiler>,
    /// Results up to the child's end.
    results: Vec<Result<Vec<Executable>, String>>,
    stderr: String,
}

/// Runs children until the driver knows one of the family's names.
fn compiled(
    program: &Path,
    family: &Family,
    variants: &[ShaderVariant],
) -> Result<(Compiler, Answer), CompileFault> {
    let mut stderr = String::new();
    for name in family.driver_names {
        let mut answer =
            try_name(program, name, variants).map_err(|source| CompileFault::Start {
                program: program.display().to_string(),
                source,
            })?;
        if let Some(compiler) = answer.compiler.take() {
            return Ok((compiler, answer));
        }
        stderr = answer.stderr;
    }
    Err(CompileFault::NoRadv { stderr })
}

/// Lists the families that the installed driver compiles for; an error if there are none.
pub fn available(program: &Path) -> Result<Vec<(&'static Family, Compiler)>, CompileFault> {
    let mut found = Vec::new();
    let mut missing = None;
    for family in FAMILIES {
        match compiled(program, family, &[]) {
            Ok((compiler, _)) => found.push((family, compiler)),
            Err(fault @ CompileFault::NoRadv { .. }) => missing = Some(fault),
            Err(fault) => return Err(fault),
        }
    }
    match missing {
        Some(fault) if found.is_empty() => Err(fault),
        _ => Ok(found),
    }
}

/// Compiles every variant for a family, in order, and returns the stages of each. `program` is the
/// file of this program.
pub fn compile(
    program: &Path,
    family: &'static Family,
    variants: &[ShaderVariant],
) -> Result<Vec<Vec<Executable>>, CompileFault> {
    let (_, answer) = compiled(program, family, variants)?;
    let fault = |index: usize, stderr: &str| CompileFault::Shader {
        family: family.name,
        shader: variants[index].shader.clone(),
        stderr: stderr.to_owned(),
    };
    let count = answer.results.len();
    if count < variants.len() && answer.results.iter().all(Result::is_ok) {
        return Err(fault(
            count,
            &format!("the compiler died; {}", answer.stderr),
        ));
    }
    let results = answer.results.into_iter().enumerate();
    results
        .map(|(index, result)| result.map_err(|stderr| fault(index, &stderr)))
        .collect()
}

/// Runs the child: reads variants, compiles them on RADV, writes answers.
pub fn serve(input: impl Read, mut output: impl Write) -> Result<(), Box<dyn std::error::Error>> {
    let variants: Vec<ShaderVariant> = serde_json::from_reader(input)?;
    let gpu = Gpu::new(Options {
        device: DeviceChoice::Radv,
        executables: true,
        ..Options::default()
    })?;
    let compiler = Compiler {
        driver: gpu.info().driver.clone(),
    };
    writeln!(output, "{}", serde_json::to_string(&compiler)?)?;
    for variant in &variants {
        let result = executables(&gpu, variant).map_err(|error| error.to_string());
        writeln!(output, "{}", serde_json::to_string(&result)?)?;
        output.flush()?;
    }
    // Closing a device without hardware crashes (Mesa 22.3.6); the process ends anyway.
    std::mem::forget(gpu);
    Ok(())
}

fn executables(gpu: &Gpu, variant: &ShaderVariant) -> Result<Vec<Executable>, GpuError> {
    if let Some(code) = &variant.code {
        add_shader(variant.shader.clone(), code);
    }
    let mut executables = gpu.executables(&variant.shader, &variant.constants)?;
    for stage in &mut executables {
        stage.texts.retain(|(name, _)| name == ASSEMBLY);
    }
    Ok(executables)
}
