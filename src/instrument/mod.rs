//! Makes one image correctly, and measures it. Each stage of the path of the data, environment →
//! precompute → gbuffer → shade → tonemap → metrics, exists twice: as a device pass (`pass.rs`) and
//! as its f64 twin (`reference.rs`). Each module imports only from those above it.

/// The Vulkan device: memory, pipelines, recording, errors. The only unsafe code.
#[cfg(feature = "gpu")]
pub mod gpu;

/// Lobes: D, G1, samplers, widths along the tangent, compensation, sheen.
pub mod brdf;

/// Light: maps from files and formulas, and their layouts in texels.
pub mod environment;

/// Triangles, spheres, materials and cameras, from glTF, OBJ and built-in scenes.
#[cfg(feature = "gpu")]
pub mod scene;

/// Tables made once per environment or BRDF model, or given by other programs.
pub mod precompute;

/// Position, normal, alpha, albedo, metallic and F0 of each pixel: what every method reads.
#[cfg(feature = "gpu")]
pub mod gbuffer;

/// Exposure, contrast and the display's curve.
pub mod tonemap;

/// Scores of an image against the reference. They see images and a mask, never a method.
pub mod metrics;

/// Roughness and F0 of a surface from photos of it, by the images of a method.
pub mod recovery;

/// Radiance by each specular and diffuse method, and by the reference.
pub mod shade;

/// The steps from the exact integral to a method's image, and each one's part of the error.
pub mod ladder;

/// Runs the stages in order, and keeps what several images share.
#[cfg(feature = "gpu")]
pub mod pipeline;
