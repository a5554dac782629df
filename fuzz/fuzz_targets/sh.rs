#![no_main]
#[allow(dead_code)]
#[path = "../../tests/numeric/robustness/targets.rs"]
mod targets;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| targets::run("sh", bytes));
