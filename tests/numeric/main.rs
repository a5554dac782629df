//! numeric tests

#![expect(
    clippy::too_many_lines,
    reason = "a test states its cases and follows one scenario"
)]

mod anisotropy;
mod bakes;
mod brdf;
mod chi_square;
#[path = "../shared/compensation_twins.rs"]
mod compensation_twins;
mod cost;
mod design;
mod diffuse;
mod disk_cache;
mod documents;
mod environment;
mod environment_files;
#[path = "../shared/environment_sampling.rs"]
mod environment_sampling;
mod experiment;
mod frames;
mod furnace;
#[path = "../shared/gbuffer.rs"]
mod gbuffer_twin;
#[path = "../shared/gltf.rs"]
mod gltf_files;
mod harmonics;
mod ladder;
mod ladder_outside;
mod layering;
mod library;
mod map_layouts;
mod math;
mod metrics;
#[path = "../shared/mips.rs"]
mod mips_twin;
#[path = "../shared/occluded.rs"]
mod occluded;
mod oracle;
mod paste;
mod pixels;
mod placement;
mod precompute;
mod published;
mod recovery;
mod reference;
mod robustness;
mod run;
mod scene;
#[path = "../shared/scratch.rs"]
mod scratch;
mod sequence;
#[path = "../shared/sh9.rs"]
mod sh9;
mod sheen;
#[path = "../shared/snapshot.rs"]
mod snapshot;
mod source_documents;
mod study;
mod table;
mod taps;
mod tonemap;

/// CPU time of this thread, independent of other processes.
pub fn cpu_time() -> std::time::Duration {
    let line = std::fs::read_to_string("/proc/thread-self/schedstat").expect("Linux has it");
    std::time::Duration::from_nanos(
        line.split(' ')
            .next()
            .and_then(|n| n.parse().ok())
            .expect("nanoseconds"),
    )
}
