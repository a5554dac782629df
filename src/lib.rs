//! splitsum measures how wrong the split-sum approximation of image-based lighting is.
//!
//! The modules follow the path of the data: environment, precompute, gbuffer, shade, tonemap, metrics, table.
#![deny(unsafe_code)]

pub mod glsl;

pub mod color;
pub mod math;
pub mod pixels;

pub mod brdf;
pub mod environment;
pub mod scene;

pub mod gpu;

pub mod gbuffer;
pub mod precompute;
pub mod shade;
pub mod tonemap;

pub mod metrics;
pub mod table;

pub mod pipeline;

pub mod experiment;

pub mod report;
