//! The rung of the ladder after `ladder_samples`: texels as they are kept. Only A and B are still exact.

use super::Method;
use super::ladder_texels::rung;

pub const METHOD: Method =
    rung("ladder-storage", "as ladder-samples, with texels in the numbers of storage_format; A and B are exact");
