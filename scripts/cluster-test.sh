#!/bin/sh
# Runs a small experiment in chunks with cluster/Snakefile and compares the merged tables with those of one run.
#
#     sh scripts/cluster-test.sh local    # Snakemake on this machine
#     sh scripts/cluster-test.sh slurm    # Snakemake over Slurm: installs and starts slurmctld, slurmd and munge here, and stops them (root)
#
# The first attempt at chunk 1 ends with 75, as after a lost device; the first attempt at chunk 2 is killed at work. Both must be made good.
# Snakemake comes from PyPI into target/cluster-venv. If it cannot be installed, the test is skipped: one line, exit status 77.
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh
. scripts/slurm.sh

mode=${1:-local}
case $mode in
    local) packages="snakemake>=9,<10" ;;
    slurm) packages="snakemake>=9,<10 snakemake-executor-plugin-slurm>=2.8,<3" ;;
    *) stop "cluster-test.sh: $mode is no mode; expected local or slurm" ;;
esac

root=$PWD
work=$root/target/cluster-test/$mode
venv=$root/target/cluster-venv

skip() {
    say "skipped: the cluster test ($mode): $*"
    exit 77
}

has_snakemake() {
    [ -x "$venv/bin/snakemake" ] || return 1
    [ "$mode" = local ] || "$venv/bin/python" -c "import snakemake_executor_plugin_slurm" 2>/dev/null
}

install_snakemake() {
    has_command python3 || skip "python3 is not installed"
    python3 -c 'import sys; sys.exit(sys.version_info < (3, 11))' || skip "Snakemake 9 needs Python 3.11, this is $(python3 --version)"
    say "installing $packages into target/cluster-venv"
    python3 -m venv "$venv" >/dev/null 2>&1 || skip "python3 -m venv fails (Debian: apt-get install python3-venv)"
    # shellcheck disable=SC2086
    "$venv/bin/pip" install -q --disable-pip-version-check $packages || skip "pip cannot install Snakemake (no network?)"
}

# A stand-in for splitsum whose first attempts at chunks 1 and 2 do not end well.
write_unlucky() {
    cat >"$work/unlucky" <<UNLUCKY
#!/bin/sh
splitsum=$root/target/release/splitsum
first=$work/first
UNLUCKY
    cat >>"$work/unlucky" <<'UNLUCKY'
chunk=
case "$*" in
    *"--chunk 1 "*) chunk=1 ;;
    *"--chunk 2 "*) chunk=2 ;;
esac
# A folder can be made once only.
[ -n "$chunk" ] && mkdir "$first-$chunk" 2>/dev/null || exec "$splitsum" "$@"
if [ "$chunk" -eq 1 ]; then
    echo "injected: the device is lost"
    exit 75
fi
"$splitsum" "$@" &
child=$!
for store do :; done
until [ -n "$(find "$store/chunks/00002" -path '*/cells/*.json' 2>/dev/null)" ] || ! kill -0 $child 2>/dev/null; do
    sleep 0.01
done
kill -KILL $child
echo "injected: the worker is killed"
# Under Slurm the whole job goes, the process that Snakemake started in it included.
[ -z "${SLURM_JOB_ID:-}" ] || scancel --signal=KILL --full "$SLURM_JOB_ID"
sleep 1
exit 137
UNLUCKY
    chmod +x "$work/unlucky"
}

write_experiment() {
    cat >"$work/sweep.toml" <<'EXPERIMENT'
name = "sweep"
question = "Do chunks make the same tables?"
size = [64, 64]
reference = { samples = 256 }
[axes]
environment = ["builtin:gradient", "builtin:sky"]
brdf = ["ggx", "phong"]
alpha = [0.25, 1.0]
method = ["sampled", "split-sum"]
samples = [4, 16, 64]
diffuse = ["none"]
f0 = [1]
albedo = [0]
[precompute]
prefilter_size = [32, 32]
prefilter_level_count = 2
prefilter_sample_count = 64
dfg_size = 16
dfg_sample_count = 64
[timing]
rounds = 3
warmup = 1
EXPERIMENT
}

options_of() { # mode
    [ "$1" = local ] || printf '%s\n' "$slurm_options"
}

# Snakemake with the rest of its options.
workflow() {
    (cd "$work" && "$venv/bin/snakemake" --snakefile "$root/cluster/Snakefile" --workflow-profile "$root/cluster/profiles/$mode" \
        --config experiment=sweep.toml store=store chunk_seconds=1.1 splitsum="$work/unlucky" "$@")
}

check() { # what, command...
    what=$1
    shift
    "$@" || stop "FAILED: $what"
    say "ok: $what"
}

is_same() {
    cmp "$work/store/$1" "$work/whole/$1"
}

has_attempts() { # chunk, count
    [ "$(find "$work/store/chunks/0000$1" -mindepth 1 -maxdepth 1 -type d | wc -l)" -eq "$2" ]
}

compare() {
    for table in errors.csv errors_by_n_dot_v.csv images.csv; do
        check "$table of the chunks is that of one run" is_same "$table"
    done
    check "the injected faults have met both chunks" test -d "$work/first-1" -a -d "$work/first-2"
    check "the killed chunk was tried twice, and went on" has_attempts 2 2
    check "a report" test -s "$work/store/report.html"
}

has_snakemake || install_snakemake
require_rust
cargo build --release --locked --quiet
rm -rf "$work"
mkdir -p "$work"
write_experiment
write_unlucky
say "one run"
(cd "$work" && "$root/target/release/splitsum" run sweep.toml --out whole >whole.log 2>&1) || stop "$(cat "$work/whole.log")"

[ "$mode" = local ] || start_slurm
say "the same in chunks, by Snakemake $("$venv/bin/snakemake" --version)"
# shellcheck disable=SC2046
workflow $(options_of "$mode") >"$work/snakemake.log" 2>&1 || {
    cat "$work/snakemake.log"
    stop "FAILED: the workflow"
}
grep -E 'Trying to restart|SLURM-job|steps \(100%\)|Elapsed' "$work/snakemake.log"
compare
if [ "$mode" = local ]; then
    workflow >"$work/again.log" 2>&1 || stop "FAILED: a second invocation: $(cat "$work/again.log")"
    check "a second invocation has nothing to do" grep -q "Nothing to be done" "$work/again.log"
else
    show_jobs
fi
