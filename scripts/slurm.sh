# shellcheck shell=sh disable=SC2034,SC2154
# Sourced by cluster-test.sh: a Slurm of two nodes in this machine, for a test. It has ports, sockets and keys of its own, so that it
# meets no other.
#
# Reads $work.

# Where the commands inside a job look: SLURM_CONF does not reach them through Snakemake.
slurm_conf=/etc/slurm/slurm.conf
# Ports that a Slurm of the machine does not use, this one and the next two.
slurm_controller_port=26817

# There is no accounting database, so jobs are asked for with squeue. Short latency: the file system is local.
slurm_options="--slurm-status-command squeue --slurm-no-account --seconds-between-status-checks 2 --latency-wait 10 \
--default-resources slurm_partition=p mem_mb=1000 runtime=5 cpus_per_task=1"

has_slurm() {
    has_command slurmctld && has_command slurmd && has_command munged && has_command sbatch
}

start_slurm() {
    [ "$(id -u)" -eq 0 ] || skip "starting slurmd needs root"
    PATH=$PATH:/usr/sbin:/sbin
    has_slurm || install_packages slurmctld slurmd slurm-client munge
    [ ! -e "$slurm_conf" ] || skip "this machine has a Slurm already ($slurm_conf)"
    slurm=$work/slurm
    mkdir -p "$slurm/state"
    # munge refuses keys and sockets in folders that others may write to.
    chmod 755 "$slurm"
    (umask 077 && head -c 1024 /dev/urandom >"$slurm/munge.key")
    host=$(hostname)
    # Each node has half of the processors, or shares the only one.
    slurm_node_processors=$((($(nproc) + 1) / 2))
    cat >"$slurm/slurm.conf" <<CONF
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$slurm_controller_port
AuthType=auth/munge
AuthInfo=socket=$slurm/munge.socket
SlurmUser=root
SlurmctldPidFile=$slurm/slurmctld.pid
SlurmdPidFile=$slurm/slurmd-%n.pid
SlurmctldLogFile=$slurm/slurmctld.log
SlurmdLogFile=$slurm/slurmd-%n.log
StateSaveLocation=$slurm/state
SlurmdSpoolDir=$slurm/spool-%n
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
ReturnToService=2
MinJobAge=3600
KillWait=1
SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=0,bf_interval=1
NodeName=node[1-2] NodeHostname=$host NodeAddr=127.0.0.1 Port=[$((slurm_controller_port + 1))-$((slurm_controller_port + 2))] CPUs=$slurm_node_processors RealMemory=4000 State=UNKNOWN
PartitionName=p Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
    ln -s "$slurm/slurm.conf" "$slurm_conf"
    trap stop_slurm EXIT
    trap 'exit 1' INT TERM
    say "starting munged, slurmctld and slurmd"
    munged --force --key-file="$slurm/munge.key" --socket="$slurm/munge.socket" --pid-file="$slurm/munged.pid" \
        --seed-file="$slurm/munged.seed" --log-file="$slurm/munged.log" || stop "munged does not start: $(cat "$slurm/munged.log")"
    slurmctld -i || stop "slurmctld does not start: $(cat "$slurm/slurmctld.log")"
    for name in node1 node2; do
        slurmd -N "$name" || stop "slurmd does not start: $(cat "$slurm/slurmd-$name.log")"
    done
    tries=0
    until [ "$(sinfo -h -o "%D %T" 2>/dev/null)" = "2 idle" ]; do
        tries=$((tries + 1))
        [ $tries -lt 150 ] || stop "the nodes do not come up: $(tail -n 5 "$slurm"/*.log)"
        sleep 0.2
    done
    sinfo
}

# Ends the daemons that were started here, by the ids they wrote, and waits for their end.
stop_slurm() {
    say "stopping slurmd, slurmctld and munged"
    for daemon in slurmd-node1 slurmd-node2 slurmctld munged; do
        [ -s "$slurm/$daemon.pid" ] || continue
        id=$(cat "$slurm/$daemon.pid")
        kill "$id" 2>/dev/null || true
        tries=0
        while kill -0 "$id" 2>/dev/null && [ $tries -lt 100 ]; do
            tries=$((tries + 1))
            sleep 0.1
        done
    done
    rm -f "$slurm_conf"
}
