//! Device tests: every shader against its f64 twin, against published numbers and against
//! identities.
//!
//! Without a Vulkan device each test prints one line and passes; `GOLDEN=require` makes that a
//! failure. Everything runs under the validation layer (core and synchronisation) and any message
//! fails the test; `SPLITSUM_VALIDATION=0` turns the layer off.

#![expect(
    clippy::too_many_lines,
    reason = "a test states its cases and follows one scenario"
)]

mod antialias;
mod brdf;
mod compare;
#[path = "../shared/compensation_twins.rs"]
mod compensation_twins;
mod determinism;
#[path = "../shared/environment_sampling.rs"]
mod environment_sampling;
mod frames;
mod fresnel;
mod furnace;
mod gbuffer;
#[path = "../shared/gbuffer.rs"]
mod gbuffer_twin;
#[path = "../shared/gltf.rs"]
mod gltf_files;
mod golden;
mod grazing;
mod harness;
mod intermediate;
mod kept;
mod ladder;
mod layers;
mod layouts;
mod lights;
mod metallic;
mod methods;
#[path = "../shared/mips.rs"]
mod mips_twin;
mod occlusion;
mod own_method;
mod pictures;
mod placement;
mod prefilter;
mod probe;
mod reference;
mod scale;
#[path = "../shared/sh9.rs"]
mod sh9;
mod shader_check;
mod symmetry;
mod table_twins;
mod tables;
mod tonemap;
mod twins;
