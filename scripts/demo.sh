#!/bin/sh
# Installs what is missing, builds splitsum and runs experiments/quick.toml. Run it again at any time: it installs nothing twice,
# and the run resumes where it stopped.
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh

require_rust
require has_compiler g++ has_loader libvulkan1 has_driver mesa-vulkan-drivers

say "building (the first time takes a few minutes)"
cargo build --release --locked

say "Vulkan devices"
require_device

say "running experiments/quick.toml"
exec cargo run --release --locked --quiet -- run experiments/quick.toml
