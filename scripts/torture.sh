#!/usr/bin/env bash
# Proves that renders lose nothing: kills them at random moments and lets them run out of disk, file
# size and memory. What comes out in the end must have the bytes of an undisturbed render, and a file
# that was written once must stay complete.
#
#   scripts/torture.sh [ROUNDS [SEED]]     ROUNDS signals (15 by default), then each limit once
#
# A round starts or resumes a render of about a third of a second, sends it one or two random signals
# at random moments, and checks its exit code and its checkpoint. A failure prints the SEED that
# repeats it (as far as timing repeats). The program is the one that PHOTOSPHERE names; where it names
# none, it is built. A full disk needs root, a memory limit a control group that this user may create;
# without them, a line says what was skipped.
set -euo pipefail

# shellcheck source=scripts/toolchain.sh
. "$(dirname "${BASH_SOURCE[0]}")/toolchain.sh"
rounds=${1:-15}
seed=${2:-$(($(date +%s) % 32768))}
declare -A sent=()
finished=0 at_work=0 skipped=()

check_usage() {
    [[ $rounds =~ ^[0-9]+$ && $seed =~ ^[0-9]+$ ]] || { sed -n '6s/^# *//p' "$0"; exit 2; }
}

fail() {
    trap - EXIT
    printf 'FAILED (seed %s): %s\n' "$seed" "$1"
    printf 'The files are in %s; the last messages:\n' "$PWD"
    tail -n 5 "$root/messages"
    clean_mounts
    exit 1
}

clean_mounts() {
    [[ ! -d $root/disk ]] || umount "$root/disk" 2>/dev/null || true
    [[ -z ${group:-} ]] || rmdir "$group" 2>/dev/null || true
}

clean_up() {
    clean_mounts
    rm -rf --one-file-system "$root"
}

# ---- The renders ----

# Each keeps its samples in a.part and writes the files named after the colon.
renders=(
    "--spp 263 -o a.exr --checkpoint a.part:a.exr"
    "--noise 4% -o a.exr --checkpoint a.part:a.exr"
    "--spp 119 -o a.png -o a.exr --layers direct,indirect,albedo,normal,depth --checkpoint a.part:a.png a.exr"
    "--samples 16..208 --spp 999 -o a.part:a.part"
    "--spp 200 --sampler independent --accel brute-force --threads 1 -o a.pfm --checkpoint a.part:a.pfm"
)

# Sets `options` and `outputs` to those of render $1.
choose() {
    read -ra options <<<"${renders[$1]%%:*}"
    read -ra outputs <<<"${renders[$1]#*:}"
    [[ " ${options[*]} " == *" --accel "* ]] || options+=(--accel native)
    options+=(--no-run-figures --checkpoint-every 4ms)
}

# Starts the program with the arguments; sets `process`. Background jobs of a script ignore SIGINT
# unless told otherwise.
start() {
    env --default-signal=INT,QUIT "$PHOTOSPHERE" "$@" 2>>"$root/messages" &
    process=$!
}

# Sets `code` to the exit code of the process.
await() {
    code=0
    { wait "$process" || code=$?; } 2>/dev/null
}

# Prints how many samples the tiles of the checkpoint $1 hold, 0 without one. Fails if it is damaged.
kept() {
    [[ -e $1 ]] || { echo 0; return; }
    "$PHOTOSPHERE" merge "$1" -o "$root/check.part" --allow-gaps --quiet 2>>"$root/messages" || return
    # The picture has 48 tiles; where they differ, `counts` lists runs: tiles, and samples of each.
    "$PHOTOSPHERE" info "$root/check.part" --json 2>>"$root/messages" | tr -d ' \n' | awk '
        match($0, /"counts":\[\[[0-9,\[\]]*\]\]/) {
            runs = split(substr($0, RSTART + 10, RLENGTH - 10), number, /[^0-9]+/)
            for (i = 2; i + 1 <= runs; i += 2) total += number[i] * number[i + 1]
        }
        !total && match($0, /"min_count":[0-9]+/) { total = 48 * substr($0, RSTART + 12, RLENGTH - 12) }
        END { print total + 0 }'
}

# Compares the outputs with those of the undisturbed render $1.
compare() {
    local output
    for output in "${outputs[@]}"; do
        same "$output" "$root/whole.$1/$output" >>"$root/messages" 2>&1 ||
            fail "render $1: $output differs from the undisturbed one"
    done
}

# Compares two files byte by byte. A part also tells how long its render took, its picture does not.
same() {
    local file at=0
    if [[ $1 == *.part ]]; then
        for file in "$@"; do
            "$PHOTOSPHERE" merge "$file" -o "$root/$at.exr" --allow-gaps --no-run-figures --quiet || return
            at=$((at + 1))
        done
        set -- "$root"/{0,1}.exr
    fi
    cmp "$1" "$2"
}

