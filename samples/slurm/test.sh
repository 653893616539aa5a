#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Tests part.sbatch: an array of four parts, one lost, one run twice, then mended, must give the bytes of one run.
#   samples/slurm/test.sh [PROGRAM]    PROGRAM: build/release/bin/crofton
# With Slurm and munge installed, on a cluster of three nodes on this machine, which it starts and ends (as root).
# Without them a loop stands in for the array, and the cluster is skipped, with the reason.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
CROFTON=$(realpath "${1:-$here/../../build/release/bin/crofton}")
[[ -x $CROFTON ]] || { echo "samples/slurm/test.sh: $CROFTON is not built" >&2; exit 2; }
folder=$(mktemp -d)
export CROFTON PARTS=4 SCENE=room PARTS_DIR="$folder/parts" COMMAND OPTIONS
regions=$folder/regions
daemons=()
finish() {
    for ((i = ${#daemons[@]} - 1; i >= 0; --i)); do kill "${daemons[i]}" 2>/dev/null || true; done
    wait 2>/dev/null || true
    rm -rf "$folder"
}
trap finish EXIT
wrong() { echo "samples/slurm/test.sh: $1" >&2; exit 1; }

why_no_slurm() {
    local program
    for program in sbatch slurmctld slurmd munged; do
        command -v "$program" >/dev/null || { echo "$program is not installed (third_party/install.sh --slurm)"; return; }
    done
    [[ $(id -u) -eq 0 ]] || echo "its daemons need root here"
}

# A cluster of its own: its folder, its key and its ports, beside any other on this machine.
start_cluster() {
    local host port=$((20000 + $$ % 10000 * 4)) node
    host=$(hostname -s)
    mkdir -p "$folder/munge" "$folder/ctld"
    chmod 755 "$folder"
    dd if=/dev/urandom of="$folder/munge/key" bs=1024 count=1 status=none
    chmod 400 "$folder/munge/key"
    munged --foreground --force --key-file "$folder/munge/key" --socket "$folder/munge/socket" \
        --pid-file "$folder/munge/pid" --log-file "$folder/munge/log" --seed-file "$folder/munge/seed" >"$folder/munged.out" 2>&1 &
    daemons+=($!)
    cat >"$folder/slurm.conf" <<CONF
ClusterName=crofton
SlurmctldHost=$host
SlurmctldPort=$port
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge/socket
CredType=cred/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
StateSaveLocation=$folder/ctld
SlurmdSpoolDir=$folder/spool.%n
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.%n.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.%n.log
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
NodeName=one,two,three NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + 1)),$((port + 2)),$((port + 3)) CPUs=1 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
    export SLURM_CONF="$folder/slurm.conf"
    for ((i = 0; i < 50; ++i)); do [[ -S $folder/munge/socket ]] && break; sleep 0.2; done
    slurmctld -D -f "$SLURM_CONF" >"$folder/slurmctld.out" 2>&1 &
    daemons+=($!)
    for node in one two three; do
        mkdir -p "$folder/spool.$node"
        slurmd -D -N "$node" -f "$SLURM_CONF" >"$folder/slurmd.$node.out" 2>&1 &
        daemons+=($!)
    done
    for ((i = 0; i < 60; ++i)); do
        [[ $(sinfo -h -N -t idle -o %N 2>/dev/null | wc -l) -eq 3 ]] && return
        sleep 1
    done
    tail -n 20 "$folder"/*.out "$folder"/*.log >&2 || true
    wrong "the cluster did not come up"
}

array_by_slurm() { sbatch --wait --quiet --array="$1" --output="$folder/log.%a" --chdir="$folder" "$here/part.sbatch"; }
array_by_loop() {
    local i
    for i in $(seq "${1%-*}" "${1#*-}"); do SLURM_ARRAY_TASK_ID=$i "$here/part.sbatch" >"$folder/log.$i"; done
}

# check ARRAY: the whole way, with a lost and a repeated part.
check() {
    local array=$1 status=0
    rm -rf "$PARTS_DIR" "$regions" "$sum"
    "$array" 0-3 || wrong "$array: the array failed: $(cat "$folder"/log.*)"
    rm "$PARTS_DIR/part2"
    cp "$PARTS_DIR/part1" "$PARTS_DIR/part1_again"
    "$CROFTON" merge "$PARTS_DIR"/part* --shards "$PARTS" --out "$sum" 2>"$folder/said" || status=$?
    [[ $status -eq 1 ]] || wrong "$array: merge without part 2 ended with $status: $(cat "$folder/said")"
    [[ $(cat "$folder/said") == *"run again: --shard 2/4" ]] || wrong "$array: merge said: $(cat "$folder/said")"
    ! cmp -s "$sum" "$folder/one" || wrong "$array: the sum is whole without part 2"
    "$array" 2-2 || wrong "$array: part 2 failed: $(cat "$folder"/log.*)"
    "$CROFTON" merge "$PARTS_DIR"/part* --shards "$PARTS" --out "$sum" || wrong "$array: merge of all parts ended with $?"
    cmp "$sum" "$folder/one" || wrong "$array: the sum is not what one run saves"
    echo "$COMMAND, $array: a lost part named and mended, a repeated one counted once, same bytes as one run"
}

# bake COMMAND OPTIONS: sets what the tasks run, and makes the state of one run.
bake() {
    local command options
    COMMAND=$1 OPTIONS=$2 sum=$folder/sum
    read -r -a command <<<"$COMMAND"
    read -r -a options <<<"$OPTIONS"
    rm -f "$folder/one"
    "$CROFTON" "${command[@]}" "$SCENE" "${options[@]}" --state "$folder/one" >/dev/null
}

# check_regions ARRAY: the same for a folder of regions, of which one run makes the index.
check_regions() {
    local SCENE=town options='--instances 400 --no-occluders --regions 4x2 --folder'
    COMMAND=bake OPTIONS="$options $regions" sum=$regions/index.crofton
    # shellcheck disable=SC2086
    "$CROFTON" bake "$SCENE" $options "$folder/one_run" >/dev/null
    cp "$folder/one_run/index.crofton" "$folder/one"
    check "$1"
    diff -r "$regions" "$folder/one_run" || wrong "bake: the regions are not those of one run"
}

check_regions array_by_loop
bake 'study radiosity' '--edge 0.8 --runs 32'
check array_by_loop
bake pvs '--cells 6x2x6 --epsilon 2e-2'
check array_by_loop
reason=$(why_no_slurm)
if [[ -n $reason ]]; then
    echo "skipped: the array on a cluster: $reason"
    exit 0
fi
start_cluster
check array_by_slurm
bake 'study radiosity' '--edge 0.8 --runs 32'
check array_by_slurm
check_regions array_by_slurm
nodes=$(grep -l 'Launching batch job' "$folder"/slurmd.*.log | wc -l)
[[ $nodes -ge 2 ]] || wrong "all tasks ran on one node"
echo "tasks ran on $nodes of 3 nodes"
