#!/usr/bin/env bash
# Makes a Python in target/python with packages of others that read our files, run our plans and
# denoise our pictures, for the tests that need them. Those tests skip without it, so failing to make
# it is no error.
#
#   scripts/setup-python.sh
set -uo pipefail
exec >&2
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1

folder=target/python
python=$folder/bin/python
# pyoidn contains Intel Open Image Denoise.
packages=(OpenEXR cryptomatte-api openjd-cli pyoidn)

has_packages() {
    "$python" -c 'import OpenEXR, cryptomatte_api, openjd.cli, importlib.util as found
assert found.find_spec("pyoidn")' 2>/dev/null
}

has_packages && exit 0
for system in python3 python; do
    command -v "$system" >/dev/null || continue
    echo "Making a Python with ${packages[*]} in $folder"
    "$system" -m venv "$folder" || break
    # One by one: not every system has all of them.
    for package in "${packages[@]}"; do
        "$python" -m pip --quiet --disable-pip-version-check install "$package"
    done
    break
done
has_packages || echo "Going on without ${packages[*]}: tests that need them will skip."
