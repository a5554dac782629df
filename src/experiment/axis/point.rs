//! One value for each axis.

use super::{
    ALBEDO, ANISOTROPY, AXES, Axis, AxisId, COAT, DFG_TABLE, DIFFUSE_METHOD, LAYOUT, METALLIC,
    METHOD, PREFILTER_BY, PREFILTERED, Part, Reference, SCENE, SHEEN_COLOR, Settings, Used,
};
use crate::base::names::Listed;
use crate::experiment::value::Value;
use crate::instrument::environment::layout::{LAYOUTS, MapLayout};
use crate::instrument::precompute::PrefilterBy;
use crate::instrument::precompute::given::OWN;
use crate::instrument::scene::{MaterialOverride, SCENES};
use crate::instrument::shade::{DIFFUSE, Diffuse, METHODS, Method, Shading};
use crate::instrument::tonemap::ToneCurve;
use std::collections::HashSet;
use std::ops::{Index, IndexMut};
use std::sync::Arc;

/// Axes whose values are stored together. Cells of a plan differ on few axes, so that most of their
/// groups are equal.
const GROUP_LENGTH: usize = 8;

/// The last group of a point is filled up with unset values.
type Group = Arc<[Value; GROUP_LENGTH]>;

/// One value for every axis. Copies share their values until one of them is changed, because a plan,
/// its records and its answers each keep the point of a cell; other points may share groups of
/// values ([`Points`]).
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Point {
    groups: Arc<[Group]>,
}

/// Lets equal groups of values of many points share their memory.
#[derive(Debug, Default)]
pub struct Points {
    groups: HashSet<Group>,
}

impl Points {
    /// Returns an equal point. Groups that an earlier point has, too, are shared with it.
    pub fn shared(&mut self, point: &Point) -> Point {
        let groups = point.groups.iter().map(|group| {
            if let Some(known) = self.groups.get(group) {
                return known.clone();
            }
            self.groups.insert(group.clone());
            group.clone()
        });
        let groups: Vec<Group> = groups.collect();
        let is_shared = |(a, b): (&Group, &Group)| Arc::ptr_eq(a, b);
        if groups.iter().zip(&*point.groups).all(is_shared) {
            return point.clone();
        }
        Point {
            groups: groups.into(),
        }
    }
}

impl Index<AxisId> for Point {
    type Output = Value;

    fn index(&self, axis: AxisId) -> &Value {
        let position = axis.position();
        &self.groups[position / GROUP_LENGTH][position % GROUP_LENGTH]
    }
}

impl IndexMut<AxisId> for Point {
    fn index_mut(&mut self, axis: AxisId) -> &mut Value {
        let position = axis.position();
        let group = &mut Arc::make_mut(&mut self.groups)[position / GROUP_LENGTH];
        &mut Arc::make_mut(group)[position % GROUP_LENGTH]
    }
}

impl Default for Point {
    fn default() -> Self {
        AXES.iter().map(|axis| (axis.default)()).collect()
    }
}

impl FromIterator<Value> for Point {
    /// The values in the order of [`AXES`].
    fn from_iter<I: IntoIterator<Item = Value>>(values: I) -> Self {
        let values: Vec<Value> = values.into_iter().collect();
        assert_eq!(values.len(), AXES.len(), "one value for each axis");
        let group = |chunk: &[Value]| {
            let value = |index| chunk.get(index).unwrap_or(&Value::Unset).clone();
            Group::new(std::array::from_fn(value))
        };
        Self {
            groups: values.chunks(GROUP_LENGTH).map(group).collect(),
        }
    }
}

impl Point {
    /// The values in the order of [`AXES`].
    pub fn values(&self) -> impl Iterator<Item = &Value> {
        let values = self.groups.iter().flat_map(|group| group.iter());
        values.take(AXES.len())
    }

    pub fn get(&self, name: &str) -> &Value {
        &self[AxisId::find(name).unwrap_or_else(|| panic!("{name} is not an axis"))]
    }

