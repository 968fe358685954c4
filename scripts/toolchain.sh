# shellcheck shell=bash
# Where the repository is, and which Rust builds it. Sourced by the other scripts, never run.
#
# After `find_rust`, "$cargo" is a cargo that is new enough and RUSTC, RUSTDOC belong to it.

# With an empty environment, bash has a PATH that the programs it starts do not see.
export PATH

repository=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
rust_minimum=$(sed -n 's/^rust-version *= *"\(.*\)"/\1/p' "$repository/Cargo.toml")

# Whether the version $1, as a program or a package writes it (1.85.0, 1:1.85.0+dfsg3-1), is at
# least $2 (1.85). Patch levels do not count.
at_least() {
    local pattern='^([0-9]+:)?([0-9]+)\.([0-9]+)' major minor
    [[ $2 =~ $pattern ]] || return 1
    major=${BASH_REMATCH[2]} minor=${BASH_REMATCH[3]}
    [[ $1 =~ $pattern ]] || return 1
    ((BASH_REMATCH[2] > major || (BASH_REMATCH[2] == major && BASH_REMATCH[3] >= minor)))
}

# Whether the program $1 is there, runs, and is new enough.
is_new_enough() {
    local version
    read -r _ version _ < <("$1" --version 2>/dev/null) && at_least "$version" "$rust_minimum"
}

# Takes the cargo $1 with the rustc $2 and rustdoc $3 if both compiler and cargo are new enough.
take_rust() {
    is_new_enough "$1" && is_new_enough "$2" || return 1
    # shellcheck disable=SC2034  # for the scripts that source this one
    cargo=$1
    export RUSTC=$2 RUSTDOC=$3
}

# Finds a Rust that is new enough: the one in PATH, then rustup's, then the newest versioned one
# (cargo-1.85 with rustc-1.85, as Ubuntu names them). An old cargo that comes first in PATH is
# passed over.
find_rust() {
    local home=~ rustup version
    take_rust cargo "${RUSTC:-rustc}" "${RUSTDOC:-rustdoc}" && return
    rustup=${CARGO_HOME:-$home/.cargo}/bin
    take_rust "$rustup/cargo" "$rustup/rustc" "$rustup/rustdoc" && return
    for version in $(compgen -c cargo-1. | sed 's/^cargo-//' | sort -Vru); do
        take_rust "cargo-$version" "rustc-$version" "rustdoc-$version" && return
    done
    return 1
}

# Exports PHOTOSPHERE, the path of the program: what the caller's environment names, or else a fresh
# build.
find_program() {
    if [[ -z ${PHOTOSPHERE:-} ]]; then
        find_rust
        "$cargo" build --release --quiet --manifest-path "$repository/Cargo.toml"
        PHOTOSPHERE=${CARGO_TARGET_DIR:-$repository/target}/release/photosphere
    fi
    PHOTOSPHERE=$(realpath "$PHOTOSPHERE")
    export PHOTOSPHERE
}
