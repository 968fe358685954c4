"""What the tests share."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import photosphere as ps

REPOSITORY = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def xyz() -> np.ndarray:
    """A thousand points in a box."""
    return np.random.default_rng(0).uniform(-5, 5, (1000, 3))


@pytest.fixture(scope="session")
def scene(xyz: np.ndarray) -> ps.Scene:
    """A small scene of arrays."""
    return ps.spheres(xyz, radius=0.4)


@pytest.fixture
def in_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A new folder, in which the test runs."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def endless(scene: ps.Scene) -> ps.Render:
    """A render that would take an hour, once it has some samples."""
    render = scene.start(64, 48, spp=1 << 20, quiet=True)
    assert render.picture.width == 64, "waits for the first samples"
    return render


def command(*words: object, folder: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Runs the command line of the package."""
    line = [sys.executable, "-m", "photosphere", *map(os.fspath, map(str, words))]
    return subprocess.run(line, capture_output=True, text=True, cwd=folder, check=False)


def write_xyz(path: Path, count: int = 60, seed: int = 0) -> Path:
    """A file of atoms."""
    random = np.random.default_rng(seed)
    rows = random.uniform(0, 8, (count, 3))
    names = random.choice(["O", "H", "C"], count)
    lines = [str(count), 'Lattice="8 0 0 0 8 0 0 0 8" Properties=species:S:1:pos:R:3:e:R:1']
    lines += [f"{n} {x:.6f} {y:.6f} {z:.6f} {x + y:.3f}" for n, (x, y, z) in zip(names, rows)]
    path.write_text("\n".join(lines) + "\n")
    return path
