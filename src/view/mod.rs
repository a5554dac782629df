//! A window on the renderer.
//!
//! The renderer has its own thread and device; the window never waits for it. The window is painted
//! on the CPU, so it survives a lost device. [`crate::instrument::pipeline::Pipeline`] makes every
//! picture.

mod browse;
mod controls;
mod file;
mod keys;
mod overlay;
mod panel;
mod picture;
mod save;
mod screen;
mod shown;
mod state;
mod test_report;
mod theme;
mod values;
mod window;
mod worker;

pub use picture::Picture;
pub use state::{HOME, State, has_materials};
pub use window::{Windowed, open};
