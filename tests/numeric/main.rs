//! numeric tests
mod bakes;
mod brdf;
#[path = "../shared/chi_square.rs"]
mod chi_square;
mod color;
mod cost;
mod design;
mod diffuse;
mod disk_cache;
mod environment;
#[path = "../shared/gltf.rs"]
mod gltf_files;
mod harmonics;
mod ladder;
mod ladder_diffuse;
mod ladder_outside;
mod layering;
mod lobe_shape;
mod map_layouts;
mod math;
mod metrics;
mod oracle;
mod pixels;
mod placement;
mod precompute;
mod reference;
mod robustness;
mod runner;
mod scene;
mod sequence;
mod slips;
mod study;
mod table;
mod tonemap;
