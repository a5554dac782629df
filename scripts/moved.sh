#!/bin/sh
# Prints which published numbers a change moves, and by how many per cent:
#
#     sh scripts/moved.sh COMMIT [NAME...]     # experiments of results/; quick and coat if none is named
#
# Builds COMMIT beside the working tree, into target/moved/COMMIT, runs each experiment with both programs and without a
# cache, and compares the tables of their answers (scripts/moved.py). For a change of a formula: first see what moves,
# then publish again and say so in CHANGELOG.md. Takes a build and two runs of each experiment.
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh

[ $# -gt 0 ] || {
    sed -n '2,8s/^# \{0,1\}//p' "$0" >&2
    exit 2
}
commit=$(git rev-parse --verify --quiet "$1^{commit}") || {
    echo "moved.sh: $1 is not a commit" >&2
    exit 2
}
shift
[ $# -gt 0 ] || set -- quick coat
for name in "$@"; do
    [ -f "results/$name/experiment.toml" ] || {
        echo "moved.sh: $name: not a run of results/; expected one of: $(find results -name experiment.toml | cut -d/ -f2 |
            LC_ALL=C sort | paste -s -d ' ' -)" >&2
        exit 2
    }
done
require_rust
require compiler loader driver

out=target/moved/$(git rev-parse --short=12 "$commit")
if [ ! -d "$out/tree" ]; then
    say "checking out $commit into $out/tree"
    git worktree prune
    git worktree add --detach --force "$out/tree" "$commit" >/dev/null
fi
say "building $commit, then the working tree (the first time takes a few minutes)"
(cd "$out/tree" && cargo build --release --locked)
cargo build --release --locked
before=$out/tree/target/release/splitsum
after=target/release/splitsum
require_device "$after" >/dev/null

for name in "$@"; do
    clamp=
    ! grep -q -e --clamp-invalid "results/$name/provenance.json" || clamp=--clamp-invalid
    rm -rf "$out/before/$name" "$out/after/$name"
    "$before" run "results/$name/experiment.toml" $clamp --no-cache --out "$out/before/$name" >/dev/null
    "$after" run "results/$name/experiment.toml" $clamp --no-cache --out "$out/after/$name" >/dev/null
    say "$name"
    python3 scripts/moved.py "$out/before/$name/answers" "$out/after/$name/answers"
done
