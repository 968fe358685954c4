#!/usr/bin/env bash
# Compares particle files that other programs write with what those programs read back: ASE, gsd,
# MDAnalysis, OVITO, plyfile and vtk of today, from PyPI, with sizes and contents that change.
#
#   scripts/try-adapters.sh [FOLDER]
#
# It makes a Python environment in FOLDER (default: target/adapters), once.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

folder=${1:-target/adapters}
program=${PHOTOSPHERE:-target/release/photosphere}
python=$folder/bin/python
packages=(numpy ase gsd MDAnalysis ovito plyfile vtk)

if ! "$python" -c 'import numpy, ase, gsd, MDAnalysis, ovito, plyfile, vtk' 2>/dev/null; then
    python3 -m venv "$folder"
    "$python" -m pip --quiet --disable-pip-version-check install "${packages[@]}"
fi
[[ -x $program ]] || cargo build --release
PHOTOSPHERE=$program exec "$python" scripts/try-adapters.py
