//! The report in a real browser, opened from disk: display, input and saved files. Skips with a line without Chromium.

mod chromium;
mod compare;
#[path = "../numeric/run/fake.rs"]
mod fake;
mod fixture;
mod gallery;
mod live;
mod live_pixels;
mod pages;
mod paste;
