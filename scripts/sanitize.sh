#!/bin/sh
# The tests without a device under AddressSanitizer: scripts/sanitize.sh [FILTER...]
#
# Without arguments it runs the tests that read files from outside, where C libraries and unsafe code of dependencies
# work. Needs the nightly toolchain; without it the same tests run under valgrind. GPU drivers are excluded: they are not
# built with AddressSanitizer.
set -eu
cd "$(dirname "$0")/.."
[ $# -gt 0 ] || set -- robustness:: pixels:: scene::obj table:: metrics::

host=$(rustc -vV | sed -n 's/^host: //p')
# A folder of its own, and `--target`, so that build scripts and macros are built without it.
export CARGO_TARGET_DIR=target/sanitize
# Two C libraries below define a table of the same name; memory that lives until the end of the process is not a leak.
export ASAN_OPTIONS=detect_odr_violation=0:detect_leaks=0
# Fewer mutated files: each costs several times as much here.
export SPLITSUM_MUTATIONS="${SPLITSUM_MUTATIONS:-100}"
if cargo +nightly --version >/dev/null 2>&1; then
    RUSTFLAGS=-Zsanitizer=address exec nice cargo +nightly test --release --locked --target "$host" --test numeric -- "$@"
fi
command -v valgrind >/dev/null 2>&1 || {
    echo "neither the nightly toolchain nor valgrind is installed" >&2
    exit 1
}
unset CARGO_TARGET_DIR
export CARGO_TARGET_X86_64_UNKNOWN_LINUX_GNU_RUNNER="valgrind --error-exitcode=1 --quiet"
exec nice cargo test --release --locked --test numeric -- --test-threads=1 "$@"
