#!/usr/bin/env bash
# Installs what building photosphere needs; does nothing, quickly, where nothing is missing.
#
#   scripts/setup.sh [PROGRAM ...]
#
# PROGRAM: further programs that are good to have, named as their packages are (valgrind). Building
# works without them, so failing to get one is no error.
#
# Needed are a C compiler, a Rust as new as Cargo.toml asks for, libclang (bindgen reads Embree's
# headers with it) and Embree 4 or 3. On Debian and Ubuntu they come from apt; elsewhere this says
# what to install. All output goes to standard error, which leaves the other stream to the program
# that `scripts/run` starts.
set -euo pipefail
exec >&2
# shellcheck source=scripts/toolchain.sh
. "$(dirname "${BASH_SOURCE[0]}")/toolchain.sh"

# ---- What is there ----

# Whether the C compiler finds the header $1, given the further options.
finds_header() {
    local compiler
    read -ra compiler <<<"${CC:-cc}"
    "${compiler[@]}" "${@:2}" -E -x c -o /dev/null - <<<"#include <$1>" 2>/dev/null
}

has_c_compiler() {
    finds_header stdlib.h
}

has_embree() {
    local place=()
    [[ -z ${EMBREE_DIR:-} ]] || place=(-I "$EMBREE_DIR/include")
    finds_header embree4/rtcore.h "${place[@]}" || finds_header embree3/rtcore.h "${place[@]}"
}

# The library and the compiler's own headers (stddef.h), in the places where bindgen looks. The
# library libclang-cpp is another one.
has_libclang() {
    [[ -z ${LIBCLANG_PATH:-} ]] || return 0
    compgen -G '/usr/lib*/llvm*/lib*/libclang[.-][!c]*' ||
        compgen -G '/usr/lib*/libclang[.-][!c]*' ||
        compgen -G '/usr/lib/*-linux-gnu*/libclang[.-][!c]*' ||
        compgen -G '/usr/local/lib*/libclang[.-][!c]*' || return 1
    compgen -G '/usr/lib*/llvm*/lib*/clang/*/include/stddef.h' ||
        compgen -G '/usr/lib*/clang/*/include/stddef.h' ||
        compgen -G '/usr/local/lib*/clang/*/include/stddef.h'
} >/dev/null

# Sets `missing` to what is needed, and `wanted` to the PROGRAMs, that are not there.
look() {
    local program
    missing=() wanted=()
    has_c_compiler || missing+=(c-compiler)
    find_rust || missing+=(rust)
    has_libclang || missing+=(libclang)
    has_embree || missing+=(embree)
    for program in "$@"; do
        command -v "$program" >/dev/null || wanted+=("$program")
    done
}

# ---- What apt can give ----

# The packages of a Rust that is new enough: the usual ones, those for web browsers (Debian 12), or
# the newest versioned ones (Ubuntu). Fails where apt knows of none.
rust_packages() {
    local rustc others
    others=$(apt-cache pkgnames rustc-1. | grep -Ex 'rustc-1\.[0-9]+' | sort -Vr) || true
    for rustc in rustc rustc-web $others; do
        if has_candidate "$rustc" && has_candidate "${rustc/rustc/cargo}"; then
            # cargo downloads over TLS, and only recommends the certificates.
            echo "$rustc ${rustc/rustc/cargo} ca-certificates"
            return
        fi
    done
    return 1
}

# Whether apt would install a version of the package $1 that is new enough.
has_candidate() {
    local version
    version=$(LC_ALL=C apt-cache policy "$1" 2>/dev/null | sed -n 's/^ *Candidate: //p')
    at_least "$version" "$rust_minimum"
}

# Prints the packages for all that is missing, as far as apt has them.
packages() {
    local thing
    for thing in "${missing[@]}"; do
        case $thing in
        c-compiler) echo gcc libc6-dev ;;
        rust) rust_packages || true ;;
        libclang) echo libclang-dev ;;
        embree) echo libembree-dev ;;
        esac
    done
    echo "${wanted[@]}"
}

as_root() {
    if ((EUID == 0)); then "$@"; else sudo "$@"; fi
}

# apt-get without questions, patient while a fresh machine updates itself in the background. dpkg
# insists on the sbin folders, which a user's PATH may lack.
apt_get() {
    as_root env PATH="$PATH:/usr/local/sbin:/usr/sbin:/sbin" DEBIAN_FRONTEND=noninteractive \
        apt-get -qy -o DPkg::Lock::Timeout=120 "$@" </dev/null
}

install_with_apt() {
    local chosen all=("${missing[@]}" "${wanted[@]}")
    if ((EUID != 0)) && ! command -v sudo >/dev/null; then
        ((${#missing[@]} > 0)) || return 0
        read -rd '' -a chosen < <(packages) || true
        ((${#chosen[@]} == 0)) ||
            printf 'Run this as root, then try again:\n  apt-get update && apt-get install -y %s\n' "${chosen[*]}"
        return
    fi
    echo "Installing what is missing: ${all[*]}"
    apt_get update || echo "The package lists could not be renewed; going on with those there are."
    read -rd '' -a chosen < <(packages) || true
    ((${#chosen[@]} == 0)) || apt_get install --no-install-recommends "${chosen[@]}" ||
        printf 'apt-get could not install: %s\n' "${chosen[*]}"
}

# ---- What to tell ----

explain_rustup() {
    echo "No package of this system is new enough. Get one with rustup, then try again:"
    echo "  curl --proto '=https' --tlsv1.2 -sSf https://sh.rustup.rs | sh -s -- -y"
}

explain_missing() {
    local thing
    for thing in "${missing[@]}"; do
        case $thing in
        c-compiler) echo "missing: a C compiler with its standard headers (gcc or clang)" ;;
        rust)
            echo "missing: Rust $rust_minimum or newer"
            rust_packages >/dev/null 2>&1 || explain_rustup
            ;;
        libclang) echo "missing: libclang with its headers (Debian: libclang-dev, Fedora: clang-devel, Arch: clang, Homebrew: llvm), or LIBCLANG_PATH pointing to it" ;;
        embree) echo "missing: Embree 4 or 3 with its headers (Debian: libembree-dev, Fedora: embree-devel, Arch and Homebrew: embree), or EMBREE_DIR pointing to it" ;;
        esac
    done
    if [[ " ${missing[*]} " =~ ' '(libclang|embree)' ' ]]; then
        echo "cargo build --release works without Embree and libclang, and leaves out what needs them."
    fi
}

look "$@"
((${#missing[@]} + ${#wanted[@]} > 0)) || exit 0
if command -v apt-get >/dev/null; then
    install_with_apt
    look "$@"
fi
((${#wanted[@]} == 0)) || echo "Going on without: ${wanted[*]}"
((${#missing[@]} > 0)) || exit 0
explain_missing
exit 1
