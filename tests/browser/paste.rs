//! The code of docs/paste.md in WebGL 2, with the filters of its device, against `render`.

use crate::chromium;
use crate::live_pixels::pipeline;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use half::f16;
use serde_json::json;
use splitsum::bake::paste::code;
use splitsum::base::names::Listed;
use splitsum::base::pixels::Pixels;
use splitsum::instrument::brdf::MaskingShadowing;
use splitsum::instrument::environment::layout::MapLayout;
use splitsum::instrument::environment::{Environment, LoadOptions};
use splitsum::instrument::pipeline::RenderRequest;
use splitsum::instrument::precompute::dfg::DfgAxes;
use splitsum::instrument::precompute::taps::TapCount;
use splitsum::instrument::scene::{CameraKind, MaterialOverride, Scene};
use splitsum::instrument::shade::{Diffuse, Method};
use std::path::Path;

const SIDE: u32 = 48;
/// A texture of half floats in the format of the script below.
fn packed<const N: usize>(levels: &[Pixels<[f32; N]>], face_count: u32) -> serde_json::Value {
    let words = |level: &Pixels<[f32; N]>| {
        let texel = |texel: &[f32; N]| {
            [0, 1, 2, 3].map(|c| f16::from_f32(texel.get(c).copied().unwrap_or(1.0)))
        };
        let bytes: Vec<u8> = level
            .data
            .iter()
            .flat_map(texel)
            .flat_map(f16::to_le_bytes)
            .collect();
        json!([
            level.width,
            level.height / face_count,
            BASE64_STANDARD.encode(bytes)
        ])
    };
    levels.iter().map(words).collect()
}

/// A sphere in a canvas, linear, row 0 at the bottom. Textures and uniforms of numbers, each by
/// name.
const DRAW: &str = "(text, textures, values, side) => {
    const canvas = Object.assign(document.createElement('canvas'), { width: side, height: side });
    const gl = canvas.getContext('webgl2');
    gl.getExtension('EXT_color_buffer_float');
    const program = gl.createProgram();
    const corners = `#version 300 es\nvoid main() { gl_Position = vec4(vec2(gl_VertexID & 1, \
    gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }`;
    for (const [type, source] of [[gl.VERTEX_SHADER, corners], [gl.FRAGMENT_SHADER, text]]) {
        const shader = gl.createShader(type);
        gl.shaderSource(shader, source);
        gl.compileShader(shader);
        if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new \
        Error(gl.getShaderInfoLog(shader));
        gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    gl.useProgram(program);
    Object.entries(textures).forEach(([name, levels], unit) => {
        const isCube = name === 'map', target = isCube ? gl.TEXTURE_CUBE_MAP : gl.TEXTURE_2D;
        gl.activeTexture(gl.TEXTURE0 + unit);
        gl.bindTexture(target, gl.createTexture());
        levels.forEach(([width, height, base64], level) => {
            const words = new Uint16Array(Uint8Array.from(atob(base64), (c) => \
            c.charCodeAt(0)).buffer);
            for (let face = 0; face < (isCube ? 6 : 1); face++) {
                const at = isCube ? gl.TEXTURE_CUBE_MAP_POSITIVE_X + face : target, size = 4 * \
                width * height;
                const texels = words.subarray(face * size, (face + 1) * size);
                gl.texImage2D(at, level, gl.RGBA16F, width, height, 0, gl.RGBA, gl.HALF_FLOAT, \
                texels);
            }
        });
        gl.texParameteri(target, gl.TEXTURE_MAX_LEVEL, levels.length - 1);
        gl.texParameteri(target, gl.TEXTURE_MIN_FILTER, isCube ? gl.LINEAR_MIPMAP_LINEAR : \
        gl.LINEAR);
        gl.texParameteri(target, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
        gl.texParameteri(target, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
        gl.uniform1i(gl.getUniformLocation(program, name), unit);
    });
    for (const [name, value] of Object.entries(values)) \
    gl[`uniform${value.length}fv`](gl.getUniformLocation(program, name), value);
    gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
    const target = gl.createTexture();
    gl.activeTexture(gl.TEXTURE9);
    gl.bindTexture(gl.TEXTURE_2D, target);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, side, side);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target, 0);
    gl.viewport(0, 0, side, side);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    const out = new Float32Array(4 * side * side);
    gl.readPixels(0, 0, side, side, gl.RGBA, gl.FLOAT, out);
    return Array.from(out);
}";

