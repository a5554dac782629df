//! Analytic lights of an experiment, in its file or as a flag.

use super::config::Config;
use super::fault::Faults;
use super::toml_tree::{at, checked, list, section};
use super::value::{COORDINATE, Kind, Range};
use crate::scene::{Light, LightKind};
use crate::spelling::Listed;
use glam::DVec3;
use toml::Spanned;
use toml::de::DeValue;

/// Radiance or irradiance of a light.
pub const LIGHT_COLOR: Range = Range::closed(0.0, 1e9);

impl Config {
    pub(super) fn read_lights(&mut self, value: &Spanned<DeValue>, faults: &mut Faults) {
        for item in list(value, "lights", faults) {
            let (mut kind, mut vector, mut color) = (None, None, None);
            let names = Kind::one_of::<LightKind>();
            for (key, value, _) in section(item, "lights", &["kind", "direction", "position", "color"], faults) {
                let range = if key == "color" { LIGHT_COLOR } else { COORDINATE };
                let of = if key == "kind" { names } else { Kind::Color(range) };
                let found = checked(of, &format!("lights.{key}"), value, faults);
                match key {
                    "kind" => kind = found.map(|v| v.text().to_owned()),
                    "color" => color = found.map(|v| v.color()),
                    _ => vector = found.map(|v| (key, v.color())),
                }
            }
            let light = match (kind.as_deref(), vector) {
                (Some("directional"), Some(("direction", d))) => light(LightKind::Directional, d, color),
                (Some("point"), Some(("position", p))) => light(LightKind::Point, p, color),
                _ => Err("needs kind = \"directional\" with direction, or kind = \"point\" with position".to_owned()),
            };
            match light {
                Ok(light) => {
                    self.lights.push(light);
                    self.light_places.push(at(item));
                }
                Err(fault) => faults.add(&at(item), format!("lights: {fault}")),
            }
        }
    }
}

/// Builds a light from checked parts.
pub fn light(kind: LightKind, vector: [f32; 3], color: Option<[f32; 3]>) -> Result<Light, String> {
    let color = color.ok_or("color is missing")?;
    let vector = DVec3::from(vector.map(f64::from));
    let position_or_direction = match kind {
        LightKind::Directional => vector.try_normalize().ok_or("direction must not be zero")?,
        LightKind::Point => vector,
    };
    Ok(Light { kind, position_or_direction, color })
}

/// Parses `x,y,z`.
pub fn coordinates(text: &str) -> Result<[f32; 3], String> {
    // A colour may be one number, a place may not.
    let is_whole = text.split(',').count() == 3;
    let numbers = Kind::Color(COORDINATE).parse_text(text).ok().filter(|_| is_whole);
    numbers.map(|numbers| numbers.color()).ok_or_else(|| format!("{text:?} is not x,y,z"))
}

/// Parses `directional:X,Y,Z:R,G,B` (towards the light; irradiance) or `point:X,Y,Z:R,G,B` (intensity).
pub fn parse_light(text: &str) -> Result<Light, String> {
    let parts: Vec<&str> = text.split(':').collect();
    let [kind, vector, color] = parts[..] else {
        return Err(format!("{text:?} is not directional:X,Y,Z:R,G,B or point:X,Y,Z:R,G,B"));
    };
    let kind = *LightKind::parse(kind)?;
    let color = Kind::Color(LIGHT_COLOR).parse_text(color)?.color();
    light(kind, coordinates(vector)?, Some(color))
}

/// Writes a light for [`parse_light`].
pub fn light_text(light: &Light) -> String {
    let numbers = |three: [f32; 3]| three.map(|x| x.to_string()).join(",");
    let place = light.position_or_direction.as_vec3().to_array();
    format!("{}:{}:{}", light.kind.name(), numbers(place), numbers(light.color))
}
