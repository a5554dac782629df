#!/bin/sh
# Times this working tree against another commit, work by work in turn, and prints medians and ratios:
#
#     sh scripts/bench-against.sh COMMIT [--rounds N] [--out FILE.csv] [ROW...]
#
# Builds COMMIT beside the working tree, into target/against/COMMIT, and the working tree. Rows (all but the last three if none
# is named): quick, start, integrate, reference, bake, check-bake, throughput; then on ten maps pictures, front, split-sums;
# then build (a first build of demo.sh), edit (an edit of a shader to its picture), tests (the test command after a build).
# Each round runs the commit and the working tree one after the other; the order changes from round to round. A ratio below 1
# says that the working tree is faster. benches/record.md keeps a table a release.
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh

usage() {
    sed -n '2,10s/^# \{0,1\}//p' "$0" >&2
    exit 2
}
[ $# -gt 0 ] || usage
commit=$(git rev-parse --verify --quiet "$1^{commit}") || {
    echo "bench-against.sh: $1 is not a commit" >&2
    exit 2
}
shift
require_rust
require compiler loader driver python3

tree=target/against/$(git rev-parse --short=12 "$commit")
if [ ! -d "$tree" ]; then
    say "checking out $commit into $tree"
    git worktree prune
    git worktree add --detach --force "$tree" "$commit" >/dev/null
fi
exec python3 -B scripts/bench_against.py "$tree" . "$@"
