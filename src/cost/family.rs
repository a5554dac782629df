//! Families of GPUs to compile for.

use crate::base::names::listed;

/// A family of GPUs with the same code.
#[derive(Debug)]
pub struct Family {
    pub name: &'static str,
    /// RADV's names, in the order to try: newer versions use other names.
    pub driver_names: &'static [&'static str],
    pub generation: &'static str,
    /// A product of the family.
    pub card: &'static str,
}

/// Every family, oldest first. A driver may lack some.
pub static FAMILIES: &[Family] = &[
    Family {
        name: "vega10",
        driver_names: &["vega10"],
        generation: "GCN 5",
        card: "Radeon RX Vega 64",
    },
    Family {
        name: "navi10",
        driver_names: &["navi10"],
        generation: "RDNA 1",
        card: "Radeon RX 5700 XT",
    },
    Family {
        name: "navi21",
        driver_names: &["navi21"],
        generation: "RDNA 2",
        card: "Radeon RX 6800 XT",
    },
    Family {
        name: "vangogh",
        driver_names: &["vangogh"],
        generation: "RDNA 2",
        card: "Steam Deck",
    },
    Family {
        name: "gfx1100",
        driver_names: &["gfx1100", "navi31"],
        generation: "RDNA 3",
        card: "Radeon RX 7900 XTX",
    },
];

listed!(
    Family,
    "family",
    FAMILIES,
    /// Finds a family by its name or a driver's name for it.
    fn by_name(name: &str) -> Option<&'static Self> {
        Self::all().find(|family| family.name == name || family.driver_names.contains(&name))
    }
);