    pub fn method(&self) -> &'static Method {
        Method::listed(self[METHOD].text())
    }

    pub fn diffuse(&self) -> &'static Diffuse {
        Diffuse::listed(self[DIFFUSE_METHOD].text())
    }

    fn layout(&self) -> &'static MapLayout {
        let name = (self[LAYOUT] != Value::Unset).then(|| self[LAYOUT].text());
        name.map_or(&LAYOUTS[0], |name| MapLayout::listed(name))
    }

    /// Returns the default of an axis in the point's layout.
    pub fn default_of(&self, axis: AxisId) -> Value {
        AXES[axis]
            .unset
            .map_or_else(AXES[axis].default, |of_layout| of_layout(self.layout()))
    }

    /// Unsets every unused parameter, so that points with equal work are equal. Cells are
    /// identified by this point.
    pub fn collapsed(&self) -> Self {
        self.where_used(true, true)
    }

    /// Unsets every parameter that cannot reach the pixels, so that points with equal images are
    /// equal. Beyond [`Point::collapsed`]: the diffuse term of black and metal surfaces, and F0
    /// where nothing is a dielectric.
    pub fn of_pixels(&self) -> Self {
        let is_metal = self[METALLIC] == Value::Number(1.0);
        let is_black = self[ALBEDO] == Value::Color([0.0; 3]);
        self.where_used(!(is_metal || is_black), !is_metal)
    }

    fn where_used(&self, has_diffuse_surface: bool, has_dielectric: bool) -> Self {
        let used = self.used(has_diffuse_surface, has_dielectric);
        let value = |(axis, value): (&Axis, &Value)| {
            if !(axis.used)(&used) {
                return Value::Unset;
            }
            match axis.unset {
                Some(of_layout) if *value == Value::Unset => of_layout(self.layout()),
                _ => value.clone(),
            }
        };
        let point: Self = AXES.iter().zip(self.values()).map(value).collect();
        // An equal point keeps sharing its values.
        if point == *self { self.clone() } else { point }
    }

    fn used(&self, has_diffuse_surface: bool, has_dielectric: bool) -> Used {
        let method = self.method();
        let has_sampled_tables = match method.prefilter {
            Some(by) => by != PrefilterBy::Harmonic,
            None => self[PREFILTER_BY].to_string() != PrefilterBy::Harmonic.name(),
        };
        let is_file = |axis: AxisId| AXES[axis].kind.path_in(&self[axis].to_string()).is_some();
        let is_built_in = SCENES.iter().any(|entry| entry.name == self[SCENE].text());
        // Materials of a file may have the layer.
        let may_have =
            |axis: AxisId| !(self[axis].is_zero() || self[axis] == Value::Unset && is_built_in);
        let shading = self.settings().shading;
        let has_frames = shading.frames.count > 1 && method.uses_point_set;
        Used {
            method,
            diffuse: self.diffuse(),
            compensation: shading.compensation,
            // Compensation may add a diffuse term to any surface.
            has_diffuse_surface: has_diffuse_surface || shading.compensation.is_diffuse(),
            has_dielectric,
            has_coat: may_have(COAT),
            has_anisotropy: may_have(ANISOTROPY),
            has_sheen: may_have(SHEEN_COLOR),
            has_occlusion: !is_built_in,
            frames: has_frames.then_some(shading.frames),
            has_sampled_tables,
            makes_prefiltered: !is_file(PREFILTERED),
            makes_dfg: !is_file(DFG_TABLE),
        }
    }

    /// Whether the table of [`PREFILTERED`] or [`DFG_TABLE`] is the program's own.
    pub fn is_computed(&self, axis: AxisId) -> bool {
        [Value::Unset, (AXES[axis].default)()].contains(&self[axis])
    }

    /// Returns the collapsed point of this point's reference.
    pub fn reference(&self, reference: &Reference) -> Self {
        let values = AXES
            .iter()
            .zip(self.values())
            .map(|(axis, value)| match axis.part {
                Part::Table => (axis.default)(),
                _ => (axis.reference)(reference, value),
            });
        values.collect::<Self>().collapsed()
    }

    pub fn settings(&self) -> Settings {
        let mut settings = Settings {
            size: [1, 1],
            environment: String::new(),
            scene: String::new(),
            material: MaterialOverride::default(),
            light_intensity: 1.0,
            light_turn_deg: 0.0,
            shading: Shading {
                method: &METHODS[0],
                diffuse: &DIFFUSE[0],
                samples: 1,
                ..Shading::default()
            },
            prefiltered: OWN.to_owned(),
            dfg: OWN.to_owned(),
            curve: ToneCurve::default(),
        };
        for (axis, value) in AXES.iter().zip(self.values()) {
            axis.set.apply(&mut settings, value);
        }
        settings
    }
}
