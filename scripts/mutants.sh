#!/usr/bin/env bash
# Puts slips into the code that changed since a commit, one at a time, and lists those that no test notices:
#
#   scripts/mutants.sh SINCE [--every N] [rust|glsl]
#   scripts/mutants.sh HEAD~20 --every 10        # each tenth slip of both kinds
#
# Rust slips come from cargo-mutants (`cargo install cargo-mutants`), in the folders that compute or decide. GLSL slips are
# the operators below; each is compiled, and the device and numeric tests run. Works in place, on a clean tree, and restores
# it. A slip that a test notices takes about half a minute, one that survives about four.
# The result is in target/mutants: `caught`, `missed` and `invalid`, a line each, and the score.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
[ "${1:-}" ] || { sed -n '2,11s/^# \{0,1\}//p' "$0"; exit 2; }
since=$1
shift
every=1
kinds="rust glsl"
while [ $# -gt 0 ]; do
    case $1 in
    --every) every=$2 && shift 2 ;;
    rust | glsl) kinds=$1 && shift ;;
    *) echo "mutants: unknown argument $1" >&2 && exit 2 ;;
    esac
done
git diff --quiet HEAD || { echo "mutants: commit or stash your changes first" >&2; exit 2; }
git rev-parse --verify --quiet "$since^{commit}" >/dev/null || { echo "mutants: no commit $since" >&2; exit 2; }

out=target/mutants
rm -rf "$out"
mkdir -p "$out"
touch "$out/caught" "$out/missed" "$out/invalid"
tests=(cargo test --profile edit --locked --features view --test numeric --test device)

# NAME<tab>sed command; one is applied to one line.
operators() {
    printf '%s\t%s\n' \
        'plus to minus' 's/ + / - /' \
        'minus to plus' 's/ - / + /' \
        'times to over' 's# \* # / #' \
        'over to times' 's# / # * #' \
        'max to min' 's/\bmax(/min(/' \
        'min to max' 's/\bmin(/max(/' \
        'less to greater' 's/ < / > /' \
        'greater to less' 's/ > / < /' \
        'x to y' 's/\.x\b/.y/' \
        'y to x' 's/\.y\b/.x/' \
        'sqrt dropped' 's/\bsqrt(/(/' \
        'one to two' 's/\b1\.0\b/2.0/' \
        'half to one' 's/\b0\.5\b/1.0/'
}

# FILE:LINE of the changed lines of shaders that hold code.
changed_glsl() {
    git diff -U0 "$since" -- 'shaders/**/*.glsl' 'shaders/**/*.comp' |
        awk '/^\+\+\+ b\// { file = substr($0, 7) }
             /^@@/ { split($3, at, /[+,]/); line = at[2] - 1 }
             /^\+/ && !/^\+\+\+/ { line++; if ($0 !~ /^\+ *(\/\/|#|layout|$)/) print file ":" line }'
}

# Runs the tests on the tree as it is and files its slip.
judge() {
    if ! cargo build --profile edit --locked >"$out/build.txt" 2>&1; then
        printf '%s\n' "$1" >>"$out/invalid"
    elif "${tests[@]}" >"$out/tests.txt" 2>&1; then
        printf '%s\n' "$1" | tee -a "$out/missed"
    else
        printf '%s: %s\n' "$1" "$(sed -n 's/^test \(.*\) \.\.\. FAILED$/\1/p' "$out/tests.txt" | head -1)" >>"$out/caught"
    fi
}

glsl() {
    local place file line name command count=0
    while IFS= read -r place; do
        file=${place%:*} line=${place##*:}
        while IFS=$'\t' read -r name command; do
            sed "${line}${command}" "$file" >"$out/slip"
            cmp -s "$out/slip" "$file" && continue
            count=$((count + 1))
            [ $((count % every)) -eq 0 ] || continue
            cp "$out/slip" "$file"
            judge "$place: $name"
            git checkout --quiet -- "$file"
        done < <(operators)
    done < <(changed_glsl)
}

rust() {
    command -v cargo-mutants >/dev/null || { echo "mutants: cargo install cargo-mutants" >&2; exit 2; }
    local diff=$out/changes.diff
    git diff "$since" -- src/study src/run src/bake src/instrument/precompute src/base/math src/instrument/brdf src/oracle src/instrument/ladder >"$diff"
    # It ends with 2 if slips survive.
    cargo mutants --in-place --in-diff "$diff" --profile edit --output "$out" --shard "0/$every" --timeout 900 \
        --cargo-arg=--locked --features view -- --test numeric || [ $? -eq 2 ]
    local from=$out/mutants.out
    cat "$from/caught.txt" "$from/timeout.txt" >>"$out/caught"
    cat "$from/missed.txt" >>"$out/missed"
    cat "$from/unviable.txt" >>"$out/invalid"
}

trap 'git checkout --quiet -- src shaders' EXIT
for kind in $kinds; do "$kind"; done
caught=$(wc -l <"$out/caught") missed=$(wc -l <"$out/missed")
printf 'mutants: %s of %s slips caught, %s not valid (%s)\n' \
    "$caught" "$((caught + missed))" "$(wc -l <"$out/invalid")" "$out"
[ "$missed" -eq 0 ]
