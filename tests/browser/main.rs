//! The report in a real browser, opened from disk: display, input and saved files. Skips with a
//! line without Chromium.

#![expect(
    clippy::too_many_lines,
    reason = "a test states its cases and follows one scenario"
)]

mod chromium;
mod compare;
#[path = "../numeric/run/fake.rs"]
mod fake;
mod fixture;
mod gallery;
#[path = "../shared/gltf.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod gltf_files;
mod intermediates;
mod live;
mod live_pixels;
mod pages;
mod paste;
