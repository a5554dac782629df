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
//! | compute units, clocks, memory, its last cache | the makers' pages [AmdCards22; Valve22] |

use super::isa::Counts;

/// Pixels of the frame that a millisecond bound is for.
pub const FRAME: [u32; 2] = [1920, 1080];

/// Bytes that a dispatch of the specular pass streams a pixel: three texels of the g-buffer and the radiance, read and written, each a vec4 of
/// 32-bit floats.
pub const STREAMED_BYTES: f64 = 5.0 * 16.0;

/// Rates of one compute unit of a generation. Pairs are the optimistic and the pessimistic end.
#[derive(Clone, Copy, Debug)]
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

/// A family of GPUs with the same code, and the card that stands for it.
#[derive(Clone, Copy, Debug)]
pub struct Family {
    pub name: &'static str,
    /// What RADV calls it, in the order in which to ask: newer versions have other names.
    pub driver_names: &'static [&'static str],
    pub generation: Generation,
    pub card: Card,
}

/// A product.
#[derive(Clone, Copy, Debug)]
pub struct Card {
    pub name: &'static str,
    pub compute_units: u32,
    /// The boost clock, and the clock that the maker names for games (GCN: the base clock), MHz.
    pub clock_mhz: [f64; 2],
    /// Of the memory, GB/s.
    pub bandwidth: f64,
    /// Of the cache before the memory, MiB; 0 where it is an L2 of 4 MiB or less, a fortieth of what a pass streams.
    pub cache: f64,
}

const fn card(name: &'static str, compute_units: u32, clock_mhz: [f64; 2], bandwidth: f64, cache: f64) -> Card {
    Card { name, compute_units, clock_mhz, bandwidth, cache }
}

/// Every family of the model. A driver may lack some.
pub static FAMILIES: &[Family] = &[
    Family {
        name: "vega10",
        driver_names: &["vega10"],
        generation: GCN_5,
        card: card("Radeon RX Vega 64", 64, [1546.0, 1247.0], 483.8, 0.0),
    },
    Family {
        name: "navi10",
        driver_names: &["navi10"],
        generation: RDNA_1,
        card: card("Radeon RX 5700 XT", 40, [1905.0, 1755.0], 448.0, 0.0),
    },
    Family {
        name: "navi21",
        driver_names: &["navi21"],
        generation: RDNA_2,
        card: card("Radeon RX 6800 XT", 72, [2250.0, 2015.0], 512.0, 128.0),
    },
    Family {
        name: "vangogh",
        driver_names: &["vangogh"],
        generation: RDNA_2,
        card: card("Steam Deck", 8, [1600.0, 1000.0], 88.0, 0.0),
    },
    Family {
        name: "gfx1100",
        driver_names: &["gfx1100", "navi31"],
        generation: RDNA_3,
        card: card("Radeon RX 7900 XTX", 96, [2500.0, 2300.0], 960.0, 96.0),
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

    pub fn bytes(self) -> f64 {
        [8.0, 16.0][self as usize]
    }
}

/// Units of a compute unit, and its share of the memory, in the order of [`Family::clocks`].
pub const UNITS: [&str; 6] = ["alu", "quarter-rate", "scalar", "texture", "cache", "memory"];

impl Family {
    /// Clocks of a compute unit in which each of [`UNITS`] executes the counts of one pixel, at an end (0: optimistic).
    ///
    /// A trilinear lookup takes two bilinear ones. `wave` is the number of lanes that share a scalar instruction. At the optimistic end the
    /// last cache holds as much as it can of what a dispatch streams for [`FRAME`].
    pub fn clocks(&self, counts: &Counts, texel: Texel, wave: u32, end: usize) -> [f64; 6] {
        let Counts { alu, quarter, scalar, unfiltered, bilinear, trilinear, memory_bytes, dram_bytes } = *counts;
        let (rates, card) = (&self.generation, &self.card);
        let quarter = quarter / QUARTER_LANES;
        let alu = alu / rates.alu_lanes[end];
        let [alu, quarter] = if rates.shares_quarter { [alu + quarter, 0.0] } else { [alu, quarter] };
        let filtered = (bilinear + 2.0 * trilinear) * rates.quad_clocks[texel as usize][end];
        let streamed = f64::from(FRAME[0]) * f64::from(FRAME[1]) * STREAMED_BYTES;
        let kept = if end == 0 { (card.cache * f64::from(1 << 20) / streamed).min(1.0) } else { 0.0 };
        let bytes_a_clock = card.bandwidth * 1e3 / (card.clock_mhz[end] * f64::from(card.compute_units));
        [
            alu,
            quarter,
            scalar / (rates.scalars * f64::from(wave)),
            (unfiltered + filtered) / QUAD,
            memory_bytes / rates.cache_bytes,
            dram_bytes * (1.0 - kept) / bytes_a_clock,
        ]
    }

    /// The same at one clock, the one at which memory is slowest beside the compute units: two passes on one card share its clock.
    pub fn at_boost(self) -> Self {
        let card = Card { clock_mhz: [self.card.clock_mhz[0]; 2], ..self.card };
        Self { card, ..self }
    }
}
