//! Cameras, scenes, OBJ and glTF files and the f64 g-buffer.

mod cameras;
mod gbuffer;
pub mod gltf;
mod layers;
mod maps;
mod obj;
