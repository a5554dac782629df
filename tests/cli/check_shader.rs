//! `check-shader` through the binary: limits, exit codes, wrong functions.

use super::bad_input::folder;
use super::end_to_end::has_device;
use super::{assert_ends, ok, splitsum};
use serde_json::Value;

/// The textbook's split sum, as a method in a file.
const TEXTBOOK: &str = r#"#include "lib/split_sum.glsl"
vec3 specular_radiance(Surface s) {
    return prefiltered_radiance(reflect(-s.v, s.n), perceptual_roughness_from_alpha(s.alpha)) * reflectance(s);
}
"#;

#[test]
fn limits_decide_the_exit_code() {
    if !has_device() {
        return;
    }
    let dir = folder(&[
        ("my.glsl", TEXTBOOK),
        (
            "blind.glsl",
            "vec3 f(vec3 n, vec3 v, float r, vec3 f0) { return f0; }\n",
        ),
        (
            "nan.glsl",
            "vec3 f(vec3 n, vec3 v, float r, vec3 f0) { return f0 * uintBitsToFloat(0x7fc00000u); \
             }\n",
        ),
    ]);
    let text = ok(
        dir.path(),
        &["check-shader", "my.glsl", "--fail-above", "0.01,0.1,90"],
    );
    assert!(text.contains("\nVerdict: wrong: direction 60."), "{text}");
    let output = splitsum(
        dir.path(),
        &[
            "check-shader",
            "my.glsl",
            "--json",
            "--fail-above",
            "0.01,0.1,20",
        ],
    );
    assert_ends(
        &output,
        1,
        &[
            "direction above 20 degrees: direction 60.",
            "at alpha 1, f0 1",
        ],
    );
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(
        found["rows"][0]["views"][0]["errors"]["direction"].is_f64(),
        "{found}"
    );
    assert_eq!(
        (&found["passes"], found["rows"].as_array().unwrap().len()),
        (&Value::Bool(false), 8)
    );
    assert_ends(
        &splitsum(dir.path(), &["check-shader", "my.glsl", "--fail-on-wrong"]),
        1,
        &["wrong: direction"],
    );
    let text = ok(dir.path(), &["check-shader", "blind.glsl", "--entry", "f"]);
    assert!(
        text.contains("\nVerdict: wrong: the light's direction has no effect"),
        "{text}"
    );
    let refused = &["nan.glsl: 64 pixels", "are not finite"];
    assert_ends(
        &splitsum(dir.path(), &["check-shader", "nan.glsl", "--entry", "f"]),
        2,
        refused,
    );
}

/// Adapters to engines define names of GLSL, as three.js r187's does with its own `textureLod`.
#[test]
fn a_macro_of_the_user_may_have_a_built_in_name() {
    if !has_device() {
        return;
    }
    let engine = r#"#include "lib/split_sum.glsl"
#define textureLod(map, direction, level) vec4(prefiltered_radiance(direction, level), 1.0)
#define sqrt(x) pow(x, 0.5)
vec3 ibl_radiance(vec3 n, vec3 v, float perceptual_roughness, vec3 f0) {
    vec2 factors = albedo_pair(dfg, dot(n, v), perceptual_roughness * perceptual_roughness);
    vec3 light = textureLod(0, reflect(-v, n), sqrt(perceptual_roughness * perceptual_roughness)).rgb;
    return light * (f0 * factors.x + factors.y);
}
"#;
    let dir = folder(&[("engine.glsl", engine)]);
    let text = ok(
        dir.path(),
        &["check-shader", "engine.glsl", "--entry", "ibl_radiance"],
    );
    assert!(text.contains("\nVerdict: wrong: direction 60."), "{text}");
}
