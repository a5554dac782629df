//! Direct lights: closed forms, what settings change, and lights of glTF files.

use super::gltf::{loaded, quad};
use crate::gltf_files::load;
use glam::DVec3;
use serde_json::{Value, json};
use splitsum::instrument::scene::light::{Cone, Emitter, LightUnit};
use splitsum::instrument::scene::{Light, LightChange};
use std::collections::BTreeSet;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

const F64: f64 = 1e-12;

fn spot(inner: f64, outer: f64) -> Light {
    Light {
        emitter: Emitter::Spot {
            position: DVec3::new(0.0, 2.0, 0.0),
            direction: DVec3::NEG_Y,
            cone: Cone { inner, outer },
        },
        color: [8.0, 4.0, 2.0],
        unit: LightUnit::Absolute,
        range: None,
    }
}

/// The irradiance in red of a spot on the axis y, 2 above the ground, at an angle from its axis.
fn at_angle(light: &Light, angle: f64) -> f64 {
    light
        .at(DVec3::new(2.0 * angle.tan(), 0.0, 0.0))
        .irradiance
        .x
}

#[test]
fn a_spot_is_whole_inside_and_ends_outside() {
    let light = spot(0.3, 0.6);
    // 8 / d², d = 2 / cos.
    let whole = |angle: f64| 8.0 * angle.cos().powi(2) / 4.0;
    for angle in [0.0, 0.2, 0.299] {
        assert!(
            (at_angle(&light, angle) - whole(angle)).abs() < F64,
            "{angle}"
        );
    }
    for angle in [0.601, 0.9, 1.5] {
        assert_eq!(at_angle(&light, angle), 0.0, "{angle}");
    }
    // Halfway between the cosines a quarter is left.
    let middle = (0.5 * (0.3f64.cos() + 0.6f64.cos())).acos();
    assert!((at_angle(&light, middle) - 0.25 * whole(middle)).abs() < F64);
    // Behind the light there is none, and narrow spots keep their axis.
    assert_eq!(light.at(DVec3::new(0.0, 3.0, 0.0)).irradiance, DVec3::ZERO);
    assert!((at_angle(&spot(0.0, 0.01), 0.0) - 2.0).abs() < F64);
}

#[test]
fn a_range_ends_a_point_light() {
    let light = |range| Light {
        emitter: Emitter::Point {
            position: DVec3::ZERO,
        },
        color: [3.0; 3],
        unit: LightUnit::Absolute,
        range,
    };
    let at = |range, distance: f64| light(range).at(DVec3::X * distance).irradiance.x;
    assert!((at(None, 2.0) - 0.75).abs() < F64);
    // 1 - (1/2)⁴.
    assert!((at(Some(4.0), 2.0) - 0.75 * 0.9375).abs() < F64);
    assert_eq!(at(Some(4.0), 4.5), 0.0);
    let arrival = light(None).at(DVec3::new(0.0, 0.0, 5.0));
    assert!((arrival.l - DVec3::NEG_Z).length() < F64);
}

#[test]
fn settings_scale_and_turn_lights() {
    let light = Light {
        unit: LightUnit::Map,
        ..Light::directional(DVec3::NEG_Z, [1.0, 2.0, 4.0])
    };
    let change = LightChange {
        intensity: 3.0,
        turn_deg: 90.0,
        map_irradiance: 0.5,
    };
    let changed = light.changed(&change);
    assert_eq!(changed.color, [1.5, 3.0, 6.0]);
    assert_eq!(changed.unit, LightUnit::Absolute);
    // Counter-clockwise from above: -z turns to -x.
    let Emitter::Directional { direction } = changed.emitter else {
        panic!("{changed:?}");
    };
    assert!((direction - DVec3::NEG_X).length() < F64);
    let absolute = Light::directional(DVec3::NEG_Z, [1.0; 3]).changed(&change);
    assert_eq!(absolute.color, [3.0; 3]);
    // +z turns to +x: places turn as well as axes.
    let spot = Light {
        emitter: Emitter::Spot {
            position: DVec3::Z,
            direction: DVec3::NEG_Z,
            cone: Cone::default(),
        },
        ..absolute
    };
    let point = Light {
        emitter: Emitter::Point { position: DVec3::Z },
        ..absolute
    };
    for light in [spot, point] {
        match light.changed(&change).emitter {
            Emitter::Spot {
                position,
                direction,
                ..
            } => {
                assert!((position - DVec3::X).length() < F64, "{position}");
                assert!((direction - DVec3::NEG_X).length() < F64, "{direction}");
            }
            Emitter::Point { position } => {
                assert!((position - DVec3::X).length() < F64, "{position}");
            }
            other @ Emitter::Directional { .. } => panic!("{other:?}"),
        }
    }
}

