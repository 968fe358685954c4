#!/usr/bin/env bash
# Proves the README's two commands on a bare Debian: a fresh debootstrap root, a clean clone of the
# current commit, an empty environment and an empty standard input.
#
#   scripts/try-debian.sh bookworm     Embree 3, Rust from the rustc-web package
#   scripts/try-debian.sh trixie       Embree 4, Debian's own Rust
#
# Needs what scripts/debian-root.sh says. The picture is left in the cache.
set -euo pipefail

# shellcheck source=scripts/debian-root.sh
. "$(dirname "${BASH_SOURCE[0]}")/debian-root.sh"

[[ ${1:-} =~ ^[a-z]+$ ]] || { sed -n '5,6s/^# *//p' "$0"; exit 2; }
can_make_roots || exit 2

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

new_root "$1"
clone_into_root
try 'scripts/run render scenes/paper/fig2.toml -o fig2.png'
keep_picture
try 'scripts/run test'
printf '\n== %s, commit %s, with:\n' "$suite" "$(git -C "$root/photosphere" rev-parse --short HEAD)"
show_versions
print_summary
