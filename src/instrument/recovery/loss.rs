//! The losses by which inverse renderers compare an image with a photo.

use crate::base::color::srgb_curve;
use crate::base::names::listed;
use crate::instrument::metrics::Epsilon;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Loss {
    /// Mean of |S(e m) - S(e p)|, S(x) = sRGB(log(1 + x)): the default of nvdiffrec.
    Nvdiffrec,
    /// Mean of (R(e m) - R(e p))², R(x) = x/(1 + x).
    Reinhard,
    /// Mean of (m - p)²/(p² + ε), the `relmse` of this program.
    Relative,
    /// Mean of (m - p)².
    Mse,
}

listed!(Loss, "loss", {
    "nvdiffrec": Nvdiffrec,
    "reinhard": Reinhard,
    "relative": Relative,
    "mse": Mse,
});

/// How a loss compares a value m of an image with the value p of a photo.
#[derive(Clone, Copy, Debug)]
pub(super) enum Comparison {
    /// Weight of (m - p)², so that the loss is a parabola in F0.
    Weighted(fn(f64, Epsilon) -> f64),
    /// Of values after a curve, with an exposure.
    Curved {
        curve: fn(f64) -> f64,
        distance: fn(f64) -> f64,
    },
}

impl Loss {
    pub(super) fn comparison(self) -> Comparison {
        match self {
            Self::Nvdiffrec => Comparison::Curved {
                curve: |x| srgb_curve(x.ln_1p()),
                distance: f64::abs,
            },
            Self::Reinhard => Comparison::Curved {
                curve: |x| x / (1.0 + x),
                distance: |x| x * x,
            },
            Self::Relative => Comparison::Weighted(|photo, epsilon| epsilon.relative(1.0, photo)),
            Self::Mse => Comparison::Weighted(|_, _| 1.0),
        }
    }
}
