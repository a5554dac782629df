#!/bin/sh
# Packs the crate as a registry gets it, then builds the program from that archive alone and asks it for its methods.
#
# Crates that are built already are not built again, and this one is not optimised. Part of scripts/test.sh in continuous integration, in a bare root.
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh
require_rust
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
root=$PWD
target=$root/target
# `cargo package` would build all crates again, unoptimised.
cargo package --locked --allow-dirty --no-verify --target-dir "$work"
tar -xzf "$work"/package/splitsum-*.crate -C "$work"
cd "$work"/splitsum-*/
cargo build --release --locked --features view --target-dir "$target" \
    --config 'profile.release.package.splitsum.opt-level=0' \
    --config 'profile.release.package.splitsum.codegen-units=256'
"$target/release/splitsum" list methods
"$target/release/splitsum" plan experiments/quick.toml
# Puts the working tree's program back in its place; nothing is built.
cd "$root"
cargo build --release --locked --features view