#[test]
fn pasted_lines_draw_a_sphere_as_render_does() {
    let (Some(mut page), Some(mut pipeline)) = (chromium::open(), pipeline()) else {
        return;
    };
    let environment = Environment::load(
        "tests/golden/env_analytic.exr",
        Path::new(""),
        &LoadOptions::default(),
    )
    .unwrap();
    let environment = std::sync::Arc::new(environment);
    // Relative errors of single pixels: the browser filters cubes with 8-bit weights, and tables
    // are half floats. Errors of several taps average out.
    for (method, kind, within) in [
        ("split-sum-two", Some(TapCount::Two), 1e-3),
        ("split-sum-four", Some(TapCount::Four), 1e-3),
        ("split-sum-one", Some(TapCount::One), 1e-3),
        ("split-sum-cap", None, 1e-3),
    ] {
        for (f0, alpha) in [([1.0, 0.7, 0.3], 0.25), ([0.04; 3], 0.5)] {
            let surface = MaterialOverride {
                albedo: Some(f0),
                metallic: Some(1.0),
                alpha: Some(alpha),
                ..MaterialOverride::default()
            };
            let scene = Scene::sphere().apply(&surface);
            let request =
                RenderRequest::plain(environment.clone(), scene, CameraKind::Ortho, [SIDE; 2])
                    .shaded(|s| {
                        (s.method, s.diffuse) = (Method::listed(method), Diffuse::listed("none"));
                        s.masking_shadowing = MaskingShadowing::Correlated;
                        s.precompute.dfg_axes = DfgAxes::Centres;
                        s.precompute.layout = MapLayout::listed("cube");
                        s.precompute.prefilter_size = [64, 64];
                    });
            let truth = pipeline.render(&request).unwrap();
            let tables = pipeline.light_tables(&request, 1, kind.as_slice()).unwrap();
            let [functions, lines] = code("GLSL", method).unwrap();
            let text = format!(
                "#version 300 es\nprecision highp float;\nuniform sampler2D table, taps;\nuniform \
                 samplerCube map;\n\
                 uniform vec3 f0;\nuniform vec2 extent;\nuniform float roughness, last;\nout vec4 \
                 color;\n\
                 float lod(float r) {{ return r * last; }}\n{functions}\nvoid main() {{\n\
                 vec2 place = (gl_FragCoord.xy / {SIDE}.0 * 2.0 - 1.0) * extent;\ncolor = \
                 vec4(0.0);\n\
                 if (dot(place, place) >= 1.0) return;\nvec3 n = vec3(place, sqrt(1.0 - dot(place, \
                 place)));\n\
                 vec3 v = vec3(0.0, 0.0, 1.0);\nfloat n_dot_v = n.z;\n\
                 vec2 dfg = textureLod(table, vec2(n_dot_v, roughness), 0.0).xy;\n{lines}color = \
                 vec4(specular, 1.0);\n}}\n"
            );
            let mut textures =
                json!({ "map": packed(&tables.prefiltered, 6), "table": packed(&[tables.dfg], 1) });
            if kind.is_some() {
                textures["taps"] = packed(&tables.tap_tables, 1);
            }
            let values = json!({ "f0": f0, "extent": request.camera.extent(1.0), "roughness": [f32::sqrt(alpha)],
                "last": [tables.prefiltered.len() - 1] });
            let shown = page.eval(&format!(
                "({DRAW})({}, {textures}, {values}, {SIDE})",
                json!(text)
            ));
            let shown: Vec<f64> = shown
                .as_array()
                .unwrap()
                .iter()
                .map(|x| x.as_f64().unwrap())
                .collect();
            let (mut worst, mut count) = (0.0_f64, 0);
            for (i, texel) in shown.chunks_exact(4).enumerate() {
                let at = (SIDE - 1 - i as u32 / SIDE) * SIDE + i as u32 % SIDE;
                if texel[3] == 1.0 && truth.mask.data[at as usize] == 1.0 {
                    count += 1;
                    let off =
                        |(a, b): (&f64, &f32)| (a - f64::from(*b)).abs() / f64::from(*b).max(1e-3);
                    worst = texel
                        .iter()
                        .zip(&truth.radiance.data[at as usize])
                        .map(off)
                        .fold(worst, f64::max);
                }
            }
            println!("{method} {f0:?} {alpha}: {worst:.2e} in {count} pixels");
            assert!(
                worst < within && count > 1200,
                "{method} {f0:?} {alpha}: {worst:.2e} in {count} pixels"
            );
        }
    }
    assert!(page.errors.is_empty(), "{:?}", page.errors);
}
