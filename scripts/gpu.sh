#!/bin/sh
# Measures on a machine with a GPU that has no compiler and no network:
#
#     sh scripts/gpu.sh pack [ARCHIVE]                # here: builds and packs [target/gpu/splitsum-gpu.tar.xz]
#     sh gpu.sh run MINUTES [--rehearse] [--out DIR]  # there, in the unpacked folder: tests, then runs, then times
#     sh scripts/gpu.sh publish RESULTS               # here: copies the times of RESULTS into results/
#     sh scripts/gpu.sh rehearse MINUTES              # packs, unpacks and runs on the software driver of this machine
#
# `run` writes DIR/splitsum-gpu-results.tar.xz after each step, so that a run that is cut off leaves what it has. Each
# step has its own limit, a share of the time that is left: steps that end early leave their time to the others. A
# device that is a CPU is refused without --rehearse, since its times are a CPU's.
set -eu

ARCHIVE_MB_MAX=25
RESULTS_MB_MAX=12
# Experiments whose answers are compared with the published ones, and experiments of times.
COMPARED="quick better-method anisotropy diffuse"
TIMED="timing equal-time"

say() {
    printf '%s\n' "splitsum: $*"
}

refuse() {
    printf '%s\n' "gpu.sh: $*" >&2
    exit 2
}

usage() {
    sed -n '2,11s/^# \{0,1\}//p' "$0" >&2
    exit 2
}

# Fails if a file is larger than so many MB.
check_size() { # file, MB
    [ "$(wc -c <"$1")" -le $(($2 * 1000000)) ] || {
        say "$1 has $(($(wc -c <"$1") / 1000000)) MB; expected at most $2"
        return 1
    }
}

# The commit, marked where files differ from it. A rehearsal may run where git is missing.
commit_of_checkout() {
    git describe --always --abbrev=12 --dirty 2>/dev/null || echo unknown
}

pack() { # archive
    cd "$(dirname "$0")/.."
    . scripts/setup.sh
    require_rust
    require compiler loader xz
    archive=${1:-target/gpu/splitsum-gpu.tar.xz}
    say "building (the first time takes a few minutes)"
    cargo build --release --locked
    device=$(test_binaries --test device | sed -n 's/^device //p')
    [ -n "$device" ] || stop "cargo names no test binary 'device'"

    stage=$(mktemp -d)
    trap 'rm -rf "$stage"' EXIT
    top=$stage/splitsum-gpu
    mkdir -p "$top/experiments/environments" "$top/tests" "$top/shaders/shade" "$top/results" "$top/scripts" "$top/lib"
    strip -o "$top/splitsum" target/release/splitsum
    strip -o "$top/device" "$device"
    cp scripts/gpu.sh scripts/compare_answers.py "$top/"
    cp scripts/lights.sh "$top/scripts/"
    cp -R tests/golden "$top/tests/"
    cp -R shaders/shade/method "$top/shaders/shade/"
    cp experiments/environments.csv "$top/experiments/"
    for name in $COMPARED $TIMED; do
        cp "experiments/$name.toml" "$top/experiments/"
        [ ! -d "results/$name/answers" ] || {
            mkdir -p "$top/results/$name"
            cp -R "results/$name/answers" "results/$name/provenance.json" "$top/results/$name/"
        }
    done
    while IFS=, read -r name _; do
        map=experiments/environments/${name}_1k.hdr
        [ "$name" = name ] || [ ! -f "$map" ] || cp "$map" "$top/experiments/environments/"
    done <experiments/environments.csv
    # Bare machines with a driver often lack the loader.
    loader=$(ldconfig -p 2>/dev/null | sed -n 's/.*libvulkan\.so\.1 .*x86-64.*=> //p' | head -n 1)
    [ -z "$loader" ] || cp -L "$loader" "$top/lib/libvulkan.so.1"
    commit_of_checkout >"$top/commit"
    mkdir -p "$(dirname "$archive")"
    # Both programs hold the same library, which the window of -9 spans.
    tar -C "$stage" -cf - splitsum-gpu | xz -9e >"$archive"
    check_size "$archive" "$ARCHIVE_MB_MAX"
    say "$archive: $(($(wc -c <"$archive") / 1000)) kB, commit $(cat "$top/commit")"
}

# Sets `limit`: the part of the time left that a step of this weight may take.
share() { # weight
    left=$((deadline - $(date +%s)))
    limit=$((left * $1 / weights_left))
    weights_left=$((weights_left - $1))
}

