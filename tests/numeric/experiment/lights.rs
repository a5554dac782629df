//! Direct lights of experiments and of the command line.

use super::planned;
use glam::DVec3;
use splitsum::experiment::axis::SCENE;
use splitsum::experiment::lights::{light_text, parse_light};
use splitsum::instrument::scene::Light;
use splitsum::instrument::scene::light::{Cone, Emitter, LightUnit};
use std::f64::consts::PI;

fn lit(light: &str, axes: &str) -> String {
    format!("name = \"x\"\n[[lights]]\n{light}\n[axes]\n{axes}\n")
}

const SUN: &str = "kind = \"directional\"\ndirection = [0, -2, 0]";

#[test]
fn lights_of_a_file_are_read() {
    let text = lit(
        "kind = \"spot\"\nposition = [0, 3, 1]\ndirection = [0, -4, 0]\ncolor = [1, 0.5, \
         0.25]\nintensity = 8\ninner_deg = 10\nouter_deg = 30\nrange = 12\n[[lights]]\nkind = \
         \"point\"\nposition = [1, 2, 3]\nunit = \"map\"",
        "alpha = [0.5]",
    );
    let plan = planned(&text, &[]).unwrap();
    let spot = Emitter::Spot {
        position: DVec3::new(0.0, 3.0, 1.0),
        direction: DVec3::NEG_Y,
        cone: Cone {
            inner: 10.0 * PI / 180.0,
            outer: 30.0 * PI / 180.0,
        },
    };
    let point = Emitter::Point {
        position: DVec3::new(1.0, 2.0, 3.0),
    };
    let wanted = [
        Light {
            emitter: spot,
            color: [8.0, 4.0, 2.0],
            unit: LightUnit::Absolute,
            range: Some(12.0),
        },
        Light {
            emitter: point,
            color: [1.0; 3],
            unit: LightUnit::Map,
            range: None,
        },
    ];
    assert_eq!(plan.config.lights, wanted);
    // As flags, and back.
    for light in wanted {
        let text = light_text(&light);
        let read = parse_light(&text).unwrap_or_else(|fault| panic!("{text}: {fault}"));
        assert_eq!(light_text(&read), text);
        assert_eq!(
            (read.color, read.unit, read.range),
            (light.color, light.unit, light.range)
        );
    }
}

/// Lights are part of a cell's identity, and axes of lights change the request's lights.
#[test]
fn lights_reach_the_requests_of_cells() {
    let plain = planned("name = \"x\"\n[axes]\nalpha = [0.5]\n", &[]).unwrap();
    let axes = "alpha = [0.5]\nlight_intensity = [0, 2]\nlight_turn_deg = [90]";
    let text = lit(&format!("{SUN}\nunit = \"map\""), axes);
    let plan = planned(&text, &[]).unwrap();
    assert_eq!(plan.cells.len(), 2);
    assert!(plan.cells.iter().all(|cell| cell.id != plain.cells[0].id));
    let [off, on] = [0, 1].map(|i| plan.request(&plan.cells[i].point));
    // Without intensity the scene is the one without lights, so every bit stays.
    let unlit = plain.request(&plain.cells[0].point);
    assert_eq!(off.scene.hash, unlit.scene.hash);
    let [light] = on.scene.lights[..] else {
        panic!("{:?}", on.scene.lights);
    };
    let irradiance = 2.0 * PI * on.environment.luminance.mean;
    assert!((f64::from(light.color[0]) / irradiance - 1.0).abs() < 1e-6);
    assert!(
        plan.inputs
            .scene(plan.cells[0].point[SCENE].text())
            .lights
            .is_empty()
    );
}

#[test]
fn wrong_lights_are_refused_at_their_place() {
    let fault = |light: &str, axes: &str| {
        let error = planned(&lit(light, axes), &[]).expect_err("a wrong light");
        error.to_string()
    };
    let of = |light: &str| fault(light, "alpha = [0.5]");
    let cases = [
        (of("kind = \"directional\""), "e.toml:2:1: lights.direction is missing; a directional light needs one"),
        (of("kind = \"point\""), "e.toml:2:1: lights.position is missing; a point light needs one"),
        (of("direction = [0, 1, 0]"), "e.toml:2:1: lights.kind is missing; a light needs one"),
        (of("kind = \"area\""), "e.toml:3:8: lights.kind: \"area\" is not a kind of light; expected one of directional, point, spot"),
        (of("kind = \"directional\"\ndirection = [0, 0, 0]"), "e.toml:4:13: lights.direction: its length is 0"),
        (of("kind = \"directional\"\ndirection = 1"), "e.toml:4:13: lights.direction: 1 is not [x, y, z]"),
        (of(&format!("{SUN}\nintensity = -1")), "e.toml:5:13: lights.intensity: -1 is outside [0, 1000000000]"),
        (of(&format!("{SUN}\nintensity = nan")), "e.toml:5:13: lights.intensity: nan is outside [0, 1000000000]"),
        (of(&format!("{SUN}\ncolor = [1, -1, 1]")), "e.toml:5:9: lights.color: -1 is outside [0, 1000000000]"),
        (of(&format!("{SUN}\nrange = 3")), "e.toml:5:9: lights.range: has no effect on a directional light; leave it out"),
        (of(&format!("{SUN}\nwidth = 3")), "e.toml:5:1: lights.width is unknown; expected"),
        (
            of("kind = \"spot\"\nposition = [0, 1, 0]\ndirection = [0, -1, 0]\nouter_deg = 95"),
            "e.toml:6:13: lights.outer_deg: 95 is outside (0, 90]",
        ),
        (
            of("kind = \"spot\"\nposition = [0, 1, 0]\ndirection = [0, -1, 0]\ninner_deg = 60"),
            "e.toml:6:13: lights.inner_deg: 60 degrees inside, 45 outside; expected less inside",
        ),
        (
            fault("kind = \"point\"\nposition = [0, 1, 0]", "scene = [\"design\"]"),
            "lights: surfaces of the scene design have no position; expected directional lights",
        ),
        (
            planned("name = \"x\"\n[axes]\nlight_intensity = [1, 2]\n", &[]).expect_err("no light").to_string(),
            "e.toml:3:23: light_intensity: the experiment has no light; add [[lights]]",
        ),
        (
            planned(&format!("name = \"x\"\n[ladder]\n[[lights]]\n{SUN}\n[axes]\nscene = [\"design\"]\nmethod = [\"split-sum\"]\n"), &[])
                .expect_err("a ladder").to_string(),
            "lights: [ladder] divides errors under the environment; remove one of them",
        ),
    ];
    for (message, part) in cases {
        assert!(message.contains(part), "{message}\ninstead of {part}");
        assert_eq!(message.lines().count(), 1, "{message}");
    }
}
