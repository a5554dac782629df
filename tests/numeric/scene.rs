//! Cameras, scenes, OBJ files and the f64 g-buffer.

mod cameras;
mod gbuffer;
mod obj;
