//! A window on the renderer: what `splitsum render` writes, turned in the hand.
//!
//! The renderer has a thread of its own and the device; the window never waits for it. The window is painted on the CPU, so that a device that
//! is lost, or that can present nothing, leaves it alive. Every picture is one that [`crate::pipeline::Pipeline`] made for a request: no shader
//! here is the window's own.

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
