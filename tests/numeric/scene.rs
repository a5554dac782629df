//! Cameras, scenes, OBJ and glTF files and the f64 g-buffer.

mod builtin;
mod cameras;
mod gbuffer;
pub mod gltf;
mod layers;
mod lights;
mod maps;
mod obj;
