//! The radiance of every coalition of the split sum's steps.
//!
//! docs/estimators.md ("The ladder") has the radiance of a coalition with the kernel K, `(f0 A + B)
//! <K F, L>` or `<K, L>`. K is `D G2 / (4 n·v)`, or with masking approximated `D n·h / (4 v·h)
//! w(l)`; with n = v = r it is `D/4` times G1(l) or w(l). Before n = v = r the reference's passes
//! draw the means. After it K is isotropic about r, so a mean is a convolution `m(r, alpha)`, exact
//! by spherical harmonics. Approximations then apply in this order:
//!
//! - samples: `m` is the prefilter's estimate, for any direction and width;
//! - storage: `m` is rounded to the number format;
//! - texels: `m` is linear between the texels of a level, both levels around alpha by their shares;
//!   else taken at r;
//! - levels: a level has its own width; else each has alpha.

pub use super::setting::{ByKernel, KernelRadiance, Setting};

use super::game::Coalition;
use super::setting::{Means, Split};
use super::tabulated::{LevelMeans, TABULATED, Tables};
use super::{FRESNEL, MASKING, TABLE, VIEW};
use glam::{DVec2, DVec3};
use std::collections::HashMap;

/// Radiance by coalition, for any f0.
pub struct Radiance {
    scale: f64,
    exact: Vec<DVec2>,
    table: Vec<DVec2>,
    /// With masking approximated.
    weighted: Vec<Split>,
    scrambles: Vec<ByKernel<KernelRadiance>>,
    /// Mean of the scrambles.
    drawn: ByKernel<KernelRadiance>,
    /// Both levels after n = v = r, by the approximated steps of [`TABULATED`].
    tabulated: HashMap<Coalition, [LevelMeans; 2]>,
}

/// Returns `<K F, L>`, or `<K, L>` with Fresnel approximated.
fn mean(means: Means, split: Split, f0: DVec3, is_fresnel_outside: bool) -> DVec3 {
    if is_fresnel_outside {
        means.whole
    } else {
        (f0 * split.x * means.below + split.y * means.grazing) / (f0 * split.x + split.y)
    }
}

impl Radiance {
    pub fn new(setting: Setting) -> Self {
        let n_dot_v: Vec<f64> = setting.frames.iter().map(|[n, v]| n.dot(*v)).collect();
        let tabulated = Tables::new(&setting).by_steps();
        Self {
            scale: setting.scale,
            exact: n_dot_v
                .iter()
                .map(|n_dot_v| setting.albedos.exact(*n_dot_v))
                .collect(),
            weighted: n_dot_v
                .iter()
                .map(|n_dot_v| setting.albedos.weighted(*n_dot_v))
                .collect(),
            table: setting.table,
            drawn: mean_of_scrambles(&setting.drawn),
            scrambles: setting.drawn,
            tabulated,
        }
    }

    /// Returns the radiance of a feasible coalition by pixel.
    pub fn for_coalition(&self, coalition: Coalition, f0: DVec3) -> Vec<DVec3> {
        self.with_drawn(&self.drawn, coalition, f0)
    }

    /// Returns the same as each scramble drew it; empty after n = v = r, where it is exact.
    pub fn scrambles(&self, coalition: Coalition, f0: DVec3) -> Vec<Vec<DVec3>> {
        if coalition.contains(VIEW) {
            return Vec::new();
        }
        self.scrambles
            .iter()
            .map(|drawn| self.with_drawn(drawn, coalition, f0))
            .collect()
    }

    /// Returns the radiance of a coalition by pixel, with these means before n = v = r.
    fn with_drawn(
        &self,
        drawn: &ByKernel<KernelRadiance>,
        coalition: Coalition,
        f0: DVec3,
    ) -> Vec<DVec3> {
        (0..self.exact.len())
            .map(|pixel| {
                if coalition.contains(VIEW) {
                    self.after_view(coalition, f0, pixel)
                } else {
                    self.before_view(drawn.select(coalition), coalition, f0, pixel)
                }
            })
            .collect()
    }

    /// `f0 A + B`.
    fn reflectance(&self, coalition: Coalition, f0: DVec3, pixel: usize) -> DVec3 {
        let albedo = if coalition.contains(TABLE) {
            self.table[pixel]
        } else {
            self.exact[pixel]
        };
        f0 * albedo.x + albedo.y
    }

    /// Returns the radiance of a pixel after n = v = r.
    fn after_view(&self, coalition: Coalition, f0: DVec3, pixel: usize) -> DVec3 {
        let levels = &self.tabulated[&coalition.intersection(TABULATED)];
        let level_mean = |level: &LevelMeans| {
            let means = *level.means[pixel].select(coalition);
            let split = *level.splits.select(coalition);
            level.share * mean(means, split, f0, coalition.contains(FRESNEL))
        };
        let sum: DVec3 = levels
            .iter()
            .filter(|level| level.share > 0.0)
            .map(level_mean)
            .sum();
        self.scale * self.reflectance(coalition, f0, pixel) * sum
    }

    /// Returns the radiance of a pixel before n = v = r.
    fn before_view(
        &self,
        drawn: &KernelRadiance,
        coalition: Coalition,
        f0: DVec3,
        pixel: usize,
    ) -> DVec3 {
        let exact = self.exact[pixel];
        let split = if coalition.contains(MASKING) {
            self.weighted[pixel]
        } else {
            exact
        };
        let whole = drawn.f0_1[pixel] / exact.element_sum();
        let grazing = drawn.f0_0[pixel] / exact.y;
        let means = Means {
            whole,
            below: (split.element_sum() * whole - split.y * grazing) / split.x,
            grazing,
        };
        self.reflectance(coalition, f0, pixel) * mean(means, split, f0, coalition.contains(FRESNEL))
    }
}

fn mean_of_scrambles(scrambles: &[ByKernel<KernelRadiance>]) -> ByKernel<KernelRadiance> {
    let mean_image = |image: &dyn Fn(&ByKernel<KernelRadiance>) -> &[DVec3]| -> Vec<DVec3> {
        (0..image(&scrambles[0]).len())
            .map(|pixel| {
                let sum: DVec3 = scrambles.iter().map(|drawn| image(drawn)[pixel]).sum();
                sum / scrambles.len() as f64
            })
            .collect()
    };
    ByKernel {
        exact: KernelRadiance {
            f0_0: mean_image(&|drawn| &drawn.exact.f0_0),
            f0_1: mean_image(&|drawn| &drawn.exact.f0_1),
        },
        weighted: KernelRadiance {
            f0_0: mean_image(&|drawn| &drawn.weighted.f0_0),
            f0_1: mean_image(&|drawn| &drawn.weighted.f0_1),
        },
    }
}
