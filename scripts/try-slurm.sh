#!/usr/bin/env bash
# Proves the plans for Slurm on a real Slurm: one controller and one node on this machine, with keys,
# ports and a folder of their own, which is removed at the end. Three times a picture is shared out and
# its bytes are compared with those of one render: undisturbed, with a shard that is sent back to the
# queue while it runs, and with a shard that is killed, after which the plan is submitted again.
#
#   scripts/try-slurm.sh [SECONDS]     gives up after so many seconds; 600 by default
#
# Needs root, because slurmd starts jobs as their user. Slurm and munge come from Debian's packages,
# which are installed where they are missing. The program is the one that PHOTOSPHERE names; where it
# names none, it is built. In a chroot, /proc, /dev and /sys must be mounted.
set -euo pipefail

# shellcheck source=scripts/toolchain.sh
. "$(dirname "${BASH_SOURCE[0]}")/toolchain.sh"
limit=${1:-600}
scene=$repository/scenes/paper/fig2.toml
packages=(slurmctld slurmd slurm-client munge)
daemons=()

check_usage() {
    [[ $limit =~ ^[0-9]+$ ]] || { sed -n '7s/^# *//p' "$0"; exit 2; }
    ((EUID == 0)) || { echo "Slurm starts jobs for others, so this must be run by root."; exit 2; }
}

install() {
    local program missing=()
    for program in slurmctld slurmd sbatch munged mungekey; do
        command -v "$program" >/dev/null || missing+=("$program")
    done
    ((${#missing[@]} > 0)) || return 0
    command -v apt-get >/dev/null || { echo "Please install ${missing[*]}."; exit 2; }
    echo "Installing ${packages[*]}"
    apt-get update -qq
    DEBIAN_FRONTEND=noninteractive apt-get install -qq --no-install-recommends "${packages[@]}" >/dev/null
}

# ---- The cluster ----

free_port() {
    local port
    while port=$((20000 + RANDOM % 20000)); do
        (: <"/dev/tcp/127.0.0.1/$port") 2>/dev/null || { echo "$port"; return; }
    done
}

configure() {
    local host
    host=$(hostname -s)
    mkdir -m 755 "$root"/{run,state,spool,work}
    mungekey --create --keyfile "$root/munge.key"
    cat >"$root/slurm.conf" <<EOF
ClusterName=trial
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
AuthType=auth/munge
AuthInfo=socket=$root/run/munge.socket
CredType=cred/munge
SlurmUser=root
StateSaveLocation=$root/state
SlurmdSpoolDir=$root/spool
SlurmctldPidFile=$root/run/slurmctld.pid
SlurmdPidFile=$root/run/slurmd.pid
SlurmctldLogFile=$root/slurmctld.log
SlurmdLogFile=$root/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SchedulerType=sched/builtin
SelectType=select/cons_tres
ReturnToService=2
JobRequeue=1
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
EOF
    export SLURM_CONF=$root/slurm.conf
}

start() {
    munged --foreground --force --num-threads=2 --key-file="$root/munge.key" \
        --socket="$root/run/munge.socket" --pid-file="$root/run/munged.pid" \
        --seed-file="$root/munge.seed" &>"$root/munged.log" &
    daemons+=($!)
    wait_for "the keys" test -S "$root/run/munge.socket"
    slurmctld -D &>/dev/null &
    daemons+=($!)
    slurmd -D -N "$(hostname -s)" &>/dev/null &
    daemons+=($!)
    wait_for "the node" node_is_idle
}

node_is_idle() {
    [[ $(sinfo --noheader --format=%t 2>/dev/null) == idle ]]
}

# Waits until the command after the name $1 succeeds, as long as there is time.
wait_for() {
    local what=$1
    until "${@:2}"; do
        ((SECONDS < limit)) || { echo "gave up waiting for $what"; tail -n 20 "$root"/*.log; exit 1; }
        sleep 0.2
    done
}

clean_up() {
    local at
    if ((${#daemons[@]} == 3)); then
        # Those who watch over jobs would wait for the daemons for ever.
        timeout 10 scancel --quiet --user=root || true
        timeout 10 scancel --quiet --full --signal=KILL --state=RUNNING --user=root || true
        for ((at = 0; at < 100; at++)); do
            if no_jobs; then break; fi
            sleep 0.2
        done
    fi
    for ((at = ${#daemons[@]} - 1; at >= 0; at--)); do
        kill "${daemons[at]}" 2>/dev/null || true
        wait "${daemons[at]}" 2>/dev/null || true
    done
    rm -rf --one-file-system "$root"
}

# ---- The trials ----

# Plans the picture $1 in four shards that keep what they have every tenth of a second, with the
# options that follow, and renders it in one besides.
plan() {
    local options=("${@:2}" --no-run-figures)
    "$PHOTOSPHERE" render "$scene" "${options[@]}" --quiet -o "$1.whole.exr"
    "$PHOTOSPHERE" plan "$scene" "${options[@]}" --shards 4 --format slurm \
        --checkpoint-every 100ms -o "$1.exr" >"$1.slurm"
}

# Submits the plan $1; sets `array` to the number of its shards' job.
submit() {
    local words
    words=$(bash "$1.slurm")
    echo "$1: $words"
    words=${words#shards }
    array=${words%%,*}
}

# Waits until the first shard of the picture $1 has kept something, and runs.
wait_for_a_shard() {
    wait_for "a shard" first_shard_runs "$1"
}

first_shard_runs() {
    [[ $(squeue --noheader --format=%t --jobs="${array}_0" 2>/dev/null) == R ]] &&
        compgen -G "$1.samples-0..*.part" >/dev/null
}

no_jobs() {
    [[ -z $(squeue --noheader 2>/dev/null || echo trouble) ]]
}

# Compares the picture $1 with the one render.
check() {
    cmp "$1.exr" "$1.whole.exr" || { tail -n 20 ./*.log; exit 1; }
    echo "ok: $1: $2"
}

undisturbed() {
    plan undisturbed --size 64x48 --spp 100 --seed 3
    submit undisturbed
    wait_for "the jobs" no_jobs
    check undisturbed "four shards and their merge give the bytes of one render"
}

requeued() {
    plan requeued --size 256x192 --spp 768
    submit requeued
    wait_for_a_shard requeued
    # Slurm lets it wait for two minutes.
    scontrol requeue "${array}_0"
    wait_for "the shard to go on" has_restarted
    wait_for "the jobs" no_jobs
    check requeued "so they do when a shard is sent back to the queue"
}

has_restarted() {
    scontrol show job "${array}_0" 2>/dev/null | grep -q 'Restarts=1'
}

killed() {
    plan killed --size 256x192 --spp 768 --seed 5
    submit killed
    wait_for_a_shard killed
    scancel --full --signal=KILL "${array}_0"
    wait_for "the jobs" no_jobs
    [[ ! -e killed.exr ]] || { echo "the merge did not wait for all shards"; exit 1; }
    submit killed
    wait_for "the jobs" no_jobs
    check killed "so they do when the plan is submitted again after a shard was killed"
}

check_usage
install
find_program
root=$(mktemp -d "${TMPDIR:-/tmp}/photosphere-slurm.XXXXXX")
trap clean_up EXIT
SECONDS=0
chmod 755 "$root"
configure
start
cd "$root/work"
sbatch --version
undisturbed
requeued
killed
