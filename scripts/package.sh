#!/usr/bin/env bash
# Makes what is shipped, in target/packages.
#
#   scripts/package.sh tarball [PROFILE]
#       the program without Embree, for every Linux with glibc 2.28; its debug symbols; the notes of the
#       release
#   scripts/package.sh deb [SUITE]
#       a package for this Debian or Ubuntu, with its Embree; with SUITE (bookworm, trixie) in a fresh
#       root of that Debian, by this machine's Rust, since Debian's is older than AVX-512
#   scripts/package.sh crate
#       the crate, and a build of what is in it
#   scripts/package.sh dependencies
#       whether deny.toml allows all that is compiled in: needs cargo-deny; without the database of
#       advisories, which it downloads, it says so and checks the rest
#   scripts/package.sh check PROGRAM
#       whether PROGRAM needs an old glibc alone
#   scripts/package.sh install PROGRAM PREFIX
#       PROGRAM, its manual and completions below PREFIX
#
# PROFILE is a profile of Cargo.toml, by default `ship`. All but the crate are built for the
# processor of this machine; vector instructions are chosen when the program starts. SUITE needs what
# scripts/debian-root.sh says.
set -euo pipefail
# shellcheck source=scripts/toolchain.sh
. "$(dirname "${BASH_SOURCE[0]}")/toolchain.sh"
cd "$repository"

packages=target/packages
version=$(sed -n '0,/^version = /s/^version = "\(.*\)"/\1/p' Cargo.toml)
newest_glibc=2.28 largest_tarball=10000000 largest_crate=5000000

complain() {
    echo "scripts/package.sh: $*" >&2
    exit 1
}

# The time of the commit, for packages that are equal whenever they are made.
epoch() {
    git log -1 --format=%ct
}

# ---- What every package holds ----

# Puts the program $1 with its pages, completions and licences below $2.
install_program() {
    local program=$1 prefix=$2 command shell
    install -D "$program" "$prefix/bin/photosphere"
    mkdir -p "$prefix"/share/{man/man1,doc/photosphere}
    "$program" man | gzip -9n >"$prefix/share/man/man1/photosphere.1.gz"
    for command in $(commands_of "$program"); do
        "$program" man "$command" | gzip -9n >"$prefix/share/man/man1/photosphere-$command.1.gz"
    done
    while read -r shell file; do
        mkdir -p "$prefix/share/$(dirname "$file")"
        "$program" completions "$shell" >"$prefix/share/$file"
    done <<END
bash bash-completion/completions/photosphere
fish fish/vendor_completions.d/photosphere.fish
zsh zsh/site-functions/_photosphere
END
    cp README.md CHANGELOG.md LICENSE-APACHE LICENSE-MIT "$prefix/share/doc/photosphere/"
    licenses_of_others >"$prefix/share/doc/photosphere/LICENSES-OF-DEPENDENCIES"
}

# The commands in the help of the program $1.
commands_of() {
    "$1" --help | sed -n '/^Commands:/,/^$/s/^  \([a-z]\+\) .*/\1/p' | grep -vx help
}

# The licence of every crate in the program, each text once, below the crates that come with it.
licenses_of_others() {
    local name license folder file sum
    declare -A crates=() files=()
    while IFS='|' read -r name license; do
        folder=$(crate_folder "$name")
        echo "$name: $license"
        for file in "$folder"/{LICEN[CS]E,COPYING,COPYRIGHT,NOTICE,license}*; do
            [[ -f $file ]] || continue
            sum=$(sha256sum <"$file" | cut -d ' ' -f 1)
            crates[$sum]+=" $name" files[$sum]=$file
        done
    done < <("$cargo" tree --locked --edges normal --prefix none --no-dedupe --no-default-features \
        --features cli --format '{p}|{l}' | grep -v '^photosphere ' | sed 's/ (proc-macro)//' | sort -u)
    for sum in $(printf '%s\n' "${!files[@]}" | sort); do
        printf '\n==== %s:%s\n\n' "$(basename "${files[$sum]}")" "${crates[$sum]}"
        cat "${files[$sum]}"
    done
    printf '\n==== The font DejaVu Sans\n\n'
    cat src/overlay/font/LICENSE
}

