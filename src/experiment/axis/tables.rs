//! The axes of precomputed tables, the last ones of [`super::AXES`].

use super::plain::{LEVELS, PLAIN, one_of, valued};
use super::{Axis, Part, Setter, Symbol, Used};
use crate::base::glsl::constants::LEVELS_MAX;
use crate::base::names::Listed;
use crate::experiment::value::{Kind, Value};
use crate::instrument::environment::layout::MapLayout;
use crate::instrument::precompute::given::{CENTRES, OWN};
use crate::instrument::precompute::prefilter::level_bias::LEVEL_BIASES;
use crate::instrument::precompute::prefilter::{LevelMapping, Weight};
use crate::instrument::precompute::{PrecomputeSettings, PrefilterBy, StorageFormat};

const PRECOMPUTE_SAMPLES_MAX: u32 = 1 << 20;
/// Largest side of a precomputed table: every Vulkan device supports it.
const SIDE_MAX: u32 = 4096;

/// A table that is computed before the frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PrecomputedTable {
    Mips,
    Sh9,
    Prefilter,
    Dfg,
    Irradiance,
}

impl PrecomputedTable {
    /// The first word of its passes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mips => "mips",
            Self::Sh9 => "sh9",
            Self::Prefilter => "prefilter",
            Self::Dfg => "dfg",
            Self::Irradiance => "irradiance",
        }
    }
}

const TABLE_FILE: Kind = Kind::NameOrFile {
    what: "table",
    names: || vec![OWN],
    listed_in: None,
};

const TABLE: Axis = Axis {
    part: Part::Table,
    tables_cost: true,
    ..PLAIN
};

