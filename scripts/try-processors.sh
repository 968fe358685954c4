#!/usr/bin/env bash
# Renders the picture suite (all scenes of the repository, small, with every intersector) on emulated
# processors with fewer instructions than this one, and compares the bytes of the files with those of
# this processor. `tests/instruction_sets.rs` does the same in CI without an emulator, and so without
# the system's libraries and Embree choosing their code for another processor.
#
#   scripts/try-processors.sh [PROCESSOR ...]     Nehalem (SSE4.2) and Haswell (AVX2) by default
#
# `qemu-x86_64-static -cpu help` lists the processors. The emulator is Debian's qemu-user-static, which
# is installed where it is missing. The program is the one that PHOTOSPHERE names; where it names none,
# it is built. Takes about 5 minutes of processor time.
set -euo pipefail

# shellcheck source=scripts/toolchain.sh
. "$(dirname "${BASH_SOURCE[0]}")/toolchain.sh"
emulator=qemu-x86_64-static
processors=("$@")
((${#processors[@]} > 0)) || processors=(Nehalem Haswell)
intersectors=(native brute-force embree embree-user)
options=(--size 24x18 --threads 1 --no-run-figures --layers "direct,indirect,albedo,normal,depth")

install() {
    ! command -v "$emulator" >/dev/null || return 0
    command -v apt-get >/dev/null || { echo "Please install $emulator."; exit 2; }
    echo "Installing qemu-user-static"
    apt-get update -qq
    DEBIAN_FRONTEND=noninteractive apt-get install -qq --no-install-recommends qemu-user-static >/dev/null
}

# A build without Embree has two intersectors.
find_intersectors() {
    "$PHOTOSPHERE" doctor | grep -q 'embree .*works' || intersectors=(native brute-force)
}

# Runs the program on processor $1, or on this one if that is `host`.
program() {
    if [[ $1 == host ]]; then "$PHOTOSPHERE" "${@:2}"; else "$emulator" -cpu "$1" "$PHOTOSPHERE" "${@:2}"; fi
}

# Renders scene $2 on processor $1 with every intersector.
render() {
    local name=${2#"$repository/scenes/"} intersector samples=(--spp 4)
    # The paper's own number of samples takes the place of the other.
    ! grep -q '^samples = ' "$2" || samples=(--set render.paper.samples=1)
    for intersector in "${intersectors[@]}"; do
        program "$1" render "$2" "${options[@]}" "${samples[@]}" --accel "$intersector" \
            -o "$root/$1/${name//\//-}.$intersector.exr" 2>"$root/$1/${name//\//-}.$intersector.log" ||
            { echo "FAILED: $2 with $intersector on $1"; tail -n 5 "$root/$1/${name//\//-}.$intersector.log"; return 1; }
    done
}

# Renders the suite on processor $1, a scene for each core at a time.
render_suite() {
    local scene running=() failed=0
    mkdir "$root/$1"
    for scene in "$repository"/scenes/{,paper/,verify/}*.toml; do
        render "$1" "$scene" &
        running+=($!)
        if ((${#running[@]} >= $(nproc))); then
            wait "${running[0]}" || failed=1
            running=("${running[@]:1}")
        fi
    done
    for scene in "${running[@]}"; do wait "$scene" || failed=1; done
    ((failed == 0)) || exit 1
}

# Compares the pictures of processor $1 with this one's.
check() {
    local picture count=0
    for picture in "$root"/host/*.exr; do
        cmp "$picture" "$root/$1/$(basename "$picture")" || { echo "FAILED on $1"; exit 1; }
        count=$((count + 1))
    done
    ((count > 0)) || exit 1
    echo "ok: $1: $count pictures have equal bytes; the kernels are $(kernels "$1"), here $(kernels host)"
}

# Prints the variants of the native kernel that processor $1 took.
kernels() {
    sed -n 's/^intersector native (as asked for; \([^;)]*\).*/\1/p' "$root/$1"/*.native.log | sort -u | paste -sd ' '
}

install
find_program
find_intersectors
root=$(mktemp -d "${TMPDIR:-/tmp}/photosphere-processors.XXXXXX")
trap 'rm -rf --one-file-system "$root"' EXIT
SECONDS=0
render_suite host
for processor in "${processors[@]}"; do
    render_suite "$processor"
    check "$processor"
done
echo "in $SECONDS s"
