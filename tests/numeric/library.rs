//! The cost of the crate without its features: few crates, no C++, no Vulkan.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

/// Crates of a build without features, this crate included: four more since bakes hold BC6H
/// (bcdec_rs), zlib (zlib-rs of flate2) and VTK's XML (base64), and records hold relative paths
/// (pathdiff).
const CRATES_MAX: usize = 64;

fn crates(arguments: &[&str]) -> BTreeSet<String> {
    let tree = [
        "tree",
        "--offline",
        "--locked",
        "--edges",
        "normal,build",
        "--prefix",
        "none",
        "--no-dedupe",
    ];
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let output = Command::new(env!("CARGO"))
        .args(tree)
        .args(arguments)
        .current_dir(root)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout)
        .unwrap()
        .lines()
        .map(str::to_owned)
        .collect()
}

#[test]
fn the_cpu_part_needs_few_crates_and_no_device() {
    let has = |crates: &BTreeSet<String>, name: &str| {
        crates
            .iter()
            .any(|line| line.starts_with(&format!("{name} v")))
    };
    let found = crates(&["--no-default-features"]);
    assert!(
        found.len() <= CRATES_MAX,
        "{} crates: {found:#?}",
        found.len()
    );
    let device = ["ash", "glslang-sys", "gltf", "clap"];
    assert!(device.iter().all(|name| !has(&found, name)), "{found:#?}");
    let whole = crates(&[]);
    assert!(device.iter().all(|name| has(&whole, name)), "{whole:#?}");
}