# Runs a step within its own limit and notes how it ended. Its output is a file of the results.
step() { # name, seconds, command...
    step_name=$1
    limit=$2
    shift 2
    left=$((deadline - $(date +%s)))
    [ "$limit" -le "$left" ] || limit=$left
    if [ "$limit" -lt 5 ]; then
        ending="left out"
        echo "$step_name,$ending,0" >>"$out/steps.csv"
        say "$step_name: left out, the time is up"
        return 0
    fi
    begun=$(date +%s)
    say "$step_name (at most $limit s)"
    status=0
    timeout -k 10 "$limit" "$@" >"$out/$step_name.log" 2>&1 </dev/null || status=$?
    seconds=$(($(date +%s) - begun))
    case $status in
        0) ending=ok ;;
        124 | 137) ending="cut off" ;;
        *) case $step_name in compare-*) ending=differs ;; *) ending="failed ($status)" ;; esac ;;
    esac
    echo "$step_name,$ending,$seconds" >>"$out/steps.csv"
    say "$step_name: $ending, $seconds s"
    case $ending in failed* | differs) tail -n 12 "$out/$step_name.log" | sed 's/^/    /' ;; esac
    keep
}

# Packs what the results hold so far: tables and logs, no images.
keep() {
    packed=$out/splitsum-gpu-results.tar.xz
    (cd "$out" && find . -type f \( -name '*.csv' -o -name '*.json' -o -name '*.toml' -o -name '*.md' -o -name '*.svg' \
        -o -name '*.log' -o -name '*.txt' -o -name commit \) ! -name 'live.json' ! -name 'intermediates.json' \
        ! -path '*/records/*' -print0 |
        tar --null --no-recursion -T - -cf -) | xz -T0 -6 >"$packed.new"
    mv "$packed.new" "$packed"
}

# The measured maps that were packed, separated by commas: in the order of the list, as the published runs have them,
# since comparisons go row by row.
packed_maps() {
    while IFS=, read -r name _; do
        map=experiments/environments/${name}_1k.hdr
        [ ! -f "$map" ] || echo "$map"
    done <experiments/environments.csv | paste -s -d , -
}

# The option that gives references all their samples, if the published run gave them: fewer alone move small ratios by
# up to a half.
references_of() { # name
    published=results/$1/provenance.json
    [ ! -f "$published" ] || grep -q '"noise_share": 0*[.][0-9]*[1-9]' "$published" || echo --exact-references
}

experiment() { # name, weight
    lights=$(lights_of "$1" "$(packed_maps)")
    references=$(references_of "$1")
    share "$2"
    step "run-$1" "$limit" ./splitsum run "experiments/$1.toml" ${lights:+--set "environment=$lights"} $references \
        --out "$out/runs/$1" --no-cache
    # A run that was cut off lacks rows. Times are of another machine.
    case "$ending $1" in "ok timing" | "ok equal-time") return 0 ;; "ok "*) ;; *) return 0 ;; esac
    if [ ! -d "results/$1/answers" ] || ! command -v python3 >/dev/null; then
        say "$1: not compared (python3 or the published answers are missing)"
        return 0
    fi
    missing=$(published_maps "$1" | while read -r map; do [ -f "$map" ] || echo "$map"; done | paste -s -d ' ' -)
    if [ -n "$missing" ]; then
        say "$1: not compared (the published run has maps that were not packed: $missing)"
        return 0
    fi
    step "compare-$1" 30 python3 compare_answers.py "results/$1/answers" "$out/runs/$1/answers"
}

# Clocks, temperature and driver: what a published time is worth.
describe_gpu() {
    if command -v nvidia-smi >/dev/null; then
        nvidia-smi --query-gpu=name,driver_version,clocks.sm,clocks.max.sm,clocks.mem,temperature.gpu,power.draw --format=csv
    else
        echo "nvidia-smi is missing: clocks and temperature are unknown"
    fi
}

