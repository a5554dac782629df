//! The code of docs/paste.md: compiled in three languages, which compute the same.

use splitsum::bake::paste::code;
use splitsum::base::glsl::source::{Language, compiler, parse};

const METHODS: [&str; 4] = [
    "split-sum-two",
    "split-sum-four",
    "split-sum-one",
    "split-sum-cap",
];

/// Compiles each method's code in a fragment shader made from it.
fn compile_all(
    language: &str,
    shader: impl Fn(&str, &str) -> String,
    compile: impl Fn(&str) -> Result<(), String>,
) {
    for method in METHODS {
        let [functions, lines] =
            code(language, method).unwrap_or_else(|| panic!("{language}: no {method}"));
        let text = shader(functions, lines);
        compile(&text).unwrap_or_else(|log| panic!("{language}, {method}: {log}\n{text}"));
        // A compiler that accepts anything would prove nothing.
        compile(&text.replace("specular = ", "specular = missing + "))
            .expect_err("an unknown name");
    }
}

#[test]
fn the_glsl_compiles_for_webgl_2() {
    let shader = |functions: &str, lines: &str| {
        format!(
            "#version 300 es\nprecision highp float;\nuniform sampler2D taps;\nuniform samplerCube \
             map;\n\
             uniform vec3 n, v, f0;\nuniform vec2 dfg;\nuniform float n_dot_v, roughness;\nout \
             vec4 color;\n\
             float lod(float r) {{ return 4.0 * r; }}\n{functions}\nvoid main() {{\n{lines}color = \
             vec4(specular, 1.0);\n}}\n"
        )
    };
    compile_all("GLSL", shader, |text| {
        parse("use.frag", text, Language::Es).map(|_| ())
    });
}

#[test]
fn the_hlsl_compiles() {
    let shader = |functions: &str, lines: &str| {
        format!(
            "Texture2D<float4> taps;\nTextureCube<float4> map;\nSamplerState bilinear, trilinear;\n\
             float3 n, v, f0;\nfloat2 dfg;\nfloat n_dot_v, roughness;\n\
             float lod(float r) {{ return 4.0 * r; }}\n{functions}\n\
             float4 main() : SV_Target {{\n{lines}return float4(specular, 1.0);\n}}\n"
        )
    };
    compile_all("HLSL", shader, |text| {
        let options = glslang::CompilerOptions {
            source_language: glslang::SourceLanguage::HLSL,
            target: glslang::Target::Vulkan {
                version: glslang::VulkanVersion::Vulkan1_3,
                spirv_version: glslang::SpirvVersion::SPIRV1_6,
            },
            version_profile: None,
            messages: glslang::ShaderMessage::DEFAULT,
        };
        let source = glslang::ShaderSource::from(text);
        let stage = glslang::ShaderStage::Fragment;
        let input = glslang::ShaderInput::new(
            &source,
            stage,
            &options,
            None::<&[(&str, Option<&str>)]>,
            None,
        )
        .map_err(|error| error.to_string())?;
        compiler()?
            .create_shader(input)
            .map(|_| ())
            .map_err(|error| error.to_string())
    });
}

#[test]
fn the_wgsl_compiles() {
    let shader = |functions: &str, lines: &str| {
        format!(
            "struct Here {{ n: vec3f, v: vec3f, f0: vec3f, dfg: vec2f, n_dot_v: f32, roughness: \
             f32 }}\n\
             @group(0) @binding(0) var<uniform> here: Here;\n@group(0) @binding(1) var taps: \
             texture_2d<f32>;\n\
             @group(0) @binding(2) var map: texture_cube<f32>;\n@group(0) @binding(3) var \
             bilinear: sampler;\n\
             @group(0) @binding(4) var trilinear: sampler;\n\
             fn lod(r: f32) -> f32 {{ return 4.0 * r; }}\n{functions}\n\
             @fragment fn main() -> @location(0) vec4f {{\nlet n = here.n; let v = here.v; let f0 \
             = here.f0; let dfg = here.dfg;\n\
             let n_dot_v = here.n_dot_v; let roughness = here.roughness;\n{lines}return \
             vec4f(specular, 1.0);\n}}\n"
        )
    };
    compile_all("WGSL", shader, |text| {
        let module =
            naga::front::wgsl::parse_str(text).map_err(|error| error.emit_to_string(text))?;
        let flags = naga::valid::ValidationFlags::all();
        let mut validator = naga::valid::Validator::new(flags, naga::valid::Capabilities::empty());
        validator
            .validate(&module)
            .map(|_| ())
            .map_err(|error| error.emit_to_string(text))
    });
}

/// Lines without comments and signatures; only compilers check those two.
fn body(code: &str) -> String {
    let lines = code
        .lines()
        .map(str::trim)
        .filter(|line| !line.starts_with("//") && !line.ends_with('{'));
    lines.map(|line| format!("\n{line}")).collect()
}

#[test]
fn the_languages_have_the_same_code() {
    const HLSL: &[[&str; 2]] = &[
        [
            "vec2 size = vec2(textureSize(taps, 0));",
            "vec2 size;\ntaps.GetDimensions(size.x, size.y);",
        ],
        ["textureLod(map, ", "map.SampleLevel(trilinear, "],
        ["textureLod(taps, ", "taps.SampleLevel(bilinear, "],
        ["vec3(1.0 / 3.0)", "vec3(1.0, 1.0, 1.0) / 3.0"],
        ["mix(", "lerp("],
        ["vec", "float"],
    ];
    const WGSL: &[[&str; 2]] = &[
        ["\nfloat ", "\nlet "],
        ["\nvec2 ", "\nlet "],
        ["\nvec3 ", "\nlet "],
        ["\nvec4 ", "\nlet "],
        ["textureSize(taps, 0)", "textureDimensions(taps)"],
        ["textureLod(map, ", "textureSampleLevel(map, trilinear, "],
        ["textureLod(taps, ", "textureSampleLevel(taps, bilinear, "],
        ["max(mean, 0.0)", "max(mean, vec3(0.0))"],
        ["vec2(", "vec2f("],
        ["vec3(", "vec3f("],
        ["vec4(", "vec4f("],
    ];
    const BOTH: &[[&str; 2]] = &[
        ["clamp(", "saturate("],
        [", 0.0, 1.0)", ")"],
        ["_part(taps, ", "_part(taps, bilinear, "],
    ];
    for (language, words) in [("HLSL", HLSL), ("WGSL", WGSL)] {
        for method in METHODS {
            let [glsl, other] =
                ["GLSL", language].map(|language| code(language, method).unwrap().map(body));
            let translate = |text: String| {
                BOTH.iter()
                    .chain(words)
                    .fold(text, |text, [glsl, other]| text.replace(glsl, other))
            };
            assert_eq!(glsl.map(translate), other, "{language}, {method}");
        }
    }
}

#[test]
fn the_page_prints_the_functions_that_the_methods_include() {
    let shaders = [
        (
            "split-sum-two",
            include_str!("../../shaders/lib/tap_lookup.glsl"),
        ),
        (
            "split-sum-cap",
            include_str!("../../shaders/lib/cap_direction.glsl"),
        ),
    ];
    for (method, shader) in shaders {
        let (_, functions) = shader.split_once("\n\n").unwrap();
        assert_eq!(code("GLSL", method).unwrap()[0], functions);
    }
}
