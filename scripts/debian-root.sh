# shellcheck shell=bash
# Bare Debian roots to try things in. Sourced by the other scripts, never run.
#
# Needs root and debootstrap. The bare root of each suite is kept as an archive in PHOTOSPHERE_CACHE
# (by default ~/.cache/photosphere); `new_root` unpacks it anew, and the root goes when the script
# ends. What this machine needs to reach the network (mirror, proxies, certificates of its own,
# cargo's and pip's settings) is passed on.

# shellcheck source=scripts/toolchain.sh
. "$(dirname "${BASH_SOURCE[0]}")/toolchain.sh"

home=~
cache=${PHOTOSPHERE_CACHE:-${XDG_CACHE_HOME:-$home/.cache}/photosphere}
failed=0 summary=() shared=()

# Whether this machine can make roots; says why not.
can_make_roots() {
    local program
    ((EUID == 0)) || { echo "A root must be made by root."; return 1; }
    for program in debootstrap git; do
        command -v "$program" >/dev/null || { echo "Please install $program."; return 1; }
    done
}

# The Debian mirror in this machine's own sources, if it has one; debootstrap knows another.
mirror() {
    cat /etc/apt/sources.list /etc/apt/sources.list.d/*.{list,sources} 2>/dev/null |
        grep -v '^ *#' | grep -oE '[a-z+]+://[^ ]+/debian/?( |$)' | head -n 1 || true
}

make_base() {
    local new=$cache/$suite.new
    mkdir -p "$cache"
    rm -rf --one-file-system "$new"
    # shellcheck disable=SC2046  # no mirror is no argument
    debootstrap --variant=minbase "$suite" "$new" $(mirror)
    # A fresh machine has no package lists.
    rm -rf "$new"/var/lib/apt/lists/* "$new"/var/cache/apt/archives/*.deb
    tar -C "$new" -cf "$cache/$suite.tar.part" .
    mv "$cache/$suite.tar.part" "$cache/$suite.tar"
    rm -rf --one-file-system "$new"
}

# Makes a root of the suite $1 and sets `suite` and `root`. Its home is /photosphere.
new_root() {
    suite=$1
    [[ -e $cache/$suite.tar ]] || make_base
    root=$(mktemp -d "${TMPDIR:-/var/tmp}/photosphere-$suite.XXXXXX")
    trap remove_root EXIT
    chmod 755 "$root"
    tar -C "$root" -xf "$cache/$suite.tar"
    pass_network_on
    mkdir "$root/photosphere"
}

remove_root() {
    rm -rf --one-file-system "$root"
}

# Puts a clean clone of the current commit into the root's /photosphere.
clone_into_root() {
    git clone --quiet --no-hardlinks "$repository" "$root/photosphere"
}

# Lets the folder $1 of this machine be seen as $2 in the root.
share() {
    mkdir -p "$root$2"
    shared+=("$1" "$root$2")
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
    [[ ! -e /etc/pip.conf ]] || cp -L /etc/pip.conf "$root/etc/pip.conf"
}

# The variables that say how to reach the network and how many compilers may run, as NAME=VALUE; no
# others get in.
network_variables() {
    local cargo_variables='CARGO_((HTTP|NET|SOURCE)_[A-Z_]+|BUILD_JOBS)'
    env | grep -iE "^(https?_proxy|no_proxy|all_proxy|$cargo_variables)=" || true
}

# Mounts what a root needs, and folders as SOURCE TARGET ..., before the command after `--`.
# shellcheck disable=SC2016  # for the inner shell
mount_and_run='
    mount -t proc proc "$0/proc"
    mount --rbind /dev "$0/dev"
    while [[ $1 != -- ]]; do mount --bind "$1" "$2" || exit; shift 2; done
    shift
    exec "$@"'

# Runs a shell command in /photosphere, where a user would be. The mounts belong to a namespace and
# end with it; where that is not permitted, the root must do with what debootstrap made.
in_root() {
    local variables
    mapfile -t variables < <(network_variables)
    local enter=(chroot "$root" /usr/bin/env -i "${variables[@]}" /bin/bash -c "cd /photosphere && $1")
    if unshare --mount true 2>/dev/null; then
        unshare --mount bash -c "$mount_and_run" "$root" "${shared[@]}" -- "${enter[@]}" </dev/null
    else
        ((${#shared[@]} == 0)) || { echo "This needs the right to mount."; return 1; }
        "${enter[@]}" </dev/null
    fi
}

# Runs the command $1 in the root, shows how it went, and remembers a failure in `failed` and a line
# in `summary`.
try() {
    local began=$SECONDS outcome=ok
    printf '\n== %s: %s\n' "$suite" "$1"
    in_root "$1" || { outcome="FAILED ($?)"; failed=1; }
    summary+=("$(printf '%-9s %-62s %5d s  %s' "$suite" "$1" $((SECONDS - began)) "$outcome")")
}

# Prints how the commands went, and fails if one did.
print_summary() {
    printf '\n== Summary\n'
    printf '%s\n' "${summary[@]}"
    return "$failed"
}
