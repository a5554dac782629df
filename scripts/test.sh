#!/bin/sh
# Installs what is missing, then checks formatting, lints and runs every test. One profile (release) serves all.
#
# A part that fails does not keep the next one from running. The last line says PASSED, or FAILED and which parts failed; docs/testing.md
# has the parts and their times.
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh

started=$(date +%s)
part=setup # what is at work
failed=    # parts that failed, for the last line
parts=     # every part with its seconds, a line each
skipped=   # what was left out, a line each
beside=    # processes of tests that run beside others

# Whatever ends the script, the last line says how it went.
finish() {
    status=$?
    trap - EXIT
    # shellcheck disable=SC2086
    [ -z "$beside" ] || kill $beside 2>/dev/null || true
    [ "$status" -eq 0 ] || fail "$part: $(ending "$status"), and nothing after it ran"
    printf '\n%s%s' "$parts" "$skipped"
    if [ -n "$failed" ]; then
        say "FAILED: $failed"
        exit 1
    fi
    say "PASSED in $(($(date +%s) - started)) s"
}
trap finish EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

fail() {
    failed="$failed${failed:+; }$*"
}

skip() {
    say "skipped: $*"
    skipped="${skipped}splitsum: skipped: $*
"
}

# How a command ended. A shell shows a signal as 128 and its number.
ending() { # status
    if [ "$1" -gt 128 ] && signal=$(kill -l "$1" 2>/dev/null); then
        echo "killed by SIG$signal"
    else
        echo "exit status $1"
    fi
}

# Runs a part: its name stands in the last line if it fails. 101 is how a test binary or cargo says that it has failed, 1 a script.
check() { # name, command...
    part=$1
    shift
    say "$part"
    begun=$(date +%s)
    status=0
    "$@" </dev/null || status=$?
    seconds=$(($(date +%s) - begun))
    result=ok
    case $status in
        0) ;;
        1 | 101) result=FAILED && fail "$part" ;;
        *) result="FAILED, $(ending "$status")" && fail "$part: $(ending "$status")" ;;
    esac
    say "$part: $result, $seconds s"
    parts="${parts}splitsum: $part: $result, $seconds s
"
}

require_rust
require has_compiler g++ has_loader libvulkan1 has_driver mesa-vulkan-drivers has_validation vulkan-validationlayers

if cargo fmt --version >/dev/null 2>&1; then
    check "cargo fmt" cargo fmt --check
    # Files that a macro declares are not seen by it.
    check "rustfmt of the questions" rustfmt --check --edition 2024 src/study/questions/*.rs
else
    skip "cargo fmt (rustfmt is not installed; rustup component add rustfmt)"
fi

part="the build"
say "building (the first time takes a few minutes)"
# With the window, whose tests run the same program.
cargo build --release --locked --features view
cargo test --release --locked --features view --no-run
built=$(date +%s)

features="--features view"
part="Vulkan devices"
say "$part"
require_device

if ! said=$(target/release/splitsum cost --method split-sum --samples 1 2>&1 >/dev/null); then
    skip "compiling every pipeline for AMD GPUs ($said)"
fi

# Each test binary is a part of its own, run without cargo, so that its end is known.
part="the list of test binaries"
mkdir -p target
test_binaries --lib --bins --tests --features view >target/test-binaries
[ -s target/test-binaries ]
# Starts tests beside those that follow, which show what they printed once they are awaited.
begin() { # name, command...
    log=target/$1.log
    shift
    "$@" >"$log" 2>&1 </dev/null 3<&- &
    beside="$beside $!"
}
ended() { # name, process
    status=0
    wait "$2" || status=$?
    cat "target/$1.log"
    return "$status"
}
binary_of() { # name
    sed -n "s/^$1 //p" target/test-binaries
}
# Tests of numbers take what cores all others leave.
begin numeric nice -n 19 "$(binary_of numeric)"
numeric=$!

if cargo clippy --version >/dev/null 2>&1; then
    check "cargo clippy" cargo clippy --release --locked --all-targets --features view -- -D warnings
else
    skip "cargo clippy (clippy is not installed; rustup component add clippy)"
fi

# Both read what is there and fetch nothing; the data base of advisories is as old as its last `cargo deny fetch`.
if cargo deny --version >/dev/null 2>&1; then
    check "cargo deny" cargo deny --offline --locked check licenses bans sources
    if ls -d "${CARGO_HOME:-$HOME/.cargo}"/advisory-dbs/*/.git >/dev/null 2>&1; then
        check "cargo deny advisories" cargo deny --offline --locked check advisories
    else
        skip "cargo deny advisories (no data base; cargo deny fetch)"
    fi