pub(super) const TABLE_AXES: &[Axis] = &[
    Axis {
        name: "layout",
        label: "Map layout",
        about: "texel layout of the filtered maps; `splitsum list layouts`",
        frames_cost: true,
        is_compared: true,
        needs_memory: true,
        feeds: &[
            PrecomputedTable::Mips,
            PrecomputedTable::Prefilter,
            PrecomputedTable::Irradiance,
        ],
        used: |used| {
            used.method.uses_lod_bias
                || used.method.uses_prefiltered()
                || used.uses_irradiance_map()
        },
        set: Setter::Name(|settings, name| {
            settings.shading.precompute.layout = MapLayout::listed(name)
        }),
        ..one_of::<MapLayout>(TABLE)
    },
    Axis {
        name: "prefiltered",
        about: "the prefiltered map: own, or another tool's cube as file:PATH#PRESET \
                (docs/bakes.md)",
        plural: "prefiltered maps",
        symbol: Symbol::Before("map"),
        needs_memory: true,
        feeds: &[PrecomputedTable::Prefilter],
        used: |used| used.method.uses_prefiltered(),
        set: Setter::Name(|settings, name| settings.prefiltered = name.to_owned()),
        ..valued(TABLE_FILE, || Value::from(OWN), TABLE)
    },
    Axis {
        name: "dfg",
        label: "DFG table",
        about: "the DFG table: own, centres (at texel centres, as engines do), or another tool's \
                as file:PATH#PRESET (docs/bakes.md)",
        plural: "DFG tables",
        symbol: Symbol::Before("table"),
        needs_memory: true,
        feeds: &[PrecomputedTable::Dfg],
        used: Used::needs_dfg,
        set: Setter::Name(|settings, name| settings.dfg = name.to_owned()),
        ..valued(
            Kind::NameOrFile {
                what: "table",
                names: || vec![OWN, CENTRES],
                listed_in: None,
            },
            || Value::from(OWN),
            TABLE,
        )
    },
    Axis {
        name: "prefilter_size",
        label: "Map size (px)",
        about: "face size of the first prefiltered level [default: 128x128 by layout cube, 320x320 \
                octahedral, 448x224 equirect]",
        needs_memory: true,
        feeds: &[PrecomputedTable::Prefilter],
        used: Used::shows_computed_prefiltered,
        kind: Kind::Pair {
            min: 8,
            max: SIDE_MAX,
        },
        unset: Some(|layout| Value::Pair(layout.prefilter_size)),
        set: Setter::Pair(|settings, pair| settings.shading.precompute.prefilter_size = pair),
        ..TABLE
    },
    Axis {
        name: "prefilter_level_count",
        label: "Map levels",
        about: "levels of the prefiltered map",
        symbol: Symbol::After("lv", "levels"),
        feeds: &[PrecomputedTable::Prefilter],
        used: |used| used.shows_computed_prefiltered() || used.method.uses_levels,
        kind: Kind::Count {
            min: 2,
            max: LEVELS_MAX,
        },
        default: || Value::Count(PrecomputeSettings::default().prefilter_level_count),
        set: Setter::Count(|settings, count| {
            settings.shading.precompute.prefilter_level_count = count
        }),
        ..TABLE
    },
    Axis {
        name: "prefilter",
        label: "Map filter",
        about: "how to filter maps: exactly in spherical harmonics, or by samples on the device",
        plural: "ways to prefilter",
        symbol: Symbol::After("prefilter", "prefilter"),
        feeds: &[PrecomputedTable::Prefilter, PrecomputedTable::Irradiance],
        used: |used| {
            used.method.prefilter.is_none()
                && (used.shows_computed_prefiltered() || used.uses_irradiance_map())
        },
        set: Setter::Name(|settings, name| {
            settings.shading.precompute.prefilter = *PrefilterBy::listed(name)
        }),
        ..one_of::<PrefilterBy>(TABLE)
    },
    Axis {
        name: "prefilter_sample_count",
        label: "Map samples",
        about: "samples per texel of a sampled prefiltered map",
        symbol: Symbol::After("spp", "samples"),
        feeds: &[PrecomputedTable::Prefilter],
        used: |used| used.shows_computed_prefiltered() && used.has_sampled_tables,
        kind: Kind::Count {
            min: 1,
            max: PRECOMPUTE_SAMPLES_MAX,
        },
        default: || Value::Count(PrecomputeSettings::default().prefilter_sample_count),
        set: Setter::Count(|settings, count| {
            settings.shading.precompute.prefilter_sample_count = count
        }),
        ..TABLE
    },
    Axis {
        name: "level_mapping",
        about: "perceptual roughness of each level: `splitsum list level-mappings`, or a list",
        symbol: Symbol::After("mapping", "mapping"),
        feeds: &[PrecomputedTable::Prefilter],
        used: |used| used.shows_computed_prefiltered() || used.method.uses_levels,
        kind: Kind::NameOrList {
            what: LevelMapping::WHAT,
            names: LevelMapping::names,
            name_of: |roughnesses| LevelMapping::of_list(roughnesses).map(|mapping| mapping.name),
            form: "r:r:r",
        },
        set: Setter::Name(|settings, name| {
            settings.shading.precompute.level_mapping = LevelMapping::checked(name)
        }),
        ..one_of::<LevelMapping>(TABLE)
    },
    Axis {
        name: "prefilter_weight",
        label: "Map weight",
        part: Part::Parameter,
        about: "weight of a direction in a prefiltered texel; `splitsum list prefilter-weights`",
        symbol: Symbol::Before("weight"),
        feeds: &[PrecomputedTable::Prefilter],
        used: |used| used.shows_computed_prefiltered() || used.method.uses_weight,
        set: Setter::Name(|settings, name| {
            settings.shading.precompute.prefilter_weight = Weight::listed(name)
        }),
        ..one_of::<Weight>(TABLE)
    },
    Axis {
        name: "prefilter_lod_bias",
        label: "Map bias (levels)",
        about: "added to the mip level of lookups in a sampled prefilter; `splitsum list \
                level-biases`",
        plural: "prefilter level biases",
        symbol: Symbol::Before("prefilter bias"),
        feeds: &[PrecomputedTable::Prefilter],
        used: |used| used.shows_computed_prefiltered() && used.has_sampled_tables,
        kind: Kind::NumberOrName {
            range: LEVELS,
            what: "level bias",
            named: || {
                LEVEL_BIASES
                    .iter()
                    .map(|bias| (bias.name, bias.levels))
                    .collect()
            },
        },
        default: || Value::Number(0.0),
        set: Setter::Number(|settings, number| {
            settings.shading.precompute.prefilter_lod_bias = number as f32
        }),
        ..TABLE
    },
    Axis {
        name: "dfg_size",
        label: "DFG size (px)",
        about: "side of the DFG table",
        plural: "DFG sizes",
        symbol: Symbol::Before("DFG"),
        needs_memory: true,
        feeds: &[PrecomputedTable::Dfg],
        used: Used::shows_computed_dfg,
        set: Setter::Count(|settings, count| settings.shading.precompute.dfg_size = count),
        ..valued(
            Kind::Count {
                min: 2,
                max: SIDE_MAX,
            },
            || Value::Count(PrecomputeSettings::default().dfg_size),
            TABLE,
        )
    },
    Axis {
        name: "dfg_sample_count",
        label: "DFG samples",
        about: "samples per texel of the DFG table",
        plural: "DFG sample counts",
        symbol: Symbol::After("DFG spp", "DFG samples"),
        feeds: &[PrecomputedTable::Dfg],
        used: Used::shows_computed_dfg,
        kind: Kind::Count {
            min: 1,
            max: PRECOMPUTE_SAMPLES_MAX,
        },
        default: || Value::Count(PrecomputeSettings::default().dfg_sample_count),
        set: Setter::Count(|settings, count| settings.shading.precompute.dfg_sample_count = count),
        ..TABLE
    },
    Axis {
        name: "irradiance_size",
        label: "Irradiance (px)",
        about: "face size of the irradiance map [default: 18x18 by layout cube, 45x45 octahedral, \
                64x32 equirect]",
        symbol: Symbol::Before("irradiance"),
        needs_memory: true,
        feeds: &[PrecomputedTable::Irradiance],
        used: Used::uses_irradiance_map,
        kind: Kind::Pair {
            min: 2,
            max: SIDE_MAX,
        },
        unset: Some(|layout| Value::Pair(layout.irradiance_size)),
        set: Setter::Pair(|settings, pair| settings.shading.precompute.irradiance_size = pair),
        ..TABLE
    },
    Axis {
        name: "irradiance_sample_count",
        label: "Irr. samples",
        about: "azimuth and polar samples per texel of a sampled irradiance map",
        symbol: Symbol::After("irradiance spp", "irradiance samples"),
        feeds: &[PrecomputedTable::Irradiance],
        used: |used| used.uses_irradiance_map() && used.has_sampled_tables,
        kind: Kind::Pair {
            min: 1,
            max: SIDE_MAX,
        },
        default: || Value::Pair(PrecomputeSettings::default().irradiance_sample_count),
        set: Setter::Pair(|settings, pair| {
            settings.shading.precompute.irradiance_sample_count = pair
        }),
        ..TABLE
    },
    Axis {
        name: "storage_format",
        label: "Number format",
        about: "number format of the prefiltered map, DFG table and irradiance map; f16 ends at \
                65504",
        frames_cost: true,
        is_compared: true,
        feeds: &[
            PrecomputedTable::Prefilter,
            PrecomputedTable::Dfg,
            PrecomputedTable::Irradiance,
        ],
        used: |used| {
            used.method.storage.is_none()
                && (used.method.uses_prefiltered()
                    || used.needs_dfg()
                    || used.uses_irradiance_map())
        },
        set: Setter::Name(|settings, name| {
            settings.shading.precompute.storage = *StorageFormat::listed(name)
        }),
        ..one_of::<StorageFormat>(TABLE)
    },
];
