//! Direct lights as users write them: `[[lights]]` of an experiment, and `--light`.

use super::config::Config;
use super::fault::Faults;
use super::toml_tree::{checked_as, list, section, start_of};
use super::value::{COORDINATE, Kind, Range, Raw, Value};
use crate::base::names::{Listed, suggestion, with_article};
use crate::base::numbers::round_to_significant;
use crate::instrument::scene::Light;
use crate::instrument::scene::light::{Cone, Emitter, LightKind, LightUnit};
use glam::DVec3;
use std::collections::BTreeMap;
use toml::Spanned;
use toml::de::DeValue;

/// Significant digits of angles in messages.
const DIGITS: usize = 6;

const STRENGTH: Range = Range::closed(0.0, 1e9);
const DISTANCE: Range = Range::above(0.0, 1e9);

/// How the value of a field is written.
#[derive(Clone, Copy)]
enum Form {
    /// `[x, y, z]` in files, `x,y,z` on the command line.
    Vector,
    Plain(Kind),
}

/// A field of a light.
struct Field {
    name: &'static str,
    form: Form,
    /// The kinds of light that it describes.
    kinds: &'static [LightKind],
}

const EVERY: &[LightKind] = &[LightKind::Directional, LightKind::Point, LightKind::Spot];
const PLACED: &[LightKind] = &[LightKind::Point, LightKind::Spot];
const AIMED: &[LightKind] = &[LightKind::Directional, LightKind::Spot];
const SPOT: &[LightKind] = &[LightKind::Spot];

const KIND: &str = "kind";
const DIRECTION: &str = "direction";
const POSITION: &str = "position";
const COLOR: &str = "color";
const INTENSITY: &str = "intensity";
const UNIT: &str = "unit";
const RANGE: &str = "range";
const INNER: &str = "inner_deg";
const OUTER: &str = "outer_deg";

const FIELDS: &[Field] = &[
    Field {
        name: KIND,
        form: Form::Plain(Kind::one_of::<LightKind>()),
        kinds: EVERY,
    },
    Field {
        name: DIRECTION,
        form: Form::Vector,
        kinds: AIMED,
    },
    Field {
        name: POSITION,
        form: Form::Vector,
        kinds: PLACED,
    },
    Field {
        name: COLOR,
        form: Form::Plain(Kind::Color(STRENGTH)),
        kinds: EVERY,
    },
    Field {
        name: INTENSITY,
        form: Form::Plain(Kind::Number(STRENGTH)),
        kinds: EVERY,
    },
    Field {
        name: UNIT,
        form: Form::Plain(Kind::one_of::<LightUnit>()),
        kinds: EVERY,
    },
    Field {
        name: RANGE,
        form: Form::Plain(Kind::Number(DISTANCE)),
        kinds: PLACED,
    },
    Field {
        name: INNER,
        form: Form::Plain(Kind::Number(Range::closed(0.0, 90.0))),
        kinds: SPOT,
    },
    Field {
        name: OUTER,
        form: Form::Plain(Kind::Number(Range::above(0.0, 90.0))),
        kinds: SPOT,
    },
];

impl Form {
    fn parse(self, raw: &Raw) -> Result<Value, String> {
        match (self, raw) {
            (Self::Vector, Raw::Array(numbers)) if numbers.len() == 3 => {
                Kind::Color(COORDINATE).parse(raw)
            }
            (Self::Vector, _) => Err(format!("{raw} is not [x, y, z]")),
            (Self::Plain(kind), _) => kind.parse(raw),
        }
    }

    fn parse_text(self, text: &str) -> Result<Value, String> {
        match self {
            // A colour may be one number, a vector may not.
            Self::Vector if text.split(',').count() != 3 => Err(format!("{text:?} is not x,y,z")),
            Self::Vector => Kind::Color(COORDINATE).parse_text(text),
            Self::Plain(kind) => kind.parse_text(text),
        }
    }
}

