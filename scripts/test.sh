#!/bin/sh
# Installs what is missing, then checks formatting, lints and runs every test; docs/testing.md has the parts.
#
# After a failed part the next one still runs. The last line is PASSED, or FAILED and the parts that
# failed. With CI set, more parts run, which install more or fetch from npm and PyPI.
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh
exec </dev/null

started=$(date +%s)
work=$(mktemp -d)        # results, binaries and logs
part=scripts/test.sh     # at work
beside=                  # processes of tests that run beside others
results=$work/results    # a line each: ok, FAILED or skipped, the part, its seconds or the reason
binaries=$work/binaries  # a line each: name and path
: >"$results"

# Prints the last line, whatever ends the script.
finish() {
    status=$?
    trap - EXIT
    # shellcheck disable=SC2086
    [ -z "$beside" ] || kill $beside 2>/dev/null || true
    rest=
    if [ "$status" -ne 0 ]; then
        [ -z "$part" ] || note "FAILED $part$(ending "$status")"
        rest=", and nothing after it ran"
    fi
    failed=$(sed -n 's/^FAILED \(.*\)$/\1/p' "$results" | sed 's/ ([0-9]* s)$//' | paste -s -d ';' - | sed 's/;/; /g')
    echo
    cat "$results"
    rm -rf "$work"
    if [ -n "$failed$rest" ]; then
        say "FAILED: $failed$rest"
        exit 1
    fi
    say "PASSED in $(($(date +%s) - started)) s"
}
trap finish EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

note() {
    say "$*"
    printf '%s\n' "$*" >>"$results"
}

# Describes an exit status that is not a plain failure: cargo and test binaries fail with 101, scripts with 1.
ending() ( # status
    case $1 in 1 | 101) exit ;; esac
    if [ "$1" -gt 128 ] && signal=$(kill -l "$1" 2>/dev/null); then
        echo ": killed by SIG$signal"
    else
        echo ": exit status $1"
    fi
)

# Runs a part and notes how it ended.
attempt() { # name, command...
    part=$1
    shift
    say "$part"
    begun=$(date +%s)
    status=0
    "$@" || status=$?
    seconds=$(($(date +%s) - begun))
    case $status in
        0) note "ok $part ($seconds s)" ;;
        77) note "skipped $part (the reason is above)" ;;
        *) note "FAILED $part$(ending "$status") ($seconds s)" ;;
    esac
    part=scripts/test.sh
    [ "$status" -eq 0 ] || [ "$status" -eq 77 ]
}

# Runs a part that others do not depend on.
check() { # name, command...
    attempt "$@" || true
}

# Runs a part without which the rest cannot run.
need() { # name, command...
    attempt "$@" || { part= && exit 1; }
}

# Runs a part if its tool answers.
check_with() { # tool, how to install it, name, command...
    if $1 --version >/dev/null 2>&1; then
        shift 2
        check "$@"
    else
        note "skipped $3 ($1 is missing: $2)"
    fi
}

# Runs a part that only CI must run.
check_in_ci() { # script, arguments...
    if [ -n "${CI:-}" ]; then
        check "$1" sh "$@"
    else
        note "skipped $1 (only with CI set: sh $*)"
    fi
}

# Installs what tests need: a failure is a failed part with CI set, and otherwise the tests skip.
provide() { # what skips, names for `require`...
    skips=$1
    shift
    if [ -n "${CI:-}" ]; then
        check "installing $*" require "$@"
    else
        require "$@" || note "skipped $skips ($* could not be installed)"
    fi
}

setup() {
    require_rust
    require compiler loader driver validation
}

# With the window, whose tests run the same program.
build() {
    say "building (the first time takes a few minutes)"
    cargo build --release --locked --features view && cargo test --release --locked --features view --no-run &&
        cargo build --release --locked --no-default-features --examples
}

list_binaries() {
    test_binaries --lib --bins --tests --features view >"$binaries" && [ -s "$binaries" ]
}

# Starts a test binary beside the parts that follow; `check NAME await NAME` is its part.
begin() { # name, niceness
    nice -n "$2" "$(sed -n "s|^$1 ||p" "$binaries")" >"$work/$1.log" 2>&1 </dev/null &
    echo $! >"$work/$1.pid"
    beside="$beside $!"
}