# The sources of a crate, named as in "glam v0.34.2".
crate_folder() {
    local home=~ folder
    folder=$(compgen -G "${CARGO_HOME:-$home/.cargo}/registry/src/*/${1/ v/-}" | head -n 1)
    [[ -d $folder ]] || complain "the sources of $1 are not in cargo's registry"
    echo "$folder"
}

# Prints the part of CHANGELOG.md about this version.
notes() {
    sed -n "/^## $version/,/^## /{/^## /!p}" CHANGELOG.md
}

# Moves the debug symbols of the program $1 into $2, where a backtrace of the program finds them if
# they lie beside it.
split_symbols() {
    objcopy --only-keep-debug "$1" "$2"
    objcopy --strip-all --add-gnu-debuglink="$2" "$1"
}

# Prints the size of the file $1, and fails if it has $2 bytes or more.
check_size() {
    local size
    size=$(stat -c %s "$1")
    echo "$1: $size bytes"
    ((size < $2)) || complain "$1 has $2 bytes or more"
}

# ---- Without Embree, for every Linux ----

# Fails if the program $1 needs a library besides glibc, or a newer glibc.
check_portable() {
    local needed glibc size
    needed=$(readelf -d "$1" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p')
    glibc=$(readelf -V "$1" | grep -oE 'GLIBC_[0-9.]+' | sort -Vu | tail -n 1)
    size=$(stat -c %s "$1")
    printf '%s: %s bytes; needs %s, up to %s\n' "$1" "$size" "${needed//$'\n'/ }" "$glibc"
    grep -qx 'libc\.so\.6' <<<"$needed" || complain "the program does not name the libc it needs"
    ! grep -vxE '(libc|libm|libdl|librt|libpthread|ld-linux-x86-64)\.so\.[0-9]' <<<"$needed" ||
        complain "the program needs more than glibc"
    [[ $(printf 'GLIBC_%s\n' "$newest_glibc" "${glibc#GLIBC_}" | sort -V | tail -n 1) == "GLIBC_$newest_glibc" ]] ||
        complain "the program needs $glibc, newer than $newest_glibc"
}

check_stripped() {
    local stripped=$packages/photosphere
    strip -o "$stripped" "$1"
    check_portable "$stripped"
    rm "$stripped"
}

make_tarball() {
    local profile=$1 name=photosphere-$version-x86_64-linux
    local program=${CARGO_TARGET_DIR:-target}/$profile/photosphere folder=$packages/$name
    [[ $(uname -sm) == 'Linux x86_64' ]] || complain "zig links for Linux on x86_64 only"
    scripts/setup-wheel.sh
    # For the program alone: another linker for all would compile everything once more.
    "$cargo" rustc --profile "$profile" --locked --no-default-features --features cli \
        --bin photosphere -- -C "linker=$repository/scripts/zig-linker.sh"
    rm -rf "$folder"
    cp "$program" "$packages/photosphere"
    split_symbols "$packages/photosphere" "$packages/$name.debug"
    check_portable "$packages/photosphere"
    install_program "$packages/photosphere" "$folder"
    rm "$packages/photosphere"
    tar -C "$packages" --sort=name --mtime="@$(epoch)" --owner=0 --group=0 --numeric-owner -c "$name" |
        gzip -9n >"$folder.tar.gz"
    notes >"$packages/NOTES.md"
    [[ -s $packages/NOTES.md ]] || complain "CHANGELOG.md says nothing about $version"
    check_size "$folder.tar.gz" "$largest_tarball"
}

# ---- For a Debian, with its Embree ----

make_deb() {
    scripts/setup.sh git
    find_rust
    "$cargo" build --profile ship --locked
    local release name stage=target/deb
    # shellcheck source=/dev/null
    release=$(. /etc/os-release && echo "$ID${VERSION_ID:-$VERSION_CODENAME}")
    name=photosphere_$version-1~${release}_$(dpkg --print-architecture).deb
    rm -rf "$stage"
    mkdir -p "$stage/DEBIAN"
    cp "${CARGO_TARGET_DIR:-target}/ship/photosphere" "$packages/photosphere"
    strip "$packages/photosphere"
    readelf -d "$packages/photosphere" | grep -q 'NEEDED.*libembree' ||
        complain "the program was built without Embree"
    install_program "$packages/photosphere" "$stage/usr"
    # Where Debian's zsh looks.
    mv "$stage"/usr/share/zsh/{site-functions,vendor-completions}
    control "$packages/photosphere" "$stage" "1~$release" >"$stage/DEBIAN/control"
    rm "$packages/photosphere"
    cp LICENSE-MIT "$stage/usr/share/doc/photosphere/copyright"
    (cd "$stage" && find usr -type f -exec md5sum {} + >DEBIAN/md5sums)
    chmod -R u=rwX,go=rX "$stage"
    SOURCE_DATE_EPOCH=$(epoch) dpkg-deb --root-owner-group --build "$stage" "$packages/$name"
    rm -rf "$stage"
}

# The description of the package with the program $1 in the folder $2, of revision $3.
control() {
    cat <<END
Package: photosphere
Version: $version-$3
Architecture: $(dpkg --print-architecture)
Maintainer: the photosphere developers <photosphere@localhost>
Section: graphics
Priority: optional
Installed-Size: $(du -sk "$2/usr" | cut -f 1)
Depends: $(libraries "$1")
Suggests: ffmpeg
Description: path tracer for scenes made of spheres
 A physically based Monte Carlo path tracer for scenes of three spheres or a
 hundred million: particle files, molecules, grains, and scenes of one's own.
END
}

# The packages of the libraries that the program $1 needs, separated by commas.
libraries() {
    local soname package glibc
    glibc=$(readelf -V "$1" | grep -oE 'GLIBC_[0-9.]+' | sort -Vu | tail -n 1)
    for soname in $(readelf -d "$1" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p'); do
        package=$(dpkg-query -S "*/$soname" | sed -n '1s/:.*//p')
        [[ -n $package ]] || complain "no package has $soname"
        [[ $package != libc6 ]] || package="libc6 (>= ${glibc#GLIBC_})"
        echo "$package"
    done | sort -u | paste -sd , | sed 's/,/, /g'
}

make_deb_in_root() {
    # shellcheck source=scripts/debian-root.sh
    . scripts/debian-root.sh
    can_make_roots || exit 1
    new_root "$1"
    clone_into_root
    local home=~ rust target=target/deb-$1
    rust=$("$RUSTC" --print sysroot)
    mkdir -p "$target"
    share "$rust" "$rust"
    share "${CARGO_HOME:-$home/.cargo}/registry" /root/.cargo/registry
    share "$(realpath "$target")" /photosphere/target
    try "PATH=$rust/bin:\$PATH scripts/package.sh deb"
    ((failed > 0)) || cp "$target"/packages/*.deb "$packages/"
    print_summary
}

# ---- For cargo ----

make_crate() {
    local crate=target/package/photosphere-$version.crate
    # With the folder named, the build of the crate shares the dependencies that are there.
    "$cargo" package --locked --target-dir target
    cp "$crate" "$packages/"
    check_size "$packages/photosphere-$version.crate" "$largest_crate"
}

# ---- What is compiled in ----

check_dependencies() {
    "$cargo" deny --version >/dev/null || complain "please run: cargo install --locked cargo-deny"
    local deny=("$cargo" deny --locked --workspace --all-features)
    "${deny[@]}" check licenses bans sources
    if "${deny[@]}" fetch db; then
        "${deny[@]}" --offline check advisories
    else
        echo "Advisories are NOT checked: their database cannot be downloaded." >&2
    fi
}

mkdir -p "$packages"
find_rust || [[ ${1:-} == deb ]] || complain "no Rust $rust_minimum or newer"
case "${1:-} $#" in
'tarball 1' | 'tarball 2') make_tarball "${2:-ship}" ;;
'deb 1') make_deb ;;
'deb 2') make_deb_in_root "$2" ;;
'crate 1') make_crate ;;
'dependencies 1') check_dependencies ;;
'check 2') check_stripped "$2" ;;
'install 3') install_program "$2" "$3" ;;
*)
    sed -n '/^#   /s/^# *//p' "$0"
    exit 2
    ;;
esac