/// Caches know scenes by their hash, so it depends on every number of a light.
#[test]
fn each_number_of_a_light_changes_the_scene() {
    let scene = loaded(&quad());
    let aimed = |position, direction, inner, outer| Light {
        emitter: Emitter::Spot {
            position,
            direction,
            cone: Cone { inner, outer },
        },
        ..spot(0.3, 0.6)
    };
    let plain = aimed(DVec3::Y, DVec3::NEG_Y, 0.3, 0.6);
    let point = |position| Light {
        emitter: Emitter::Point { position },
        ..plain
    };
    let lights = [
        plain,
        aimed(DVec3::Z, DVec3::NEG_Y, 0.3, 0.6),
        aimed(DVec3::Y, DVec3::NEG_Z, 0.3, 0.6),
        aimed(DVec3::Y, DVec3::NEG_Y, 0.2, 0.6),
        aimed(DVec3::Y, DVec3::NEG_Y, 0.3, 0.7),
        point(DVec3::Y),
        point(DVec3::X),
        Light::directional(DVec3::NEG_Y, plain.color),
        Light::directional(DVec3::NEG_X, plain.color),
        Light {
            color: [8.0, 4.0, 3.0],
            ..plain
        },
        Light {
            range: Some(3.0),
            ..plain
        },
        Light {
            unit: LightUnit::Map,
            ..plain
        },
    ];
    let hashes: BTreeSet<String> = lights
        .iter()
        .map(|light| scene.lit_by(vec![*light]).hash)
        .collect();
    assert_eq!(hashes.len(), lights.len());
}

