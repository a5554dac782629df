#!/bin/sh
# Runs the standard set of experiments and publishes their answers:
#
#     scripts/standard-set.sh [--only NAME,NAME...] [--runs FOLDER] [--publish FOLDER]
#
# Runs go to runs/standard/NAME (gitignored), the small files of each to results/NAME, and results/README.md is written from the answers of
# all published runs; a run of an earlier plan is replaced. A set that was stopped goes on where it stopped. Under 40 minutes on two quiet
# cores with a software driver.
# diffuse-measured needs maps of others in experiments/environments and is left out, with a word, where that folder is missing.
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh

set_names="quick break-even sample-count source-document-0 level-bias printed-slips energy diffuse diffuse-measured tables exposure-and-contrast dynamic-range better-method timing"
runs=runs/standard
results=results
while [ $# -gt 0 ]; do
    case "$1" in
    --only) set_names=$(echo "${2:?--only needs names}" | tr ',' ' ') ;;
    --runs) runs=${2:?--runs needs a folder} ;;
    --publish) results=${2:?--publish needs a folder} ;;
    *)
        echo "usage: scripts/standard-set.sh [--only NAME,NAME...] [--runs FOLDER] [--publish FOLDER]" >&2
        exit 2
        ;;
    esac
    shift 2
done
for name in $set_names; do
    [ -f "experiments/$name.toml" ] || {
        echo "experiments/$name.toml: no such file; expected a name of experiments/README.md" >&2
        exit 2
    }
done

require_rust
require has_compiler g++ has_loader libvulkan1 has_driver mesa-vulkan-drivers
say "building (the first time takes a few minutes)"
cargo build --release --locked
require_device

# A run with failed cells (exit 4) is published with what it has; any other fault ends the set.
status=0
folders=""
for name in $set_names; do
    if [ "$name" = diffuse-measured ] && [ ! -d experiments/environments ]; then
        say "$name: skipped, there is no folder experiments/environments; experiments/diffuse-measured.toml says what belongs there"
        continue
    fi
    say "$name"
    code=0
    target/release/splitsum run "experiments/$name.toml" --out "$runs/$name" >/dev/null || code=$?
    case $code in
    0) ;;
    4) status=4 ;;
    *) exit "$code" ;;
    esac
    folders="$folders $runs/$name"
done
say "publishing to $results"
# shellcheck disable=SC2086 # names of experiments hold no spaces
target/release/splitsum answers $folders --publish "$results" --replace
exit "$status"
