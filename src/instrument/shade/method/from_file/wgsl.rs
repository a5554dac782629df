//! Translates functions in WGSL to GLSL, by naga.

use naga::Module;
use naga::back::glsl::{Options, PipelineOptions, Version, Writer, WriterFlags};
use naga::proc::BoundsCheckPolicies;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use std::path::Path;

/// The GLSL name of the function that is called; all others are `wgsl_NAME`, so that none is a name
/// of `shaders/`.
pub const FUNCTION: &str = "function_of_wgsl";

/// The functions that a file may call.
const LOOKUPS: [&str; 2] = ["prefiltered_radiance", "albedo_pair"];
/// They follow the text, so that lines keep their numbers. Naga demands an entry point.
const PROTOTYPES: &str = "
fn prefiltered_radiance(direction: vec3<f32>, perceptual_roughness: f32) -> vec3<f32> { return \
direction; }
fn albedo_pair(n_dot_v: f32, perceptual_roughness: f32) -> vec2<f32> { return vec2(n_dot_v); }
@compute @workgroup_size(1) fn splitsum_main() {}
";
/// Replaces the prototypes in GLSL.
const DEFINITIONS: &str = "#include \"lib/split_sum.glsl\"
vec2 albedo_pair(float n_dot_v, float perceptual_roughness) {
    return albedo_pair(dfg, n_dot_v, alpha_from_perceptual_roughness(perceptual_roughness));
}
";

/// The entry point of the prototypes.
const ENTRY_POINT: &str = "splitsum_main";

/// Translates a file with `function`. The error is naga's, with file and line.
pub fn to_glsl(text: &str, function: &str, path: &Path) -> Result<String, String> {
    let whole = format!("{text}{PROTOTYPES}");
    let shown = path.display().to_string();
    let mut module = naga::front::wgsl::parse_str(&whole)
        .map_err(|error| error.emit_to_string_with_path(&whole, &shown))?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .map_err(|error| error.emit_to_string_with_path(&whole, &shown))?;
    rename(&mut module, function);
    let glsl = write_glsl(&module, &info).map_err(|error| format!("{shown}: {error}"))?;
    Ok(without_prototypes(&glsl))
}

/// Renames the constants and functions of a file, so that none has a name of `shaders/`.
fn rename(module: &mut Module, function: &str) {
    let constants = module
        .constants
        .iter_mut()
        .filter_map(|(_, constant)| constant.name.as_mut());
    let functions = module
        .functions
        .iter_mut()
        .filter_map(|(_, function)| function.name.as_mut());
    let is_lookup = |name: &&mut String| LOOKUPS.contains(&name.as_str());
    for name in constants.chain(functions).filter(|name| !is_lookup(name)) {
        *name = if name == function {
            FUNCTION.to_owned()
        } else {
            format!("wgsl_{name}")
        };
    }
}

fn write_glsl(module: &Module, info: &ModuleInfo) -> Result<String, naga::back::glsl::Error> {
    let options = Options {
        version: Version::Desktop(450),
        writer_flags: WriterFlags::INCLUDE_UNUSED_ITEMS,
        ..Options::default()
    };
    let pipeline = PipelineOptions {
        shader_stage: naga::ShaderStage::Compute,
        entry_point: ENTRY_POINT.to_owned(),
        multiview: None,
    };
    let mut glsl = String::new();
    let policies = BoundsCheckPolicies::default();
    Writer::new(&mut glsl, module, info, &options, &pipeline, policies)?.write()?;
    Ok(glsl)
}

/// Replaces the prototypes in naga's GLSL by [`DEFINITIONS`], and leaves out its header and `main`.
fn without_prototypes(glsl: &str) -> String {
    let is_prototype = |line: &str| {
        LOOKUPS
            .iter()
            .any(|name| line.contains(&format!(" {name}(")))
    };
    // A function ends with a brace at the start of a line.
    let mut is_in_omitted_function = false;
    let is_kept = |line: &&str| {
        is_in_omitted_function |=
            line.starts_with("void main") || !line.starts_with(' ') && is_prototype(line);
        let is_kept =
            !is_in_omitted_function && !line.starts_with('#') && !line.starts_with("layout");
        is_in_omitted_function &= *line != "}";
        is_kept
    };
    DEFINITIONS
        .lines()
        .chain(glsl.lines().filter(is_kept))
        .flat_map(|line| [line, "\n"])
        .collect()
}
