//! What the radiance of coalitions is computed from: the setting, and values by kernel and by part
//! of Fresnel's factor.

use super::MASKING;
use super::game::Coalition;
use crate::base::math::harmonics::Harmonics;
use crate::instrument::brdf::{Brdf, MaskingShadowing};
use crate::instrument::environment::Environment;
use crate::instrument::environment::layout::FilteredMap;
use crate::instrument::precompute::PrecomputeSettings;
use crate::instrument::precompute::dfg::Albedos;
use glam::{DVec2, DVec3};

/// One model and width under one light.
pub struct Setting<'a> {
    pub model: &'static dyn Brdf,
    pub masking: MaskingShadowing,
    pub alpha: f64,
    pub albedos: &'a Albedos,
    pub tables: &'a PrecomputeSettings,
    pub environment: &'a Environment,
    /// Multiplies the environment's radiance.
    pub scale: f64,
    /// Degrees of the environment, up to the degree of the narrowest lobe.
    pub harmonics: &'a Harmonics,
    pub filtered: &'a FilteredMap,
    /// (A, B) from the DFG table, by pixel.
    pub table: Vec<DVec2>,
    /// Normal and view of each pixel in the environment's frame.
    pub frames: &'a [[DVec3; 2]],
    /// Radiance before n = v = r, by scramble.
    pub drawn: Vec<ByKernel<KernelRadiance>>,
}

/// A value for each of the two kernels.
#[derive(Clone, Copy, Debug, Default)]
pub struct ByKernel<T> {
    /// With exact masking-shadowing.
    pub exact: T,
    /// With the weight of prefiltered maps in place of masking-shadowing.
    pub weighted: T,
}

impl<T> ByKernel<T> {
    /// Returns the value for the kernel of a coalition.
    pub(super) fn select(&self, coalition: Coalition) -> &T {
        if coalition.contains(MASKING) {
            &self.weighted
        } else {
            &self.exact
        }
    }

    pub(super) fn map<U>(&self, mut convert: impl FnMut(&T) -> U) -> ByKernel<U> {
        ByKernel {
            exact: convert(&self.exact),
            weighted: convert(&self.weighted),
        }
    }

    pub(super) fn each(&self) -> [&T; 2] {
        [&self.exact, &self.weighted]
    }

    pub(super) fn each_mut(&mut self) -> [&mut T; 2] {
        [&mut self.exact, &mut self.weighted]
    }
}

/// Radiance with one kernel by pixel, before n = v = r.
#[derive(Clone, Debug)]
pub struct KernelRadiance {
    /// For f0 = 0: `B <K Fc, L>`.
    pub f0_0: Vec<DVec3>,
    /// For f0 = 1: `(A + B) <K, L>`.
    pub f0_1: Vec<DVec3>,
}

/// A value for each part of Fresnel's `F = f0 (1 - Fc) + Fc`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Parts<T> {
    /// For the factor 1.
    pub(super) whole: T,
    /// For `1 - Fc`.
    pub(super) below: T,
    /// For `Fc`.
    pub(super) grazing: T,
}

impl<T> Parts<T> {
    pub(super) fn map<U>(&self, mut convert: impl FnMut(&T) -> U) -> Parts<U> {
        Parts {
            whole: convert(&self.whole),
            below: convert(&self.below),
            grazing: convert(&self.grazing),
        }
    }

    pub(super) fn each(&self) -> [&T; 3] {
        [&self.whole, &self.below, &self.grazing]
    }

    pub(super) fn each_mut(&mut self) -> [&mut T; 3] {
        [&mut self.whole, &mut self.below, &mut self.grazing]
    }
}

/// `<K, L>`, `<K (1 - Fc), L>` and `<K Fc, L>`.
pub(super) type Means = Parts<DVec3>;
/// `∫ K (1 - Fc)` and `∫ K Fc`, up to a common factor.
pub(super) type Split = DVec2;
/// The means that a direction of a map has.
pub(super) type StoredMeans = ByKernel<Means>;
