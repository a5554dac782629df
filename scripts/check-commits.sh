#!/bin/sh
# Checks the subjects of the commits after BASE: `area: imperative`, at most 72 characters. CONTRIBUTING.md has the
# rule.
#
#     sh scripts/check-commits.sh [BASE]
#
# Skips with one line and exit status 77 without git or without the history since BASE (an unpacked archive, a shallow
# clone).
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh

base=${1:-7d59957}
if ! has_command git || ! git merge-base --is-ancestor "$base" HEAD 2>/dev/null; then
    say "skipped: commit subjects (the history since $base is not here)"
    exit 77
fi
commits=$(git log --no-merges --format='%h %s' "$base..HEAD")
# Characters, not bytes.
export LC_ALL=C.UTF-8
wrong=$(
    printf '%s\n' "$commits" | grep -E '^[0-9a-f]+ .{73}' | sed 's/$/   [longer than 72 characters]/'
    printf '%s\n' "$commits" | grep -E '.' | grep -Ev '^[0-9a-f]+ [a-z0-9][a-z0-9_./-]*: ([a-z]|[A-Z][A-Z0-9])' | sed 's/$/   [expected area: imperative]/'
) || true
[ -z "$wrong" ] || stop "commit subjects:
$wrong"
