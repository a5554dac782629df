#!/bin/sh
# Installs what is missing, builds splitsum and runs experiments/quick.toml. Run it again at any time: it installs
# nothing twice, and the run resumes where it stopped.
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh

require_rust
require compiler loader driver

say "building (the first time takes a few minutes)"
cargo build --release --locked

say "Vulkan devices"
require_device cargo run --release --locked --quiet --

say "running experiments/quick.toml"
exec cargo run --release --locked --quiet -- run experiments/quick.toml