else
    skip "cargo deny (not installed; cargo install cargo-deny)"
fi
if cargo machete --version >/dev/null 2>&1; then
    check "cargo machete" cargo machete
else
    skip "cargo machete (not installed; cargo install cargo-machete)"
fi
if has_command shellcheck; then
    check shellcheck shellcheck -x scripts/*.sh .ci/run
else
    skip "shellcheck (not installed; Debian: apt-get install shellcheck)"
fi

# The page's scripts are checked where Node.js is; it comes only where it must.
part="Node.js"
[ -z "${CI:-}${SPLITSUM_CLIENTS_TEST:-}" ] || require has_node nodejs has_npm npm
if has_node && has_npm; then
    check "scripts/check-page.sh" sh scripts/check-page.sh
else
    skip "scripts/check-page.sh (Node.js or npm is not installed)"
fi

# The report is tested in a browser; without one those tests say so and skip, but not where they must run.
part=Chromium
if [ -n "${CI:-}${SPLITSUM_REQUIRE_BROWSER:-}" ]; then
    require has_browser chromium
    export SPLITSUM_REQUIRE_BROWSER=1
elif ! has_browser; then
    (require has_browser chromium) || skip "the browser tests (Chromium is not installed)"
fi

# The window is driven on a virtual display; without one those tests say so and skip, but not where they must run.
part="a virtual display"
if [ -n "${CI:-}" ]; then
    require has_xvfb xvfb has_xdotool xdotool has_openbox openbox
    export SPLITSUM_REQUIRE_WINDOW=1
else
    (require has_xvfb xvfb has_xdotool xdotool has_openbox openbox) || skip "the window tests (Xvfb, xdotool or openbox is not installed)"
fi

# Tests of the browser and of the device keep a core busy each.
while read -r name binary <&3; do
    case $name in
        browser | numeric) continue ;;
        device)
            begin browser "$(binary_of browser)"
            browser=$!
            check "$name" "$binary" 3<&-
            check "browser, the rest of it" ended browser "$browser"
            ;;
        *) check "$name" "$binary" 3<&- ;;
    esac
done 3<target/test-binaries
check "doc tests" cargo test --release --locked --features view --quiet --doc
check "numeric, the rest of it" ended numeric "$numeric"

# Clients come from npm's registry, so they run only where they must.
if [ -n "${CI:-}${SPLITSUM_CLIENTS_TEST:-}" ]; then
    check "scripts/check-clients.sh" sh scripts/check-clients.sh
else
    skip "scripts/check-clients.sh (it fetches three.js and ktx-parse; SPLITSUM_CLIENTS_TEST=1 asks for it)"
fi

# Snakemake is large, so it comes only where it must, or is there already.
if [ -n "${CI:-}${SPLITSUM_CLUSTER_TEST:-}" ] || [ -d target/cluster-venv ]; then
    check "scripts/cluster-test.sh" sh scripts/cluster-test.sh local
else
    skip "scripts/cluster-test.sh local (it installs Snakemake; SPLITSUM_CLUSTER_TEST=1 asks for it)"
fi

# The parts that a driver can move; without arguments it runs all. It says so where there is no second driver.
if [ -n "${CI:-}${SPLITSUM_SECOND_DRIVER_TEST:-}" ]; then
    check "scripts/second-driver.sh" sh scripts/second-driver.sh golden furnace methods tables
else
    skip "the device tests on a second driver (they take another minute; sh scripts/second-driver.sh)"
fi
part="the end"
say "after the build: $(($(date +%s) - built)) s"
