#!/usr/bin/env bash
# Installs what is in target/packages and target/wheels in bare roots, as users do, and runs
# `photosphere verify --quick` there.
#
#   scripts/try-packages.sh [SUITE[:KIND] ...]
#
# SUITE: by default bullseye bookworm trixie sid; sid is what the next Ubuntu is made of. KIND:
# tarball, deb or wheel; by default each of them that is there for the suite.
#
# Needs what scripts/debian-root.sh says. A .deb is tried on the Debian that it is for, and the wheel
# where there is Python 3.11 or later; the summary says what was not there to be tried.
set -euo pipefail
# shellcheck source=scripts/debian-root.sh
. "$(dirname "${BASH_SOURCE[0]}")/debian-root.sh"

apt='DEBIAN_FRONTEND=noninteractive apt-get -qqy --no-install-recommends'
scene=scenes/paper/fig2.toml
skipped=()

# The file of the pattern $2 in the root's /photosphere, copied from the folder $1; nothing if there
# is none.
bring() {
    local file
    file=$(cd "$repository/target/$1" 2>/dev/null && compgen -G "$2" | head -n 1) || return 0
    cp "$repository/target/$1/$file" "$root/photosphere/"
    echo "$file"
}

# Remembers that $1 is not there to be tried.
skip() {
    skipped+=("$(printf '%-9s %s' "$suite" "not tried: $1")")
}

# The program at work, if it could be installed.
try_program() {
    in_root 'command -v photosphere >/dev/null' || return 0
    try 'photosphere --version && photosphere doctor'
    try "photosphere render $scene --size 320x213 -o fig2.png && photosphere reproduce fig2.png"
    try "photosphere crosscheck $scene"
    try 'photosphere verify --quick'
}

begin() {
    new_root "$1"
    mkdir -p "$root/photosphere/$(dirname "$scene")"
    cp "$repository/$scene" "$root/photosphere/$scene"
}

try_tarball() {
    local tarball
    begin "$1"
    tarball=$(bring packages 'photosphere-*-linux.tar.gz')
    if [[ -n $tarball ]]; then
        try "tar -C /usr/local --strip-components=1 -xzf $tarball"
        try_program
    else
        skip 'there is no tarball; scripts/package.sh tarball makes it'
    fi
    remove_root
}

try_deb() {
    local release deb
    begin "$1"
    # shellcheck disable=SC2016  # for the shell in the root
    release=$(in_root '. /etc/os-release && echo "$ID${VERSION_ID:-$VERSION_CODENAME}"')
    deb=$(bring packages "photosphere_*~${release}_*.deb")
    if [[ -n $deb ]]; then
        # dpkg unpacks it and says what it lacks, which apt installs.
        try "export PATH; apt-get -qq update && { dpkg -i $deb || $apt -f install; }"
        try 'export PATH; dpkg --verify photosphere && ! dpkg --audit | grep .'
        try_program
        try 'photosphere doctor | grep "compiled against"'
    else
        skip "there is no .deb for $release; scripts/package.sh deb $1 makes it"
    fi
    remove_root
}

try_wheel() {
    local wheel
    begin "$1"
    wheel=$(bring wheels 'photosphere-*.whl')
    if [[ $suite == bullseye ]]; then
        skip 'the wheel needs Python 3.11'
    elif [[ -n $wheel ]]; then
        try "export PATH; apt-get -qq update && $apt install python3-venv ca-certificates && python3 -m venv /venv"
        try "/venv/bin/pip --quiet install ./$wheel && ln -s /venv/bin/photosphere /usr/bin"
        try_program
    else
        skip 'there is no wheel; scripts/run wheel makes it'
    fi
    remove_root
}

can_make_roots || exit 1
(($# > 0)) || set -- bullseye bookworm trixie sid
for what in "$@"; do
    case $what in
    *:tarball | *:deb | *:wheel) "try_${what#*:}" "${what%:*}" ;;
    *)
        for kind in tarball deb wheel; do "try_$kind" "$what"; done
        ;;
    esac
done
((${#summary[@]} > 0)) || failed=1
summary+=("${skipped[@]}")
print_summary
