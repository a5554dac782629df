//! The image of a sheen ([`crate::instrument::shade::sheen`]): methods that no user chooses.

use super::Method;
use crate::instrument::shade::sheen::SHEEN_LOOKUPS;
use crate::instrument::shade::twin::Twin;

const LOOKUP: Method = Method {
    lookups: 1,
    ..Method::plain(
        "sheen-lookup",
        "Sheen",
        "one lookup of a sheen lobe",
        Twin::Estimator(|surface, light, _| {
            let tap = SHEEN_LOOKUPS[0].tap([surface.n, surface.v], surface.alpha);
            light.mean_radiance(tap.direction, tap.alpha)
        }),
    )
};

impl Method {
    /// A lookup alone, without the albedo.
    pub const SHEEN_LOOKUP: &Self = &LOOKUP;
    /// The integral of the lobe, by the passes of the reference.
    pub const SHEEN: &Self = &Self {
        name: "sheen",
        lobe: Some("sheen"),
        lookups: 0,
        ..LOOKUP
    };
}