# Renders all without disturbance, once; sets `milliseconds` to the time of the longest.
render_whole() {
    local at began took
    milliseconds=0
    for at in "${!renders[@]}"; do
        choose "$at"
        mkdir "$root/whole.$at"
        cp scene.toml "$root/whole.$at"
        began=${EPOCHREALTIME/./}
        (cd "$root/whole.$at" && "$PHOTOSPHERE" render scene.toml "${options[@]}" --quiet)
        took=$(((${EPOCHREALTIME/./} - began) / 1000))
        all[at]=$(kept "$root/whole.$at/a.part")
        ((took <= milliseconds)) || milliseconds=$took
    done
}

# ---- Signals ----

# Sleeps for a random time below $1 milliseconds.
doze() {
    local time=$((RANDOM % ($1 + 1)))
    sleep "$((time / 1000)).$(printf %03d $((time % 1000)))"
}

# Half of the signals may come at any time, also while the program starts; the others come at most a
# tenth of a render after the next checkpoint.
wait_for_a_moment() {
    if ((RANDOM % 2)); then
        doze $((milliseconds * 2 / 5))
    else
        touch "$root/now"
        until [[ a.part -nt $root/now ]] || ! kill -0 "$process" 2>/dev/null; do sleep 0.002; done
        doze $((milliseconds / 10))
    fi
}

