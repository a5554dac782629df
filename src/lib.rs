//! splitsum measures how wrong the split-sum approximation of image-based lighting is.
//!
//! # Folders
//!
//! A folder imports only from folders above it in this list; `tests/numeric/layering.rs` reads the
//! list from this file.
//!
//! - [`base`] is what everything else is written in: colour, mathematics, pixels and their files,
//!   CSV, names that users type, and the constants and structs that Rust shares with GLSL.
//! - [`instrument`] makes one image correctly: environments, scenes, tables, shading by each method,
//!   the reference, scores, and the steps of a method's error. It knows the device.
//! - [`oracle`] answers tables of queries with exact integrals, on the CPU.
//! - [`draw`] turns numbers into figures, contact sheets, colours, Markdown and words.
//! - [`cost`] counts the code that a GPU's compiler makes of each method.
//! - [`bake`] reads, writes and judges the tables of engines, and judges their lookups.
//! - [`experiment`] defines an experiment: axes, values, the file, the plan of cells.
//! - [`run`] renders and scores the cells of a plan into a folder of records and tables.
//! - [`study`] answers questions from the tables of finished runs. It needs no device.
//! - [`report`] writes the answers: files, summary, page, gallery, `results/`. It needs no device.
//! - [`view`] is the window.
//!
//! `src/cli`, in the program alone, parses arguments and calls the others.
//!
//! # Features
//!
//! Without features the crate computes on the CPU, in f64:
//! [`environment`](instrument::environment) loads a map, [`precompute`](instrument::precompute)
//! prefilters it and makes tables, [`shade::reference`](instrument::shade::reference) integrates a
//! pixel, [`bake`] writes and judges the tables of engines, [`oracle`] answers tables of queries.
//!
//! - `gpu` (default) renders on a Vulkan device: scenes, passes, the pipeline. It builds glslang,
//!   which is C++, and implies `exr`.
//! - `cli` (default) has experiments, runs, reports and the program `splitsum`. It implies `gpu`.
//! - `exr` reads and writes OpenEXR; without it Radiance, KTX, KTX 2, DDS and PNG remain.
//! - `view` has the window of `splitsum view`. It implies `cli`.
#![doc = include_str!("../docs/bibliography.md")]
#![cfg_attr(not(test), deny(clippy::unwrap_used))]

pub mod base;
pub mod instrument;
pub mod oracle;

pub mod draw;

#[cfg(feature = "cli")]
pub mod cost;

pub mod bake;

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
