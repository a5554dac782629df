#!/bin/sh
# Installs the Python package into a fresh environment below target/, then runs its tests and examples.
#
# The tests compare it with target/release/splitsum, or with the program that SPLITSUM names.
# `check-python.sh FOLDER` keeps the figures of the examples there. Without Python or a network the check is skipped: one
# line, exit status 77.
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh

skip() {
    say "skipped: the Python package: $*"
    exit 77
}

root=$PWD
venv=$root/target/python-venv
program=${SPLITSUM:-$root/target/release/splitsum}
figures=${1:-$root/target/python-figures}

has_command python3 || skip "python3 is missing"
has venv || skip "python3 has no ensurepip (Debian: apt-get install python3-venv)"
require_rust
[ -x "$program" ] || stop "$program is missing: cargo build --release"
rm -rf "$venv"
python3 -m venv "$venv"
"$venv/bin/pip" download -q --disable-pip-version-check --no-deps -d "$venv/download" maturin ||
    skip "pip cannot fetch a package (no network?)"
say "installing python/ into target/python-venv"
CARGO_TARGET_DIR=$root/target/python "$venv/bin/pip" install -q --disable-pip-version-check "$root/python[test]"
mkdir -p "$figures"
SPLITSUM=$program SPLITSUM_FIGURES=$figures "$venv/bin/python" -m pytest -q -p no:cacheprovider python/tests
if cargo fmt --version >/dev/null 2>&1; then
    cargo fmt --manifest-path python/Cargo.toml --check
fi