# Sends one signal of those that may come, and sometimes another one while files are written.
send_signals() {
    local signals=(KILL KILL KILL KILL TERM INT HUP USR1 USR2 XCPU) signal
    signal=${signals[RANDOM % ${#signals[@]}]}
    send "$signal"
    if ((RANDOM % 4 == 0)); then
        doze 10
        signal=${signals[RANDOM % ${#signals[@]}]}
        send "$signal"
    fi
}

send() {
    if kill -s "$1" "$process" 2>/dev/null; then
        sent[$1]=$((${sent[$1]:-0} + 1))
        names+=("$1")
    fi
}

# The exit code must be 0, 130 after a request to stop, or that of a process ended by one of the
# signals: for others than SIGKILL, that happens before the program listens.
check_code() {
    local name
    ((code != 0)) || return 0
    for name in "${names[@]}"; do
        ((code != 128 + $(kill -l "$name"))) || return 0
        [[ $name == KILL || $name == USR1 ]] || ((code != 130)) || return 0
    done
    fail "render $1: exit code $code after the signals ${names[*]:-(none)}"
}

# Starts a render anew or from its checkpoint: the same command continues, and so does `resume`.
start_or_resume() {
    if [[ -e a.part ]] && ((RANDOM % 2)); then
        start resume a.part --quiet
    else
        start render scene.toml "${options[@]}" --quiet
    fi
}

# Kills renders $rounds times, and renders the last one to its end.
torture() {
    local round before=0 now at=0
    choose $at
    for ((round = 1; round <= rounds; round++)); do
        names=()
        start_or_resume
        wait_for_a_moment
        send_signals
        await
        check_code $at
        now=$(kept a.part) || fail "render $at: the checkpoint is damaged after ${names[*]:-nothing}"
        ((now >= before)) || fail "render $at: $now of $before samples are left after ${names[*]}"
        ((now == 0 || now == all[at])) || at_work=$((at_work + 1))
        before=$now
        ((round % 100 != 0)) || echo "    $round rounds, $SECONDS s"
        if ((code == 0 && now == all[at])); then
            end_render $at
            before=0 at=$((finished % ${#renders[@]}))
            choose $at
        fi
    done
    "$PHOTOSPHERE" render scene.toml "${options[@]}" --quiet 2>>"$root/messages" || fail "render $at ends with $?"
    end_render $at
}

# Checks what a finished render has left, and removes it. A killed process leaves temporary files.
end_render() {
    local name
    compare "$1"
    rm -f .*.photosphere-tmp "${outputs[@]}" a.part
    for name in * .[!.]*; do
        [[ $name == scene.toml || ! -e $name ]] || fail "render $1 left the file $name"
    done
    finished=$((finished + 1))
}

# ---- Limits ----

# Interrupts render 0 half-way in the folder $1, for a limit to meet; sets `half` to its samples.
render_half() {
    cp "$root/work/scene.toml" "$1"
    cd "$1"
    choose 0
    half=0
    until ((half > 0)); do
        start render scene.toml "${options[@]}" --quiet
        until [[ -e a.part ]]; do sleep 0.005; done
        send TERM
        await
        half=$(kept a.part) || fail "the checkpoint is damaged"
    done
    ((half < all[0])) || fail "render 0 cannot be interrupted half-way"
    rm -f a.exr
}

# Resumes render 0 from the checkpoint $1 and compares.
finish() {
    "$PHOTOSPHERE" resume "$1" --quiet 2>>"$root/messages" || fail "$2: resuming fails with $?"
    compare 0
    echo "ok: $2"
}

skip() {
    echo "SKIPPED: $1"
    skipped+=("$1")
}

full_disk() {
    local about="a full disk" rescued
    mkdir "$root/disk" "$root/tmp"
    if ((EUID != 0)) || ! mount -t tmpfs -o size=2M photosphere-torture "$root/disk" 2>/dev/null; then
        skip "$about: this user cannot mount a small file system"
        return
    fi
    render_half "$root/disk"
    # An end for which a signal asks: what cannot be written is rescued elsewhere.
    dd if=/dev/zero of=filler bs=4k 2>/dev/null || true
    TMPDIR=$root/tmp start resume a.part --quiet
    sleep 1
    send TERM
    await
    ((code == 4)) || fail "$about: exit code $code instead of 4"
    (($(kept a.part) >= half)) || fail "$about: the old checkpoint is damaged"
    rescued=$(find "$root/tmp" -name 'rescued-*a.part')
    [[ -n $rescued ]] || fail "$about: nothing was rescued"
    (($(kept "$rescued") >= half)) || fail "$about: samples were lost in the rescue"
    # Room again while the render goes on and retries.
    TMPDIR=$root/tmp start resume a.part --quiet
    sleep 0.5
    rm filler
    await
    ((code == 0)) || fail "$about: exit code $code once there is room"
    compare 0
    echo "ok: $about, and room again before the end"
    rm -f a.exr a.part
    mv "$rescued" a.part
    finish a.part "$about, and the checkpoint that was rescued from it"
    cd "$root/work"
    umount "$root/disk"
}

file_size_limit() {
    local about="a limit on file sizes"
    mkdir "$root/sizes"
    render_half "$root/sizes"
    cp a.part before.part
    # The limit holds everywhere, so nothing can be rescued; the old checkpoint must stay.
    (
        ulimit -f 8
        start resume a.part --quiet
        sleep 1
        send TERM
        await
        ((code == 4))
    ) || fail "$about: not the exit code 4"
    cmp a.part before.part >>"$root/messages" || fail "$about: the old checkpoint has changed"
    [[ ! -e a.exr ]] || fail "$about: an incomplete picture"
    rm before.part
    finish a.part "$about"
    cd "$root/work"
}

# Sets `group` to a new control group with a memory limit of 256 MiB; fails where there is none.
make_group() {
    local root=/sys/fs/cgroup name=photosphere-torture.$$
    if grep -qw memory "$root/cgroup.subtree_control" 2>/dev/null; then
        group=$root/$name
        mkdir "$group" 2>/dev/null && echo $((256 << 20)) >"$group/memory.max"
    elif [[ -d $root/memory ]]; then
        group=$root/memory/$name
        mkdir "$group" 2>/dev/null && echo $((256 << 20)) >"$group/memory.limit_in_bytes"
    else
        return 1
    fi 2>/dev/null
}

# Turns this shell, a child, into the command in the control group.
in_group() {
    echo "$BASHPID" >"$group/cgroup.procs" && exec "$@"
}

memory_limit() {
    local about="the memory limit of a control group" eater
    if ! make_group; then
        skip "$about: this user cannot create one with a memory limit"
        return
    fi
    # More than the limit is refused before anything is written.
    mkdir "$root/memory"
    cp scene.toml "$root/memory"
    cd "$root/memory"
    code=0
    (in_group "$PHOTOSPHERE" render scene.toml --size 4000x4000 -o a.exr --checkpoint a.part \
        --quiet 2>"$root/refusal") || code=$?
    cat "$root/refusal" >>"$root/messages"
    ((code == 3)) || fail "$about: exit code $code instead of 3"
    grep -q 'control group' "$root/refusal" || fail "$about: the refusal does not name it"
    [[ ! -e a.exr && ! -e a.part ]] || fail "$about: the refused render wrote files"
    # Within the limit, but something else in the group takes the memory, and the system kills both.
    render_half "$root/memory"
    in_group "$PHOTOSPHERE" resume a.part --quiet 2>>"$root/messages" &
    process=$!
    sleep 0.05
    # Else it might end too soon.
    kill -s STOP "$process"
    echo 1000 >"/proc/$process/oom_score_adj"
    in_group tail /dev/zero &>/dev/null &
    eater=$!
    await
    wait "$eater" 2>/dev/null || true
    ((code == 137)) || fail "$about: exit code $code instead of that of a killed process"
    (($(kept a.part) >= half)) || fail "$about: the checkpoint is damaged"
    finish a.part "$about: a refusal, and a kill when memory runs out"
    cd "$root/work"
    rmdir "$group"
    group=
}

check_usage
find_program
root=$(mktemp -d "${TMPDIR:-/tmp}/photosphere-torture.XXXXXX")
trap clean_up EXIT
# Bash reports killed children wherever it notices them.
exec 2>>"$root/messages"
trap 'fail "line $LINENO fails"' ERR
mkdir "$root/work"
cd "$root/work"
RANDOM=$seed
declare -a all=()
cp "$repository/tests/cli/kill.toml" scene.toml
render_whole
SECONDS=0
torture
echo "ok: $rounds rounds in $SECONDS s, seed $seed: $finished renders ended with the undisturbed bytes"
for name in "${!sent[@]}"; do printf '    %4d %s\n' "${sent[$name]}" "$name"; done | sort -rn
echo "    $at_work rounds ended in the midst of a render"
full_disk
file_size_limit
memory_limit
