#!/usr/bin/env bash
# Makes a Python in target/wheel-python with all that building and testing the Python package takes.
# Fails, and says so, where there is no Python 3.11 or later, or its packages cannot be installed.
#
#   scripts/setup-wheel.sh
set -uo pipefail
exec >&2
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1

folder=target/wheel-python
python=$folder/bin/python
# zig links against an old glibc, so that the wheel runs on old systems.
packages=(maturin ziglang auditwheel numpy pytest hypothesis mypy nbclient ipykernel matplotlib ase)

has_packages() {
    "$python" -c 'import maturin, ziglang, auditwheel, numpy, pytest, hypothesis, mypy, nbclient, \
ipykernel, matplotlib, ase' 2>/dev/null
}

is_new_enough() {
    "$1" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null
}

has_packages && exit 0
for system in python3 python3.14 python3.13 python3.12 python3.11; do
    is_new_enough "$system" || continue
    echo "Making a Python with ${packages[*]} in $folder"
    "$system" -m venv "$folder" &&
        "$python" -m pip --quiet --disable-pip-version-check install --no-compile "${packages[@]}"
    break
done
has_packages && exit 0
echo "The Python package needs Python 3.11 or later, with packages from an index."
exit 1
