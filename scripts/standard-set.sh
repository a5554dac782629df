#!/bin/sh
# Runs the standard set of experiments and publishes their answers:
#
#     scripts/standard-set.sh [--only NAME,NAME...] [--runs FOLDER] [--publish FOLDER]
#
# Runs go to runs/standard/NAME (gitignored), the small files of each to results/NAME, and the answers of all published
# runs to results/README.md; a run of an earlier plan is replaced. Run the script again to resume. Takes about an hour
# on two idle cores with a software driver.
# Answers about light rest on the ten measured maps of experiments/environments.csv, which are not part of the repository:
# save each as experiments/environments/NAME_1k.hdr. If one is missing or is another file, the set says so and runs
# without it.
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh
. scripts/lights.sh

set_names="quick front break-even source-document-0 printed-document-0 level-bias diffuse tables ladder split-sums pictures coat anisotropy anisotropy-albedo anisotropy-laws sheen lobes temporal ghosts exposure-and-contrast direct-and-image better-method timing"
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
require compiler loader driver
say "building (the first time takes a few minutes)"
cargo build --release --locked
require_device target/release/splitsum

# Measured maps with the hash in the table, as values of an axis.
maps=""
while IFS=, read -r name hash _; do
    [ "$name" = name ] && continue
    map=experiments/environments/${name}_1k.hdr
    if [ ! -f "$map" ]; then
        say "$map: missing; the set runs without it"
    elif [ "$(sha256sum "$map" | cut -d" " -f1)" != "$hash" ]; then
        say "$map: not the file that experiments/environments.csv names; the set runs without it"
    else
        maps="$maps,$map"
    fi
done <experiments/environments.csv

# A run with failed cells (exit 4) is published with what it has; any other fault ends the set.
status=0
folders=""
for name in $set_names; do
    say "$name"
    code=0
    lights=$(lights_of "$name" "${maps#,}")
    target/release/splitsum run "experiments/$name.toml" ${lights:+--set "environment=$lights"} --out "$runs/$name" >/dev/null || code=$?
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