run() { # minutes, options
    minutes=${1:-}
    case $minutes in '' | *[!0-9]* | 0) refuse "run: expected a number of minutes" ;; esac
    shift
    is_rehearsal=
    out=$PWD/results-gpu
    while [ $# -gt 0 ]; do
        case $1 in
            --rehearse) is_rehearsal=yes ;;
            --out)
                [ $# -gt 1 ] || refuse "--out needs a folder"
                mkdir -p "$2"
                out=$(cd "$2" && pwd)
                shift
                ;;
            *) usage ;;
        esac
        shift
    done
    cd "$(dirname "$0")"
    if [ ! -f commit ] || [ ! -x splitsum ] || [ ! -x device ]; then
        refuse "$PWD is not an unpacked archive; make one with: sh scripts/gpu.sh pack"
    fi
    . scripts/lights.sh
    mkdir -p "$out"
    if [ -e "$out/commit" ] && ! cmp -s commit "$out/commit"; then
        refuse "$out has results of commit $(cat "$out/commit"); this archive is of $(cat commit). Choose another --out"
    fi
    cp commit "$out/commit"
    deadline=$(($(date +%s) + 60 * minutes))
    # The sum of the weights below.
    weights_left=110
    LD_LIBRARY_PATH=${LD_LIBRARY_PATH:+$LD_LIBRARY_PATH:}$PWD/lib
    # Containers mount NVIDIA's manifest where the loader does not look.
    nvidia=/usr/local/nvidia/share/vulkan/icd.d/nvidia_icd.json
    [ -n "${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-}" ] || [ ! -e "$nvidia" ] || export VK_DRIVER_FILES="$nvidia"
    export LD_LIBRARY_PATH SPLITSUM_VALIDATION=0 GOLDEN=require

    ./splitsum devices >"$out/devices.txt" 2>&1 ||
        refuse "$(tail -n 1 "$out/devices.txt")"
    cat "$out/devices.txt"
    # Column 3 is the type of the device that runs use by default, the first one.
    type=$(sed -n '3s/^|[^|]*|[^|]*| *\([a-z-]*\) *|.*/\1/p' "$out/devices.txt")
    if [ "$type" = cpu ]; then
        [ -n "$is_rehearsal" ] ||
            refuse "the device is a CPU, so all times would be a CPU's; to rehearse the script on it: --rehearse"
        say "a rehearsal: every time below is a CPU's"
    fi
    # A device that lacks what runs need, such as timestamps, is refused before the first step.
    ./splitsum render --method none --diffuse none --environment builtin:constant --size 8x8 \
        --out "$out/probe.exr" >"$out/probe.log" 2>&1 || refuse "$(tail -n 1 "$out/probe.log")"
    rm "$out/probe.exr" "$out/probe.log"
    [ -e "$out/steps.csv" ] || echo "step,ending,seconds" >"$out/steps.csv"
    describe_gpu >"$out/gpu-before.txt" 2>&1 || true
    keep
    # The last test takes as long as all others together: it comes last of the tests, so that it cuts off none of them.
    last=every_method_matches_its_f64_twin
    share 25
    step device-tests "$limit" ./device --skip "$last"
    for name in $COMPARED; do
        experiment "$name" 10
    done
    for name in $TIMED; do
        experiment "$name" 12
    done
    share 21
    step device-last-test "$limit" ./device "$last"
    describe_gpu >"$out/gpu-after.txt" 2>&1 || true
    keep
    check_size "$out/splitsum-gpu-results.tar.xz" "$RESULTS_MB_MAX" || return 1
    cat "$out/steps.csv"
    say "results: $out/splitsum-gpu-results.tar.xz"
    # The driver of the published runs, which a rehearsal has, must find the published answers.
    ! grep -q ",failed${is_rehearsal:+\|,differs}" "$out/steps.csv"
}

publish() { # results
    results=${1:-}
    [ -f "$results" ] || refuse "publish: expected an archive of results"
    results=$(cd "$(dirname "$results")" && pwd)/$(basename "$results")
    cd "$(dirname "$0")/.."
    stage=$(mktemp -d)
    trap 'rm -rf "$stage"' EXIT
    tar -C "$stage" -xf "$results" 2>/dev/null || refuse "$results is not an archive"
    [ -f "$stage/commit" ] || refuse "$results is not an archive of results"
    [ "$(cat "$stage/commit")" != unknown ] || refuse "$results does not name its commit: git was missing where it was packed"
    [ "$(cat "$stage/commit")" = "$(commit_of_checkout)" ] ||
        refuse "$results is of commit $(cat "$stage/commit"); this checkout is $(commit_of_checkout)"
    grep -q '| cpu ' "$stage/devices.txt" && refuse "$results is a rehearsal: its times are a CPU's"
    for name in $TIMED; do
        [ -d "$stage/runs/$name/answers" ] || {
            say "$name did not end: not published"
            continue
        }
        rm -rf "results/$name-gpu"
        cp -R "$stage/runs/$name" "results/$name-gpu"
        cat "$stage/gpu-before.txt" "$stage/gpu-after.txt" >"results/$name-gpu/gpu.txt"
        say "results/$name-gpu"
    done
}

rehearse() { # minutes
    minutes=${1:-1}
    pack target/gpu/splitsum-gpu.tar.xz
    rehearsal=$(mktemp -d)
    trap 'rm -rf "$stage" "$rehearsal"' EXIT
    tar -C "$rehearsal" -xf target/gpu/splitsum-gpu.tar.xz
    sh "$rehearsal/splitsum-gpu/gpu.sh" run "$minutes" --rehearse --out "$rehearsal/out"
}

[ $# -gt 0 ] || usage
verb=$1
shift
case $verb in
    pack | run | publish | rehearse) "$verb" "$@" ;;
    -h | --help) usage ;;
    *) usage ;;
esac