/// A square, these lights and nodes besides it.
fn lit(lights: &Value, nodes: &[Value]) -> Value {
    let mut model = quad();
    model["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    model["extensionsRequired"] = json!(["KHR_lights_punctual"]);
    model["extensions"] = json!({ "KHR_lights_punctual": { "lights": lights } });
    let mut all = vec![model["nodes"][0].clone()];
    all.extend(nodes.iter().cloned());
    model["nodes"] = json!(all);
    model
}

fn with_light(mut node: Value, light: usize) -> Value {
    node["extensions"] = json!({ "KHR_lights_punctual": { "light": light } });
    node
}

#[test]
fn nodes_place_and_turn_the_lights_of_a_file() {
    let lights = json!([
        { "type": "directional", "intensity": 3.0, "color": [1.0, 0.5, 0.25], "range": 9.0, "name": "sun" },
        { "type": "point", "intensity": 20.0, "range": 7.5 },
        { "type": "spot", "spot": { "innerConeAngle": 0.25, "outerConeAngle": 0.5 } },
    ]);
    // A quarter turn about +y, then a place: the child's -z points to -x.
    let parent = json!({
        "rotation": [0.0, FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2],
        "translation": [1.0, 2.0, 3.0],
        "scale": [2.0, 2.0, 5.0],
        "children": [2, 3]
    });
    let point = with_light(json!({ "translation": [0.0, 1.0, -1.0] }), 1);
    let mut model = lit(&lights, &[parent, point, with_light(json!({}), 2)]);
    let nodes = model["nodes"].as_array_mut().unwrap();
    nodes.push(with_light(json!({}), 0));
    model["scenes"] = json!([{ "nodes": [0, 1, 4] }]);
    let scene = loaded(&model);
    assert_eq!(scene.warnings, Vec::<String>::new());
    let [point, spot, sun] = scene.lights[..] else {
        panic!("{:?}", scene.lights);
    };
    let close = |found: DVec3, expected: [f64; 3]| {
        assert!(
            (found - DVec3::from_array(expected)).length() < 1e-6,
            "{found}"
        );
    };
    // (0, 1, -1) scaled by (2, 2, 5) is (0, 2, -5), turned (-5, 2, 0), moved (-4, 4, 3).
    match point.emitter {
        Emitter::Point { position } => close(position, [-4.0, 4.0, 3.0]),
        other => panic!("{other:?}"),
    }
    assert_eq!((point.color, point.range), ([20.0; 3], Some(7.5)));
    match spot.emitter {
        Emitter::Spot {
            position,
            direction,
            cone,
        } => {
            close(position, [1.0, 2.0, 3.0]);
            close(direction, [-1.0, 0.0, 0.0]);
            assert_eq!([cone.inner, cone.outer], [0.25, 0.5]);
        }
        other => panic!("{other:?}"),
    }
    match sun.emitter {
        Emitter::Directional { direction } => close(direction, [0.0, 0.0, -1.0]),
        other => panic!("{other:?}"),
    }
    // A directional light has no range.
    assert_eq!((sun.color, sun.range), ([3.0, 1.5, 0.75], None));
    // Lights change the scene; without them it is the one of the bare file.
    assert_ne!(scene.hash, loaded(&quad()).hash);
    assert_eq!(scene.lit_by(Vec::new()).hash, loaded(&quad()).hash);
}

/// Blender writes equal angles for a sharp edge, and f32 rounds pi/2 up.
#[test]
fn cones_as_exporters_write_them() {
    let cone = |spot: Value| {
        let lights = json!([{ "type": "spot", "spot": spot }]);
        let mut model = lit(&lights, &[with_light(json!({}), 0)]);
        model["scenes"] = json!([{ "nodes": [0, 1] }]);
        match loaded(&model).lights[0].emitter {
            Emitter::Spot { cone, .. } => cone,
            other => panic!("{other:?}"),
        }
    };
    let plain = cone(json!({}));
    assert_eq!([plain.inner, plain.outer], [0.0, PI / 4.0]);
    let sharp = cone(json!({ "innerConeAngle": 0.4, "outerConeAngle": 0.4 }));
    assert!(
        sharp.inner < sharp.outer && sharp.inner > 0.3999,
        "{sharp:?}"
    );
    let half = cone(json!({ "outerConeAngle": 1.570_796_370_506_287 }));
    assert_eq!(half.outer, PI / 2.0);
}

#[test]
fn wrong_lights_of_a_file_are_refused() {
    let wrong = |light: Value, node: Value| {
        let mut model = lit(&json!([light]), &[node]);
        model["scenes"] = json!([{ "nodes": [0, 1] }]);
        load(&model).expect_err("a wrong light")
    };
    let plain = || with_light(json!({}), 0);
    let spot = |spot: Value| wrong(json!({ "type": "spot", "spot": spot }), plain());
    let cases = [
        (
            wrong(json!({ "type": "area" }), plain()),
            "its type is \"area\"; expected one of directional, point, spot",
        ),
        (
            wrong(json!({ "intensity": 1.0 }), plain()),
            "light 0: missing field `type`",
        ),
        (
            wrong(json!({ "type": "spot" }), plain()),
            "it has no member spot",
        ),
        (
            wrong(json!({ "type": "point", "intensity": -2.0 }), plain()),
            "intensity -2",
        ),
        (
            wrong(
                json!({ "type": "point", "color": [1.0, -0.5, 0.0] }),
                plain(),
            ),
            "-0.5",
        ),
        (
            wrong(json!({ "type": "point", "range": 0.0 }), plain()),
            "range 0; expected above 0",
        ),
        (
            wrong(json!({ "type": "point" }), with_light(json!({}), 3)),
            "node 1: there is no light 3; the file has 1",
        ),
        (
            wrong(
                json!({ "type": "directional" }),
                with_light(json!({ "scale": [0.0, 0.0, 0.0] }), 0),
            ),
            "has no direction",
        ),
        (
            spot(json!({ "outerConeAngle": 1.7 })),
            "cone angles 0 and 1.7; expected 0 <= inner < outer <= pi/2",
        ),
        (spot(json!({ "innerConeAngle": 0.9 })), "cone angles 0.9"),
        (
            spot(json!({ "outerConeAngle": 0.0 })),
            "cone angles 0 and 0",
        ),
    ];
    for (message, part) in cases {
        assert!(
            message.contains(part) && message.lines().count() == 1,
            "{message}: no {part}"
        );
    }
    // A member that nothing reads is named.
    let mut model = lit(&json!([{ "type": "point", "radius": 1.0 }]), &[plain()]);
    model["scenes"] = json!([{ "nodes": [0, 1] }]);
    assert_eq!(
        loaded(&model).warnings,
        ["not read: KHR_lights_punctual.radius"]
    );
}
