//! A window on the renderer.
//!
//! The renderer has its own thread and device; the window never waits for it. The window is painted on the CPU, so it
//! survives a lost device. [`crate::pipeline::Pipeline`] makes every picture.

mod controls;
mod file;
mod overlay;
mod panel;
mod picture;
mod state;
mod window;
mod worker;

pub use picture::Picture;
pub use state::State;
pub use window::{Opened, Windowed, open};