/// The fields of a light that the user wrote.
#[derive(Default)]
struct Fields(BTreeMap<&'static str, Value>);

/// Why fields are not a light.
#[derive(Debug)]
struct LightFault {
    /// The field to blame; `None` if one is missing.
    field: Option<&'static str>,
    text: String,
}

impl LightFault {
    fn of(field: &'static str, text: String) -> Self {
        Self {
            field: Some(field),
            text: format!("{field}: {text}"),
        }
    }
}

impl Fields {
    fn light(&self) -> Result<Light, LightFault> {
        let kind = *LightKind::listed(self.required(KIND, "a light")?.text());
        let name = with_article(&format!("{} light", kind.name()));
        let idle = FIELDS
            .iter()
            .find(|field| !field.kinds.contains(&kind) && self.0.contains_key(field.name));
        if let Some(field) = idle {
            let text = format!("has no effect on {name}; leave it out");
            return Err(LightFault::of(field.name, text));
        }
        let emitter = match kind {
            LightKind::Directional => Emitter::Directional {
                direction: self.direction(&name)?,
            },
            LightKind::Point => Emitter::Point {
                position: vector(self.required(POSITION, &name)?),
            },
            LightKind::Spot => Emitter::Spot {
                position: vector(self.required(POSITION, &name)?),
                direction: self.direction(&name)?,
                cone: self.cone()?,
            },
        };
        let intensity = self.0.get(INTENSITY).map_or(1.0, Value::number) as f32;
        let color = self.0.get(COLOR).map_or([1.0; 3], Value::color);
        let unit = self.0.get(UNIT).map(|unit| *LightUnit::listed(unit.text()));
        Ok(Light {
            emitter,
            color: color.map(|channel| channel * intensity),
            unit: unit.unwrap_or_default(),
            range: self.0.get(RANGE).map(Value::number),
        })
    }

    fn required(&self, field: &'static str, of: &str) -> Result<&Value, LightFault> {
        self.0.get(field).ok_or_else(|| LightFault {
            field: None,
            text: format!("{field} is missing; {of} needs one"),
        })
    }

    fn direction(&self, of: &str) -> Result<DVec3, LightFault> {
        let direction = vector(self.required(DIRECTION, of)?);
        direction
            .try_normalize()
            .ok_or_else(|| LightFault::of(DIRECTION, "its length is 0".to_owned()))
    }

    fn cone(&self) -> Result<Cone, LightFault> {
        let plain = Cone::default();
        let radians = |field: &str| self.0.get(field).map(|value| value.number().to_radians());
        let cone = Cone {
            inner: radians(INNER).unwrap_or(plain.inner),
            outer: radians(OUTER).unwrap_or(plain.outer),
        };
        if cone.inner < cone.outer {
            return Ok(cone);
        }
        let field = if self.0.contains_key(INNER) {
            INNER
        } else {
            OUTER
        };
        let [inner, outer] =
            [cone.inner, cone.outer].map(|angle| round_to_significant(angle.to_degrees(), DIGITS));
        let text = format!("{inner} degrees inside, {outer} outside; expected less inside");
        Err(LightFault::of(field, text))
    }
}

fn vector(value: &Value) -> DVec3 {
    DVec3::from_array(value.color().map(f64::from))
}

/// Parses `KIND:FIELD=VALUE:...`.
pub fn parse_light(text: &str) -> Result<Light, String> {
    let mut words = text.split(':');
    let mut fields = Fields::default();
    let kind = words.next().unwrap_or_default();
    fields.read_text(KIND, kind)?;
    for word in words {
        let (name, value) = word
            .split_once('=')
            .ok_or_else(|| format!("{word:?} is not FIELD=VALUE"))?;
        fields.read_text(name.trim(), value)?;
    }
    fields.light().map_err(|fault| fault.text)
}

impl Fields {
    fn read_text(&mut self, name: &str, text: &str) -> Result<(), String> {
        let Some(field) = FIELDS.iter().find(|field| field.name == name) else {
            let names: Vec<&str> = FIELDS.iter().map(|field| field.name).collect();
            let near = suggestion(name, &names);
            let hint = if near.is_empty() {
                format!("; expected {}", names[1..].join(", "))
            } else {
                near
            };
            return Err(format!("{name:?} is not a field of a light{hint}"));
        };
        let value = field
            .form
            .parse_text(text)
            .map_err(|fault| format!("{name}: {fault}"))?;
        match self.0.insert(field.name, value) {
            Some(_) => Err(format!("{name} is written twice")),
            None => Ok(()),
        }
    }
}

/// Writes a light as `--light` takes it.
pub fn light_text(light: &Light) -> String {
    let joined = |numbers: [f64; 3]| numbers.map(|x| (x as f32).to_string()).join(",");
    let mut fields = Vec::new();
    let (kind, position, direction, cone) = match light.emitter {
        Emitter::Directional { direction } => (LightKind::Directional, None, Some(direction), None),
        Emitter::Point { position } => (LightKind::Point, Some(position), None, None),
        Emitter::Spot {
            position,
            direction,
            cone,
        } => (LightKind::Spot, Some(position), Some(direction), Some(cone)),
    };
    for (name, vector) in [(POSITION, position), (DIRECTION, direction)] {
        fields.extend(vector.map(|vector| format!("{name}={}", joined(vector.to_array()))));
    }
    fields.push(format!("{COLOR}={}", joined(light.color.map(f64::from))));
    if let Some(cone) = cone {
        fields.push(format!("{INNER}={}", cone.inner.to_degrees() as f32));
        fields.push(format!("{OUTER}={}", cone.outer.to_degrees() as f32));
    }
    fields.extend(light.range.map(|range| format!("{RANGE}={range}")));
    if light.unit != LightUnit::default() {
        fields.push(format!("{UNIT}={}", light.unit.name()));
    }
    format!("{}:{}", kind.name(), fields.join(":"))
}

impl Config {
    /// `[[lights]]`
    pub(super) fn read_lights(&mut self, value: &Spanned<DeValue>, faults: &mut Faults) {
        self.lights_location = start_of(value);
        let names: Vec<&str> = FIELDS.iter().map(|field| field.name).collect();
        for item in list(value, "lights", faults) {
            let mut fields = Fields::default();
            let mut places = BTreeMap::new();
            let mut is_read = true;
            for (key, value, _) in section(item, "lights", &names, faults) {
                let Some(field) = FIELDS.iter().find(|field| field.name == key) else {
                    continue;
                };
                let parse = |raw: &Raw| field.form.parse(raw);
                let key = format!("lights.{key}");
                match checked_as(parse, &key, value, faults) {
                    Some(found) => drop(fields.0.insert(field.name, found)),
                    None => is_read = false,
                }
                places.insert(field.name, start_of(value));
            }
            if !is_read {
                continue;
            }
            match fields.light() {
                Ok(light) => self.lights.push(light),
                Err(LightFault { field, text }) => {
                    let place = field.and_then(|field| places.get(field).cloned());
                    let place = place.unwrap_or_else(|| start_of(item));
                    faults.add(&place, format!("lights.{text}"));
                }
            }
        }
    }
}
