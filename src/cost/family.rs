//! Families of GPUs that the driver may compile for.

use crate::spelling::listed;

/// A family of GPUs with the same code.
#[derive(Debug)]
pub struct Family {
    pub name: &'static str,
    /// What RADV calls it, in the order in which to ask: newer versions have other names.
    pub driver_names: &'static [&'static str],
    pub generation: &'static str,
    /// A product of the family.
    pub card: &'static str,
}

const fn family(
    name: &'static str,
    driver_names: &'static [&'static str],
    generation: &'static str,
    card: &'static str,
) -> Family {
    Family { name, driver_names, generation, card }
}

/// Every family, the oldest first. A driver may lack some.
pub static FAMILIES: &[Family] = &[
    family("vega10", &["vega10"], "GCN 5", "Radeon RX Vega 64"),
    family("navi10", &["navi10"], "RDNA 1", "Radeon RX 5700 XT"),
    family("navi21", &["navi21"], "RDNA 2", "Radeon RX 6800 XT"),
    family("vangogh", &["vangogh"], "RDNA 2", "Steam Deck"),
    family("gfx1100", &["gfx1100", "navi31"], "RDNA 3", "Radeon RX 7900 XTX"),
];

listed!(
    Family,
    "family",
    FAMILIES,
    /// Finds the family of that name, or of that name of the driver's.
    fn by_name(name: &str) -> Option<&'static Self> {
        Self::all().find(|family| family.name == name || family.driver_names.contains(&name))
    }
);
