#!/usr/bin/env bash
# Proves the README's two commands on a bare Debian: a fresh debootstrap root, a clean clone of the
# current commit, an empty environment and an empty standard input.
#
#   scripts/try-debian.sh bookworm     Embree 3, Rust from the rustc-web package
#   scripts/try-debian.sh trixie       Embree 4, Debian's own Rust
#
# Needs root, debootstrap and git. The bare root is kept as an archive in PHOTOSPHERE_CACHE (by
# default ~/.cache/photosphere); every trial unpacks a new one and removes it at the end. What this
# machine needs to reach the network (mirror, proxies, certificates of its own, cargo's settings)
# is passed on. The picture is left in the cache.
set -euo pipefail

repository=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
home=~
cache=${PHOTOSPHERE_CACHE:-${XDG_CACHE_HOME:-$home/.cache}/photosphere}
suite=${1:-}

check_usage() {
    local program
    [[ $suite =~ ^[a-z]+$ ]] || { sed -n '5,6s/^# *//p' "$0"; exit 2; }
    ((EUID == 0)) || { echo "A root must be made by root."; exit 2; }
    for program in debootstrap git; do
        command -v "$program" >/dev/null || { echo "Please install $program."; exit 2; }
    done
}

# ---- The root ----

# The Debian mirror in this machine's own sources, if it has one; debootstrap knows another.
mirror() {
    cat /etc/apt/sources.list /etc/apt/sources.list.d/*.{list,sources} 2>/dev/null |
        grep -v '^ *#' | grep -oE '[a-z+]+://[^ ]+/debian/?( |$)' | head -n 1 || true
}

make_base() {
    local new=$cache/$suite.new
    rm -rf --one-file-system "$new"
    # shellcheck disable=SC2046  # no mirror is no argument
    debootstrap --variant=minbase "$suite" "$new" $(mirror)
    # A fresh machine has no package lists.
    rm -rf "$new"/var/lib/apt/lists/* "$new"/var/cache/apt/archives/*.deb
    tar -C "$new" -cf "$cache/$suite.tar.part" .
    mv "$cache/$suite.tar.part" "$cache/$suite.tar"
    rm -rf --one-file-system "$new"
}

# Lets the root reach the network as this machine does.
pass_network_on() {
    local file
    for file in /etc/resolv.conf /etc/hosts; do
        [[ ! -e $file ]] || cp -L "$file" "$root$file"
    done
    apt-config dump 2>/dev/null | grep -E '^Acquire::(http|https|ftp|Check-[A-Za-z-]+|Retries)[: ]' \
        >"$root/etc/apt/apt.conf.d/99host" || true
    # The package ca-certificates takes these in when it is installed.
    if compgen -G '/usr/local/share/ca-certificates/*.crt' >/dev/null; then
        mkdir -p "$root/usr/local/share/ca-certificates"
        cp /usr/local/share/ca-certificates/*.crt "$root/usr/local/share/ca-certificates/"
    fi
    for file in config config.toml; do
        if [[ -e ${CARGO_HOME:-$home/.cargo}/$file ]]; then
            mkdir -p "$root/root/.cargo"
            cp "${CARGO_HOME:-$home/.cargo}/$file" "$root/root/.cargo/"
        fi
    done
}

# The variables that say how to reach the network, as NAME=VALUE; no others get in.
network_variables() {
    env | grep -iE '^(https?_proxy|no_proxy|all_proxy|CARGO_(HTTP|NET|SOURCE)_[A-Z_]+)=' || true
}

# ---- The trial ----

# Runs a shell command in the clone, where a user would be. The mounts belong to a namespace and end
# with it; where that is not permitted, the root must do with what debootstrap made.
in_root() {
    local variables
    mapfile -t variables < <(network_variables)
    local enter=(chroot "$root" /usr/bin/env -i "${variables[@]}" /bin/bash -c "cd /photosphere && $1")
    if unshare --mount true 2>/dev/null; then
        # shellcheck disable=SC2016  # for the inner shell
        unshare --mount bash -c 'mount -t proc proc "$0/proc"; mount --rbind /dev "$0/dev"; "$@"' \
            "$root" "${enter[@]}" </dev/null
    else
        "${enter[@]}" </dev/null
    fi
}

# Runs one command, shows how it went, and remembers a failure.
try() {
    local began=$SECONDS outcome=ok
    printf '\n== %s: %s\n' "$suite" "$1"
    in_root "$1" || { outcome="FAILED ($?)"; failed=1; }
    summary+=("$(printf '%-60s %5d s  %s' "$1" $((SECONDS - began)) "$outcome")")
}

keep_picture() {
    local picture=$cache/fig2-$suite.png
    if [[ -s $root/photosphere/fig2.png ]]; then
        cp "$root/photosphere/fig2.png" "$picture"
        summary+=("the picture: $picture")
    else
        summary+=("NO PICTURE")
        failed=1
    fi
}

show_versions() {
    # shellcheck disable=SC2016  # for the shell in the root
    in_root '. scripts/toolchain.sh && find_rust && "$cargo" --version && "$RUSTC" --version
             dpkg-query -W -f "\${Package} \${Version}\n" | grep -E "^(libembree|libclang-dev|gcc|rustc|cargo)"' || true
}

check_usage
mkdir -p "$cache"
[[ -e $cache/$suite.tar ]] || make_base
root=$(mktemp -d "${TMPDIR:-/var/tmp}/photosphere-$suite.XXXXXX")
trap 'rm -rf --one-file-system "$root"' EXIT
chmod 755 "$root"
tar -C "$root" -xf "$cache/$suite.tar"
pass_network_on
git clone --quiet --no-hardlinks "$repository" "$root/photosphere"

failed=0 summary=()
try 'scripts/run render scenes/paper/fig2.toml -o fig2.png'
keep_picture
try 'scripts/run test'
printf '\n== %s, commit %s, with:\n' "$suite" "$(git -C "$root/photosphere" rev-parse --short HEAD)"
show_versions
printf '%s\n' "${summary[@]}"
exit "$failed"
