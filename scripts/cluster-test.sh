#!/bin/sh
# Runs a small experiment in shards with cluster/Snakefile and compares the merged tables with the tables of one run.
#
#     sh scripts/cluster-test.sh local    # Snakemake on this machine
#     sh scripts/cluster-test.sh slurm    # Snakemake over Slurm, which it installs, starts and stops (root)
#
# The first attempt at shard 1 ends with 75, as after a lost device; the first attempt at shard 2 is killed at work. With
# Slurm, 8 shards of a longer experiment must then keep both nodes busy, which takes four minutes on two cores without other
# work. A job takes four seconds to start, so that shorter shards would not.
# Snakemake comes from PyPI into target/cluster-venv. If that fails, the test is skipped: one line, exit status 77.
set -eu
cd "$(dirname "$0")/.."
. scripts/setup.sh
. scripts/slurm.sh

mode=${1:-local}
case $mode in
    local) packages="snakemake>=9,<10" ;;
    slurm) packages="snakemake>=9,<10 snakemake-executor-plugin-slurm>=2.8,<3" ;;
    *) stop "cluster-test.sh: $mode is not a mode; expected local or slurm" ;;
esac

root=$PWD
work=$root/target/cluster-test/$mode
venv=$root/target/cluster-venv

skip() {
    say "skipped: the cluster test ($mode): $*"
    exit 77
}

install_snakemake() {
    python3 -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || skip "Snakemake 9 needs Python 3.11"
    say "installing $packages into target/cluster-venv"
    python3 -m venv "$venv" >/dev/null 2>&1 || skip "python3 -m venv fails (Debian: apt-get install python3-venv)"
    # shellcheck disable=SC2086
    "$venv/bin/pip" install -q --disable-pip-version-check $packages || skip "pip cannot install Snakemake (no network?)"
}

# A splitsum whose first attempts at shards 1 and 2 fail.
write_unlucky() {
    cat >"$work/unlucky" <<UNLUCKY
#!/bin/sh
splitsum=$root/target/release/splitsum
work=$work
UNLUCKY
    cat >>"$work/unlucky" <<'UNLUCKY'
shard=
case "$*" in
    *"--shard 1/"*) shard=1 ;;
    *"--shard 2/"*) shard=2 ;;
esac
# A folder can be made once only.
[ -n "$shard" ] && mkdir "$work/first-$shard" 2>/dev/null || exec "$splitsum" "$@"
[ "$shard" -ne 1 ] || exit 75
"$splitsum" "$@" &
child=$!
until [ -n "$(ls "$work/out/cells" 2>/dev/null)" ] || ! kill -0 $child 2>/dev/null; do
    sleep 0.01
done
kill -KILL $child
# Under Slurm the whole job goes, with the process that Snakemake started in it.
[ -z "${SLURM_JOB_ID:-}" ] || scancel --signal=KILL --full "$SLURM_JOB_ID"
sleep 1
exit 137
UNLUCKY
    chmod +x "$work/unlucky"
}

write_experiment() {
    cat >"$work/sweep.toml" <<'EXPERIMENT'
name = "sweep"
question = "Do shards make the same tables?"
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
[timing]
rounds = 3
warmup = 1
EXPERIMENT
}

# Snakemake on an experiment of $work in that many shards, with a program in place of splitsum.
workflow() { # experiment, out, shards, program
    # shellcheck disable=SC2046,SC2086
    (cd "$work" && "$venv/bin/snakemake" --snakefile "$root/cluster/Snakefile" --workflow-profile "$root/cluster/profiles/$mode" \
        --config experiment="$1" out="$2" shards="$3" splitsum="$work/$4" $([ "$mode" = local ] || echo "$slurm_options"))
}

# A splitsum that notes node, start and end of each shard. A node has its half of the processors alone, as its own machine would.
write_noting() {
    cat >"$work/noting" <<NOTING
#!/bin/sh
half=$slurm_node_processors
last=$(($(nproc) - 1))
set -- $root/target/release/splitsum "\$@"
NOTING
    cat >>"$work/noting" <<'NOTING'
case "$*" in *--shard*) ;; *) exec "$@" ;; esac
case $SLURMD_NODENAME in
    node1) processors=0-$((half - 1)) ;;
    *) processors=$((last - half + 1))-$last ;;
esac
begun=$(date +%s.%N)
status=0
taskset -c "$processors" "$@" || status=$?
echo "$SLURMD_NODENAME $begun $(date +%s.%N)" >>"${0%/*}/busy.txt"
exit $status
NOTING
    chmod +x "$work/noting"
}

write_longer_experiment() {
    cat >"$work/longer.toml" <<'EXPERIMENT'
name = "longer"
size = [160, 160]
reference = { samples = 12288, noise_share = 0 }
[axes]
environment = ["builtin:gradient", "builtin:sky"]
brdf = ["ggx", "phong"]
alpha = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8]
method = ["sampled", "split-sum"]
samples = [4, 16, 64]
diffuse = ["none"]
f0 = [1]
albedo = [0]
EXPERIMENT
}

# Whether both nodes worked on shards for 90 % of the time from the first start to the last end.
nodes_were_busy() {
    awk '
        NR == 1 || $2 < first { first = $2 }
        $3 > last { last = $3 }
        { busy[$1] += $3 - $2; shards[$1]++ }
        END {
            for (node in busy) {
                share = busy[node] / (last - first)
                printf "%s: %d shards, busy for %.0f %% of %.0f s\n", node, shards[node], 100 * share, last - first
                idle += share < 0.9
                nodes++
            }
            exit nodes != 2 || idle > 0
        }' "$work/busy.txt"
}

check() { # what, command...
    what=$1
    shift
    "$@" || stop "FAILED: $what"
    say "ok: $what"
}

has_snakemake() {
    [ -x "$venv/bin/snakemake" ] || return 1
    [ "$mode" = local ] || "$venv/bin/python" -c "import snakemake_executor_plugin_slurm" 2>/dev/null
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
say "the same in shards, by Snakemake $("$venv/bin/snakemake" --version)"
workflow sweep.toml out 4 unlucky >"$work/snakemake.log" 2>&1 || stop "FAILED: the workflow: $(cat "$work/snakemake.log")"
for table in errors.csv errors_by_n_dot_v.csv images.csv; do
    check "$table of the shards equals the table of one run" cmp "$work/out/$table" "$work/whole/$table"
done
check "both faults were met" test -d "$work/first-1" -a -d "$work/first-2"
check "a report" test -s "$work/out/report.html"
workflow sweep.toml out 4 unlucky >"$work/again.log" 2>&1 || stop "FAILED: a second invocation: $(cat "$work/again.log")"
check "a second invocation has nothing to do" grep -q "Nothing to be done" "$work/again.log"

[ "$mode" = slurm ] || exit 0
say "8 shards of a longer experiment"
write_noting
write_longer_experiment
workflow longer.toml longer 8 noting >"$work/longer.log" 2>&1 || stop "FAILED: the workflow: $(cat "$work/longer.log")"
check "8 shards keep both nodes busy" nodes_were_busy
