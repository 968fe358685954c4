#!/usr/bin/env bash
# Fuzzes the readers and the renderer: each target in turn for TIME of a processor (such as 90s, 10m or
# 2h, whatever else the machine does), or only the named ones. Builds the targets first, which takes
# about ten minutes once.
#
#     scripts/fuzz.sh 10m
#     scripts/fuzz.sh 1h render scene
#     FUZZ_RUNS=10000000 scripts/fuzz.sh 20m     a target also ends after so many executions
#
# Inputs that reach new code are kept in fuzz/corpus; findings are in fuzz/artifacts. Exits with 1 if
# there is a finding.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/toolchain.sh
. scripts/toolchain.sh

usage() {
    echo "usage: scripts/fuzz.sh TIME [TARGET...]; the targets are:" "${all[@]}" >&2
    exit 2
}

# The seconds of a time with a unit.
seconds() {
    local number=${1%[smh]}
    [[ $number =~ ^[0-9]+$ ]] || usage
    case $1 in
        *m) echo $((number * 60)) ;;
        *h) echo $((number * 3600)) ;;
        *) echo "$number" ;;
    esac
}

# Finds or installs what the build needs, and builds. The flags of the sanitizer are unstable, so
# that the stable compiler must be told to take them.
build() {
    find_rust || { echo "Rust $rust_minimum or newer is missing: scripts/setup.sh" >&2; exit 2; }
    command -v c++ >/dev/null || { echo 'a C++ compiler is missing: apt-get install g++' >&2; exit 2; }
    PATH=$PATH:$(dirname "$cargo"):${CARGO_HOME:-$HOME/.cargo}/bin
    command -v cargo-fuzz >/dev/null || "$cargo" install --locked --quiet cargo-fuzz
    RUSTC_BOOTSTRAP=1 "$cargo" fuzz build -O --debug-assertions
}

# The longest input of a target, in bytes: what its reader needs to be reached everywhere.
max_length() {
    case $1 in
        checkpoint*) echo 8192 ;;
        arguments | overrides | table_rows | viewer) echo 1024 ;;
        *) echo 4096 ;;
    esac
}

# Runs the target $1. Bounds: time and memory of each input, its length, and rayon's threads. Inputs
# that take little time are mutated more often.
fuzz() {
    local name=$1 corpora=("fuzz/corpus/$1" "fuzz/seeds/$1")
    mkdir -p "fuzz/corpus/$name" "fuzz/artifacts/$name"
    case $name in scene | render) corpora+=(scenes) ;; esac
    run_target "$name" "${corpora[@]}" >"$logs/$name.log" 2>&1 &
    interrupt_after_time $! "$logs/$name.log"
    local status=0
    wait $! || status=$?
    # What libFuzzer exits with when it is told to end: its time is up, and nothing was found.
    ((status == 0 || status == 72))
}

# Ends the process $1 when it has used its time of a processor, of which the log $2 is told.
interrupt_after_time() {
    local stat used=0 ticks
    ticks=$(getconf CLK_TCK)
    while stat=$(cat "/proc/$1/stat" 2>/dev/null); do
        # Fields are counted behind the name, which may hold spaces: user and system time.
        read -ra stat <<<"${stat##*) }"
        [[ ${stat[0]} != Z ]] || break
        used=$(((stat[11] + stat[12]) / ticks))
        ((used < time)) || { kill -TERM "$1"; break; }
        sleep 1
    done
    echo "processor seconds: $used" >>"$2"
}

run_target() {
    local name=$1
    export RAYON_NUM_THREADS=1 TMPDIR=$temporary \
        ASAN_OPTIONS=detect_odr_violation=0:detect_leaks=0:allocator_may_return_null=1:quarantine_size_mb=32
    exec "$programs/$name" "${@:2}" -runs="${FUZZ_RUNS:--1}" \
        -print_final_stats=1 \
        -artifact_prefix="fuzz/artifacts/$name/" -max_len="$(max_length "$name")" \
        -timeout=60 -rss_limit_mb=2048 -print_funcs=0 -entropic_scale_per_exec_time=1
}

# One row for the log $2 of the target $1: executions, minutes of a processor, coverage, and when that
# last grew.
summary() {
    awk -v name="$1" '
        /^#[0-9]+/ {
            run = substr($1, 2) + 0
            for (i = 2; i < NF; i++) if ($i == "cov:" && $(i + 1) + 0 > coverage) {
                coverage = $(i + 1) + 0; grew = run
            }
        }
        /stat::number_of_executed_units/ { run = $2 }
        /Test unit written to/ { findings++ }
        /^processor seconds: / { minutes = $3 / 60 }
        END {
            printf "%-22s %9d runs %5.1f min %6d edges, the last new one after %3.0f %%  %d findings\n",
                name, run, minutes, coverage, 100 * grew / (run ? run : 1), findings
        }' "$2"
}

mapfile -t all < <(sed -n 's/^name = "\(.*\)"$/\1/p' fuzz/Cargo.toml | grep -v '^photosphere')
(($# > 0)) || usage
time=$(seconds "$1")
targets=("${@:2}")
((${#targets[@]} > 0)) || targets=("${all[@]}")
for name in "${targets[@]}"; do
    [[ " ${all[*]} " == *" $name "* ]] || usage
done

build
programs=fuzz/target/$("${RUSTC:-rustc}" -vV | sed -n 's/^host: //p')/release
# In memory where possible: each input is a file or two.
temporary=$(mktemp -d -p "$([[ -w /dev/shm ]] && echo /dev/shm || echo "${TMPDIR:-/tmp}")")
logs=$(mktemp -d)
trap 'rm -rf "$temporary"' EXIT
failed=0
for name in "${targets[@]}"; do
    fuzz "$name" || { failed=1; tail -n 40 "$logs/$name.log"; }
    summary "$name" "$logs/$name.log"
done
echo "logs: $logs"
exit "$failed"
