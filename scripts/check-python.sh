#!/bin/sh
# Installs the Python package into a fresh environment below target/, then runs its tests and examples.
#
# The tests compare it with target/release/splitsum, or with the program that SPLITSUM names.
# `check-python.sh FOLDER` keeps the figures of the examples there. Without Python or a network the check is skipped: one
# line, exit status 77. Without PyTorch, which is Debian's package python3-torch here, only its tests are skipped.
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
# An environment for the tests also needs ensurepip.
has_torch() { # python
    "$1" -c 'import ensurepip, torch' 2>/dev/null
}

# Debian's PyTorch belongs to Debian's Python; it was built with NumPy 1.
python=python3
packages=--system-site-packages
limits=
if ! has_torch python3; then
    has_torch /usr/bin/python3 || (install_packages python3-torch python3-venv) || true
    if has_torch /usr/bin/python3; then
        python=/usr/bin/python3
        limits="numpy<2"
    else
        packages=
        say "skipped: the tests of splitsum.torch (PyTorch cannot be installed)"
    fi
fi
rm -rf "$venv"
"$python" -m venv ${packages:+"$packages"} "$venv"
"$venv/bin/pip" download -q --disable-pip-version-check --no-deps -d "$venv/download" maturin ||
    skip "pip cannot fetch a package (no network?)"
say "installing python/ into target/python-venv"
CARGO_TARGET_DIR=$root/target/python "$venv/bin/pip" install -q --disable-pip-version-check "$root/python[test]" ${limits:+"$limits"}
mkdir -p "$figures"
SPLITSUM=$program SPLITSUM_FIGURES=$figures "$venv/bin/python" -m pytest -q -p no:cacheprovider python/tests
if cargo fmt --version >/dev/null 2>&1; then
    cargo fmt --manifest-path python/Cargo.toml --check
fi
