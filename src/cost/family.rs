//! Families of GPUs that the driver may compile for, and what is published of their rates.
//!
//! | constant | source |
//! |---|---|
//! | vector lanes | 64 a clock: four 16-wide units [Lottes16], two 32-wide ones [AmdRdnaPaper19]; RDNA 3 up to 128 [RocmProfiler25] |
//! | quarter rate | which instructions [LlvmAmdgpu20]; beside other work from RDNA on [AmdRdnaPaper19] |
//! | scalar | one a clock and unit on GCN, two from RDNA on [AmdRdnaPaper19] |
//! | unfiltered texels | four of 128 bits a clock [Lottes16] |
//! | filtered texels | GCN: 32 bits of four pixels a clock [Lottes16]; RDNA: 64 bits, twice of that [AmdRdna19] |
//! | first-level cache | 64 bytes a clock on GCN, 128 from RDNA on [AmdRdnaPaper19] |
//! | compute units, clocks | the makers' pages [AmdCards22; Valve22] |

use super::isa::Counts;

/// Rates of one compute unit of a generation. Pairs are the optimistic and the pessimistic end.
#[derive(Debug)]
pub struct Generation {
    pub name: &'static str,
    /// Lanes of full-rate vector arithmetic a clock. RDNA 3 doubles what its compiler and register banks let pair.
    alu_lanes: [f64; 2],
    /// Whether quarter-rate instructions keep the full-rate unit busy.
    shares_quarter: bool,
    /// Scalar instructions a clock.
    scalars: f64,
    /// Clocks in which four pixels' bilinear lookups are filtered, by [`Texel`]. Nothing is published for 128-bit texels on RDNA: between
    /// the rate that their width suggests and GCN's.
    quad_clocks: [[f64; 2]; 2],
    /// Bytes of the first-level vector cache a clock.
    cache_bytes: f64,
}

/// Lanes of quarter-rate arithmetic a clock, on every generation.
const QUARTER_LANES: f64 = 16.0;
/// Pixels that the texture unit takes at a time.
const QUAD: f64 = 4.0;

const GCN_5: Generation = Generation {
    name: "GCN 5",
    alu_lanes: [64.0; 2],
    shares_quarter: true,
    scalars: 1.0,
    quad_clocks: [[2.0; 2], [4.0; 2]],
    cache_bytes: 64.0,
};
const RDNA_1: Generation = Generation {
    name: "RDNA 1",
    alu_lanes: [64.0; 2],
    shares_quarter: false,
    scalars: 2.0,
    quad_clocks: [[1.0; 2], [2.0, 4.0]],
    cache_bytes: 128.0,
};
const RDNA_2: Generation = Generation { name: "RDNA 2", ..RDNA_1 };
const RDNA_3: Generation = Generation { name: "RDNA 3", alu_lanes: [128.0, 64.0], ..RDNA_1 };

/// A family of GPUs with the same code.
#[derive(Debug)]
pub struct Family {
    pub name: &'static str,
    /// What RADV calls it, in the order in which to ask: newer versions have other names.
    pub driver_names: &'static [&'static str],
    pub generation: Generation,
    pub cards: &'static [Card],
}

/// A product.
#[derive(Debug)]
pub struct Card {
    pub name: &'static str,
    pub compute_units: u32,
    /// The boost clock, and the clock that the maker names for games (GCN: the base clock), MHz.
    pub clock_mhz: [f64; 2],
}

const fn card(name: &'static str, compute_units: u32, boost: f64, game: f64) -> Card {
    Card { name, compute_units, clock_mhz: [boost, game] }
}

/// Every family of the model. A driver may lack some.
pub static FAMILIES: &[Family] = &[
    Family {
        name: "vega10",
        driver_names: &["vega10"],
        generation: GCN_5,
        cards: &[card("Radeon RX Vega 64", 64, 1546.0, 1247.0)],
    },
    Family {
        name: "navi10",
        driver_names: &["navi10"],
        generation: RDNA_1,
        cards: &[card("Radeon RX 5700 XT", 40, 1905.0, 1755.0)],
    },
    Family {
        name: "navi21",
        driver_names: &["navi21"],
        generation: RDNA_2,
        cards: &[card("Radeon RX 6800 XT", 72, 2250.0, 2015.0)],
    },
    Family {
        name: "vangogh",
        driver_names: &["vangogh"],
        generation: RDNA_2,
        cards: &[card("Steam Deck", 8, 1600.0, 1000.0)],
    },
    Family {
        name: "gfx1100",
        driver_names: &["gfx1100", "navi31"],
        generation: RDNA_3,
        cards: &[card("Radeon RX 7900 XTX", 96, 2500.0, 2300.0)],
    },
];

/// The family of that name, or of that name of the driver's.
pub fn family_by_name(name: &str) -> Option<&'static Family> {
    FAMILIES.iter().find(|family| family.name == name || family.driver_names.contains(&name))
}

/// How a texel of the maps is stored. The shader's code does not depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Texel {
    Rgba16f,
    Rgba32f,
}

impl Texel {
    /// Every format with its name; the first is the default.
    pub const ALL: &[(&str, Self)] = &[("rgba16f", Self::Rgba16f), ("rgba32f", Self::Rgba32f)];
}

/// Units of a compute unit, in the order of [`Generation::clocks`].
pub const UNITS: [&str; 5] = ["alu", "quarter-rate", "scalar", "texture", "cache"];

impl Generation {
    /// Clocks of a compute unit in which each of [`UNITS`] executes the counts of one pixel, at an end (0: optimistic).
    ///
    /// A trilinear lookup takes two bilinear ones. `wave` is the number of lanes that share a scalar instruction.
    pub fn clocks(&self, counts: &Counts, texel: Texel, wave: u32, end: usize) -> [f64; 5] {
        let Counts { alu, quarter, scalar, unfiltered, bilinear, trilinear, memory_bytes } = *counts;
        let quarter = quarter / QUARTER_LANES;
        let alu = alu / self.alu_lanes[end];
        let [alu, quarter] = if self.shares_quarter { [alu + quarter, 0.0] } else { [alu, quarter] };
        let filtered = (bilinear + 2.0 * trilinear) * self.quad_clocks[texel as usize][end];
        [
            alu,
            quarter,
            scalar / (self.scalars * f64::from(wave)),
            (unfiltered + filtered) / QUAD,
            memory_bytes / self.cache_bytes,
        ]
    }
}
