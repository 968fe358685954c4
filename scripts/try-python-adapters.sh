#!/usr/bin/env bash
# Tries the Python package with the real packages: the adapters of ASE, MDAnalysis, OVITO, PyVista and
# GSD, and parts by joblib and Dask. Needs some 400 MB from a package index, and the wheel
# (`scripts/run wheel`).
#
#   scripts/try-python-adapters.sh [FOLDER]     pictures go to FOLDER, target/adapters by default
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

folder=target/adapters-python
python=$folder/bin/python
out=$(realpath -m "${1:-target/adapters}")
packages=(ase MDAnalysis ovito pyvista gsd joblib 'dask[distributed]' numpy)

has_packages() {
    "$python" -c 'import ase, MDAnalysis, ovito, pyvista, gsd, joblib, dask.distributed' 2>/dev/null
}

if ! has_packages; then
    python3 -m venv "$folder"
    "$python" -m pip --quiet --disable-pip-version-check install "${packages[@]}"
fi
"$python" -m pip --quiet --disable-pip-version-check install --no-deps --force-reinstall \
    target/wheels/photosphere-*.whl
mkdir -p "$out"
"$python" python/tests/try_adapters.py "$out"
"$python" python/tests/try_parts.py
