//! Translates functions in WGSL to GLSL, by naga.

use naga::back::glsl::{Options, PipelineOptions, Version, Writer, WriterFlags};
use naga::valid::{Capabilities, ValidationFlags, Validator};
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

/// Translates a file with `function`. The error is naga's, with file and line.
pub fn to_glsl(text: &str, function: &str, path: &Path) -> Result<String, String> {
    let (whole, shown) = (format!("{text}{PROTOTYPES}"), path.display().to_string());
    let mut module = naga::front::wgsl::parse_str(&whole)
        .map_err(|error| error.emit_to_string_with_path(&whole, &shown))?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module);
    let info = info.map_err(|error| error.emit_to_string_with_path(&whole, &shown))?;
    let constants = module
        .constants
        .iter_mut()
        .filter_map(|(_, own)| own.name.as_mut());
    let functions = module
        .functions
        .iter_mut()
        .filter_map(|(_, own)| own.name.as_mut());
    let is_ours = |name: &&mut String| LOOKUPS.contains(&name.as_str());
    for name in constants.chain(functions).filter(|name| !is_ours(name)) {
        *name = if name == function {
            FUNCTION.to_owned()
        } else {
            format!("wgsl_{name}")
        };
    }
    let (version, writer_flags) = (Version::Desktop(450), WriterFlags::INCLUDE_UNUSED_ITEMS);
    let options = Options {
        version,
        writer_flags,
        ..Options::default()
    };
    let (shader_stage, entry_point) = (naga::ShaderStage::Compute, "splitsum_main".to_owned());
    let pass = PipelineOptions {
        shader_stage,
        entry_point,
        multiview: None,
    };
    let mut glsl = String::new();
    Writer::new(
        &mut glsl,
        &module,
        &info,
        &options,
        &pass,
        Default::default(),
    )
    .and_then(|mut writer| writer.write())
    .map_err(|error| format!("{shown}: {error}"))?;
    // Leaves out the header, `main` and the prototypes. A function ends with a brace at the start
    // of a line.
    let is_prototype = |line: &str| {
        LOOKUPS
            .iter()
            .any(|name| line.contains(&format!(" {name}(")))
    };
    let mut is_left_out = false;
    let is_kept = |line: &&str| {
        is_left_out |=
            line.starts_with("void main") || !line.starts_with(' ') && is_prototype(line);
        let is_kept = !is_left_out && !line.starts_with('#') && !line.starts_with("layout");
        is_left_out &= *line != "}";
        is_kept
    };
    Ok(DEFINITIONS
        .lines()
        .chain(glsl.lines().filter(is_kept))
        .flat_map(|line| [line, "\n"])
        .collect())
}
