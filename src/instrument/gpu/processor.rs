//! The processor that a software driver compiles for.
//!
//! LLVM chooses instructions by the processor's model and features: with or without fused
//! multiply-add, and in which order. So two processors may give different last bits under one
//! device name, which states the vector width only.

use std::sync::OnceLock;

/// Fields of `/proc/cpuinfo` that select code, of the first processor.
const FIELDS: [&str; 6] = [
    "vendor_id",
    "cpu family",
    "model",
    "model name",
    "stepping",
    "flags",
];
/// The features on AArch64, in place of `flags`.
const FEATURES_ARM: [&str; 3] = ["CPU implementer", "CPU part", "Features"];
/// Digits of the hash.
const DIGITS: usize = 8;

/// Describes this machine's processor: its name, and a hash of all that selects code. The
/// architecture alone where the system does not say more.
pub fn target() -> &'static str {
    static TARGET: OnceLock<String> = OnceLock::new();
    TARGET.get_or_init(|| {
        let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        described(&text)
    })
}

/// Describes the first processor of a `/proc/cpuinfo`.
pub fn described(cpuinfo: &str) -> String {
    let first = cpuinfo.split("\n\n").next().unwrap_or_default();
    let value = |name: &str| {
        first
            .lines()
            .filter_map(|line| line.split_once(':'))
            .find(|(key, _)| key.trim() == name)
            .map(|(_, value)| value.trim())
    };
    let mut hasher = blake3::Hasher::new();
    for name in FIELDS.into_iter().chain(FEATURES_ARM) {
        hasher.update(name.as_bytes());
        // Systems list features in any order.
        let mut words: Vec<&str> = value(name).unwrap_or_default().split(' ').collect();
        words.sort_unstable();
        hasher.update(words.join(" ").as_bytes());
    }
    let hash = hasher.finalize().to_hex();
    let name = value("model name")
        .or_else(|| value("CPU part"))
        .unwrap_or(std::env::consts::ARCH);
    format!("{name}, features {}", &hash[..DIGITS])
}