await() { # name
    wait "$(cat "$work/$1.pid")" && ended=0 || ended=$?
    cat "$work/$1.log"
    return "$ended"
}

check scripts/test-scripts.sh sh scripts/test-scripts.sh
check scripts/check-commits.sh sh scripts/check-commits.sh
check scripts/check-words.sh sh scripts/check-words.sh
check scripts/check-numbers.sh sh scripts/check-numbers.sh
need setup setup
check_with "cargo fmt" "rustup component add rustfmt" "cargo fmt" cargo fmt --check
# cargo fmt does not see files that a macro declares.
check_with rustfmt "rustup component add rustfmt" "rustfmt of the questions" \
    rustfmt --check --edition 2024 src/study/questions/*.rs src/study/questions/*/mod.rs
need "the build" build
built=$(date +%s)
need "Vulkan devices" require_device cargo run --release --locked --quiet --features view --
need "the list of test binaries" list_binaries
said=$(target/release/splitsum cost --method split-sum 2>&1 >/dev/null) ||
    note "skipped compiling every pipeline for AMD GPUs ($said)"

# `numeric` takes the processor time that the others leave.
begin numeric 19
check_with "cargo clippy" "rustup component add clippy" "cargo clippy" \
    cargo clippy --release --locked --all-targets --features view -- -D warnings
# Offline: advisories are as old as the last `cargo deny fetch`.
check_with "cargo deny" "cargo install cargo-deny" "cargo deny" \
    cargo deny --offline --locked check licenses bans sources
if ls -d "${CARGO_HOME:-$HOME/.cargo}"/advisory-dbs/*/.git >/dev/null 2>&1; then
    check_with "cargo deny" "cargo install cargo-deny" "cargo deny advisories" \
        cargo deny --offline --locked check advisories
else
    note "skipped cargo deny advisories (the data base is missing: cargo deny fetch)"
fi
check_with "cargo machete" "cargo install cargo-machete" "cargo machete" cargo machete
check_with shellcheck "apt-get install shellcheck" shellcheck shellcheck -x scripts/*.sh .ci/run

[ -z "${CI:-}" ] || provide scripts/check-page.sh node npm
if has node && has npm; then
    check scripts/check-page.sh sh scripts/check-page.sh
else
    note "skipped scripts/check-page.sh (Node.js or npm is missing)"
fi
provide "the tests of the report in a browser" browser
provide "the tests of the window" Xvfb xdotool openbox keyboard
# Without a browser or a display tests skip; here they must not.
[ -z "${CI:-}" ] || export SPLITSUM_REQUIRE_BROWSER=1 SPLITSUM_REQUIRE_WINDOW=1

# Test binaries run without cargo, so that their signals show. The binaries `browser` and `device` keep one core busy each.
while read -r name path; do
    case $name in
        browser | numeric) ;;
        device)
            begin browser 0
            check device "$path" </dev/null
            check browser await browser
            ;;
        *) check "$name" "$path" </dev/null ;;
    esac
done <"$binaries"
check numeric await numeric
check "doc tests" cargo test --release --locked --features view --quiet --doc
check scripts/examples.sh sh scripts/examples.sh
[ -z "${CI:-}" ] || provide scripts/check-python.sh python3 venv
if has python3 && has venv; then
    check scripts/check-python.sh sh scripts/check-python.sh
else
    note "skipped scripts/check-python.sh (python3 or its venv is missing)"
fi

check_in_ci scripts/check-clients.sh
check_in_ci scripts/check-files.sh
check_in_ci scripts/check-package.sh
check_in_ci scripts/check-shaders.sh
check_in_ci scripts/cluster-test.sh local
# The parts that a driver can change; without arguments it runs all.
check_in_ci scripts/second-driver.sh golden furnace methods tables
# A GPU is rarely at hand: the script that measures on one must not rot meanwhile.
check_in_ci scripts/gpu.sh rehearse 1
say "after the build: $(($(date +%s) - built)) s"
