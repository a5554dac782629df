//! `check-shader` through the binary: limits, exit codes, wrong functions.

use super::bad_input::folder;
use super::end_to_end::has_device;
use super::{assert_ends, ok, splitsum};
use serde_json::Value;

const TEXTBOOK: &str = include_str!("../golden/refused/textbook.glsl");

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
