#!/usr/bin/env bash
# Fuzzes every kind of input: scripts/fuzz.sh MINUTES [TARGET...]
#
# Each target gets that many minutes of CPU time, one after the other, at the lowest priority, within 2 GiB and 60 s an input, by the clock.
# fuzz/target/logs/summary.txt has CPU seconds, executions and crashes, a line a target; fuzz/artifacts keeps the crashes.
# Needs the nightly toolchain and `cargo install cargo-fuzz`. Every process is in the group of this script:
# `kill -- -PID` ends it, where PID is in fuzz/target/logs/pid. Do not pause it: the pause counts as a hang.
#
#   scripts/fuzz.sh 20                 20 CPU-minutes each
#   scripts/fuzz.sh 5 exr hdr          two of them
#   scripts/fuzz.sh minimize           adds to fuzz/corpus the few small inputs that reach every edge
#   SANITIZER=none scripts/fuzz.sh 20  without AddressSanitizer
#   BUILD=no scripts/fuzz.sh 20        what was built last
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
[ "${1:-}" ] || { sed -n '2,15s/^# \{0,1\}//p' "$0"; exit 2; }
# A session of its own, so that one signal reaches every process.
[ "${FUZZ_SESSION:-}" ] || FUZZ_SESSION=1 exec setsid --wait "$0" "$@"

what=$1
shift
targets=("$@")
[ $# -gt 0 ] || targets=(hdr exr obj gltf experiment queries report ktx2 ktx dds png sh bake)
sanitizer=${SANITIZER:-address}
triple=$(rustc -vV | sed -n 's/^host: //p')
binaries=fuzz/target/$triple/release
logs=fuzz/target/logs
mkdir -p "$logs"
echo $$ >"$logs/pid"
limits=(-rss_limit_mb=2048 -malloc_limit_mb=2048 -timeout=60 -print_final_stats=1)
# One thread: more would only wait for each other. Freed memory that AddressSanitizer keeps would count against the
# limit. Two C libraries below define a table of the same name.
export RAYON_NUM_THREADS=1 ASAN_OPTIONS=quarantine_size_mb=64:detect_leaks=0:detect_odr_violation=0
# The longest input: EXR files need room for headers, text needs less.
longest() { case $1 in exr) echo 16384 ;; *) echo 6144 ;; esac; }

# Builds all targets first, so that edits during the run have no effect.
build() {
    nice -n 19 cargo +nightly fuzz build -O --sanitizer "$sanitizer" >"$logs/build.txt" 2>&1 ||
        { tail -20 "$logs/build.txt"; exit 1; }
}

minimize() {
    local target=$1 kept=fuzz/corpus/$1 found=fuzz/target/corpus/$1 fresh=fuzz/target/minimal/$1
    rm -rf "$fresh" && mkdir -p "$fresh" "$found"
    nice -n 19 "$binaries/$target" -set_cover_merge=1 -use_counters=0 "${limits[@]}" "$fresh" "$kept" "$found" >>"$logs/$target.txt" 2>&1
    # Seeds stay, even if a smaller file reaches as much: they are examples of the inputs.
    for file in "$fresh"/*; do
        cmp -s "$file" "$kept"/seed-* 2>/dev/null || cp "$file" "$kept/"
    done
    echo "$target: $(find "$kept" -type f | wc -l) files, $(du -sk "$kept" | cut -f1) KiB"
}

fuzz() {
    local target=$1 budget=$(($2 * 60)) used=0 executions=0 status=0 found=fuzz/target/corpus/$1
    mkdir -p "$found" "fuzz/artifacts/$target" "fuzz/regressions/$target"
    while [ "$used" -lt "$budget" ] && [ "$status" -eq 0 ]; do
        # Counts CPU time: on a busy machine a minute of the clock holds little of it.
        local left=$((budget - used)) log="$logs/$target.txt" spent
        TIMEFORMAT='%U %S'
        spent=$( { time nice -n 19 "$binaries/$target" "${limits[@]}" -max_total_time=$((left < 120 ? left + 1 : 120)) \
            -max_len="$(longest "$target")" -artifact_prefix="fuzz/artifacts/$target/" \
            "$found" "fuzz/corpus/$target" "fuzz/regressions/$target" >"$log" 2>&1; } 2>&1) || status=$?
        used=$(awk -v used="$used" '{ printf "%d", used + $1 + $2 + 0.5 }' <<<"$spent")
        executions=$((executions + $(sed -n 's/^stat::number_of_executed_units: *//p' "$log" | tail -1 || true) + 0))
    done
    echo "$(date -u +%FT%TZ) $target: $used CPU-s, $executions executions, sanitizer $sanitizer, exit $status" |
        tee -a "$logs/summary.txt"
    [ "$status" -eq 0 ] || tail -40 "$logs/$target.txt"
    return "$status"
}

[ "${BUILD:-}" = no ] || build
failed=0
for target in "${targets[@]}"; do
    mkdir -p "fuzz/corpus/$target" "fuzz/regressions/$target"
    case $what in
    minimize) minimize "$target" ;;
    *) fuzz "$target" "$what" || failed=1 ;;
    esac
done
exit $failed
