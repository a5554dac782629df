//! A window on the renderer.
//!
//! The renderer has its own thread, and submits in short pieces: a window with a swapchain of the
//! same device waits for one at most. Without a swapchain the window is painted on the CPU.
//! [`crate::instrument::pipeline::Pipeline`] makes every picture.

mod browse;
mod canvas;
mod controls;
mod cpu_painter;
mod device_painter;
mod file;
mod keys;
mod overlay;
mod painter;
mod painting;
mod panel;
mod picture;
mod save;
mod screen;
mod shown;
mod state;
mod test_report;
mod texels;
mod theme;
mod values;
mod window;
mod worker;

pub use painter::Paint;
pub use picture::Picture;
pub use state::{HOME, State, has_materials};
pub use window::{WindowOptions, Windowed, open};
