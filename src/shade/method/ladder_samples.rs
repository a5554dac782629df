//! The rung of the ladder after `ladder_texels`: texels as they are made.

use super::Method;
use super::ladder_texels::rung;
use crate::precompute::StorageFormat;

pub const METHOD: Method = Method {
    storage: Some(StorageFormat::F32),
    ..rung("ladder-samples", "as ladder-texels, with texels as the setting prefilter makes them")
};
