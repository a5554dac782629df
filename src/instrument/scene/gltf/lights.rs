//! `KHR_lights_punctual`: the lights of nodes [KhrLights18].
//!
//! A light is at the origin of its node and shines along the node's -z axis; scales do not change
//! it. The numbers of candela and lux are intensity and irradiance in the unit of the environment's
//! radiance: 1 lux lights like an irradiance of 1.

use super::extensions::{LIGHTS, unknown_member};
use super::name;
use crate::base::names::{Listed, expected};
use crate::instrument::scene::light::{Cone, Emitter, Light, LightKind, LightUnit, OUTER_MAX};
use ::gltf::{Document, Node};
use glam::{DMat4, DVec3};
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeSet;

/// Rounding of angles in files.
const ANGLE_ERROR: f64 = 1e-6;
/// Inner angle of a spot with a sharp edge, which exporters write as equal angles, over the outer.
const SHARP: f64 = 0.9999;

#[derive(Deserialize)]
#[serde(expecting = "an object")]
struct PunctualLight {
    #[serde(default)]
    name: Option<String>,
    #[serde(rename = "type")]
    kind: String,
    #[serde(default = "white")]
    color: [f32; 3],
    #[serde(default = "one")]
    intensity: f32,
    range: Option<f64>,
    spot: Option<Spot>,
}

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase", expecting = "an object")]
struct Spot {
    inner_cone_angle: Option<f64>,
    outer_cone_angle: Option<f64>,
}

fn white() -> [f32; 3] {
    [1.0; 3]
}

fn one() -> f32 {
    1.0
}

/// Returns the light of a node; `unread` takes the names of members that are not read.
pub fn of_node(
    document: &Document,
    node: &Node,
    to_world: DMat4,
    unread: &mut BTreeSet<String>,
) -> Result<Option<Light>, String> {
    let Some(reference) = node.extension_value(LIGHTS) else {
        return Ok(None);
    };
    let place = name("node", node.name(), node.index());
    let index = reference.get("light").and_then(Value::as_u64);
    let index = index.ok_or_else(|| format!("{place}: {LIGHTS}.light is not an index"))? as usize;
    let lights = document
        .extension_value(LIGHTS)
        .and_then(|extension| extension.get("lights"))
        .and_then(Value::as_array);
    let value = lights.and_then(|lights| lights.get(index)).ok_or_else(|| {
        let count = lights.map_or(0, Vec::len);
        format!("{place}: there is no light {index}; the file has {count}")
    })?;
    let light: Result<PunctualLight, _> = serde_ignored::deserialize(value, |path| {
        unread.extend(unknown_member(&path).map(|path| format!("{LIGHTS}.{path}")));
    });
    let light = light.map_err(|error| format!("{}: {error}", name("light", None, index)))?;
    light
        .placed(to_world)
        .map(Some)
        .map_err(|fault| format!("{}: {fault}", name("light", light.name.as_deref(), index)))
}

impl PunctualLight {
    fn placed(&self, to_world: DMat4) -> Result<Light, String> {
        let kind = LightKind::by_name(&self.kind).ok_or_else(|| {
            let kinds = expected(&LightKind::names(), None);
            format!("its type is {:?}; expected {kinds}", self.kind)
        })?;
        let is_negative = |x: &f32| *x < 0.0;
        if is_negative(&self.intensity) || self.color.iter().any(is_negative) {
            return Err(format!(
                "intensity {} with colour {:?}; expected at least 0",
                self.intensity, self.color
            ));
        }
        if let Some(range) = self.range.filter(|range| *range <= 0.0) {
            return Err(format!("range {range}; expected above 0"));
        }
        let position = to_world.transform_point3(DVec3::ZERO);
        let direction = to_world.transform_vector3(DVec3::NEG_Z).try_normalize();
        let no_axis = "its node has a scale of 0, so it has no direction";
        let emitter = match kind {
            LightKind::Directional => Emitter::Directional {
                direction: direction.ok_or(no_axis)?,
            },
            LightKind::Point => Emitter::Point { position },
            LightKind::Spot => Emitter::Spot {
                position,
                direction: direction.ok_or(no_axis)?,
                cone: self.spot.as_ref().ok_or("it has no member spot")?.cone()?,
            },
        };
        Ok(Light {
            emitter,
            color: self.color.map(|channel| channel * self.intensity),
            unit: LightUnit::Absolute,
            // A directional light has none.
            range: self.range.filter(|_| *kind != LightKind::Directional),
        })
    }
}

impl Spot {
    fn cone(&self) -> Result<Cone, String> {
        let plain = Cone::default();
        let inner = self.inner_cone_angle.unwrap_or(plain.inner);
        let outer = self.outer_cone_angle.unwrap_or(plain.outer);
        let is_possible = 0.0 < outer
            && outer <= OUTER_MAX + ANGLE_ERROR
            && (0.0..=outer + ANGLE_ERROR).contains(&inner);
        if !is_possible {
            return Err(format!(
                "cone angles {inner} and {outer}; expected 0 <= inner < outer <= pi/2"
            ));
        }
        let outer = outer.min(OUTER_MAX);
        Ok(Cone {
            inner: inner.min(SHARP * outer),
            outer,
        })
    }
}
