//! splitsum measures how wrong the split-sum approximation of image-based lighting is.
//!
//! The modules follow the path of the data: environment, precompute, gbuffer, shade, tonemap,
//! metrics, table.
//!
//! # Features
//!
//! Without features the crate computes on the CPU, in f64: [`environment`] loads a map,
//! [`precompute`] prefilters it and makes tables, [`shade::reference`] integrates a pixel,
//! [`bakes`] writes and judges the tables of engines, [`oracle`] answers tables of queries.
//!
//! - `gpu` (default) renders on a Vulkan device: scenes, passes, the pipeline. It builds glslang,
//!   which is C++, and implies `exr`.
//! - `cli` (default) has experiments, runs, reports and the program `splitsum`. It implies `gpu`.
//! - `exr` reads and writes OpenEXR; without it Radiance, KTX, KTX 2, DDS and PNG remain.
//! - `view` has the window of `splitsum view`. It implies `cli`.
#![doc = include_str!("../docs/bibliography.md")]

pub mod glsl;

pub mod color;
pub mod files;
pub mod math;
pub mod pixels;
pub mod spelling;

pub mod brdf;
pub mod environment;
#[cfg(feature = "gpu")]
pub mod scene;

#[cfg(feature = "gpu")]
pub mod gpu;

#[cfg(feature = "gpu")]
pub mod gbuffer;
pub mod precompute;
pub mod shade;
pub mod tonemap;

#[cfg(feature = "cli")]
pub mod figure;
pub mod metrics;
pub mod table;

pub mod ladder;

pub mod bakes;
#[cfg(feature = "cli")]
pub mod cost;

pub mod oracle;
#[cfg(feature = "gpu")]
pub mod pipeline;

#[cfg(feature = "cli")]
pub mod experiment;
#[cfg(feature = "cli")]
pub mod run;

#[cfg(feature = "cli")]
pub mod study;

#[cfg(feature = "cli")]
pub mod report;
#[cfg(feature = "view")]
pub mod view;
