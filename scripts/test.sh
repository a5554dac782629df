#!/bin/sh
# Installs what is missing, then checks formatting, lints and runs every test. One profile (release) serves all.
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh

require_rust
require has_compiler g++ has_loader libvulkan1 has_driver mesa-vulkan-drivers has_validation vulkan-validationlayers

# A check that fails does not keep the next one from running; the last lines are those of the test runner.
status=0
check() {
    say "cargo $*"
    cargo "$@" || {
        status=1
        say "FAILED: cargo $*"
    }
}

if cargo fmt --version >/dev/null 2>&1; then
    check fmt --check
else
    say "skipped: cargo fmt --check (rustfmt is not installed; rustup component add rustfmt)"
fi

say "building (the first time takes a few minutes)"
cargo build --release --locked

say "Vulkan devices"
require_device

if cargo clippy --version >/dev/null 2>&1; then
    check clippy --release --locked --all-targets -- -D warnings
else
    say "skipped: cargo clippy (clippy is not installed; rustup component add clippy)"
fi

# Both read what is there and fetch nothing; the data base of advisories is as old as its last `cargo deny fetch`.
if cargo deny --version >/dev/null 2>&1; then
    check deny --offline --locked check licenses bans sources
    if ls -d "${CARGO_HOME:-$HOME/.cargo}"/advisory-dbs/*/.git >/dev/null 2>&1; then
        check deny --offline --locked check advisories
    else
        say "skipped: cargo deny check advisories (no data base; cargo deny fetch)"
    fi
else
    say "skipped: cargo deny (not installed; cargo install cargo-deny)"
fi
if cargo machete --version >/dev/null 2>&1; then
    check machete
else
    say "skipped: cargo machete (not installed; cargo install cargo-machete)"
fi

# The page's scripts are checked where Node.js is; it comes only where it must.
[ -z "${CI:-}" ] || require has_node nodejs has_npm npm
if has_node && has_npm; then
    say "scripts/check-page.sh"
    sh scripts/check-page.sh || {
        status=1
        say "FAILED: scripts/check-page.sh"
    }
else
    say "skipped: scripts/check-page.sh (Node.js or npm is not installed)"
fi

[ "$status" -eq 0 ] || say "a check above FAILED; the tests run all the same"
# The report is tested in a browser; without one those tests say so and skip, but not where they must run.
if [ -n "${CI:-}${SPLITSUM_REQUIRE_BROWSER:-}" ]; then
    require has_browser chromium
    export SPLITSUM_REQUIRE_BROWSER=1
elif ! has_browser; then
    (require has_browser chromium) || say "skipped: the browser tests (chromium is not installed)"
fi

# Snakemake is large, so it comes only where it must, or is there already.
if [ -n "${CI:-}${SPLITSUM_CLUSTER_TEST:-}" ] || [ -d target/cluster-venv ]; then
    sh scripts/cluster-test.sh local || status=1
else
    say "skipped: scripts/cluster-test.sh local (it installs Snakemake; SPLITSUM_CLUSTER_TEST=1 asks for it)"
fi

say "cargo test"
cargo test --release --locked --no-fail-fast || status=1

# The parts that a driver can move; without arguments it runs all. It says so where there is no second driver.
sh scripts/second-driver.sh golden furnace methods tables || status=1
exit "$status"
