#!/bin/sh
# Installs what is missing, then checks formatting, lints and runs every test. One profile (release) serves all.
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh

require_rust
require has_compiler g++ has_loader libvulkan1 has_driver mesa-vulkan-drivers has_validation vulkan-validationlayers

if cargo fmt --version >/dev/null 2>&1; then
    say "cargo fmt --check"
    cargo fmt --check
else
    say "skipped: cargo fmt --check (rustfmt is not installed; rustup component add rustfmt)"
fi

say "building (the first time takes a few minutes)"
cargo build --release --locked

say "Vulkan devices"
require_device

if cargo clippy --version >/dev/null 2>&1; then
    say "cargo clippy"
    cargo clippy --release --locked --all-targets -- -D warnings
else
    say "skipped: cargo clippy (clippy is not installed; rustup component add clippy)"
fi

say "cargo test"
exec cargo test --release --locked --no-fail-fast
