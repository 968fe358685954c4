"""The types: stubs agree with the extension module, and the package passes its own checks."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("mypy")
PACKAGE = Path(__file__).parents[1]


def run(*words: str, folder: Path = PACKAGE) -> str:
    done = subprocess.run(
        [sys.executable, "-m", *words], capture_output=True, text=True, cwd=folder, check=False
    )
    return done.stdout + done.stderr if done.returncode else ""


def test_stubs_agree_with_the_package(tmp_path: Path) -> None:
    # Private functions with a cache, whose parameters mypy does not see.
    allowed = tmp_path / "allowed"
    allowed.write_text("photosphere._options.known\nphotosphere._file._read\n")
    words = ["mypy.stubtest", "photosphere", "--ignore-disjoint-bases", "--allowlist", str(allowed)]
    # The installed package: that of the sources has no extension module.
    assert run(*words, folder=PACKAGE / "tests") == ""


def test_the_types_are_consistent() -> None:
    assert run("mypy") == ""


def test_everything_public_has_a_docstring() -> None:
    import inspect

    import photosphere as ps

    for name in ps.__all__:
        one = getattr(ps, name)
        if not callable(one):
            continue
        assert one.__doc__, name
        if inspect.isclass(one):
            for member, made in vars(one).items():
                is_public = not member.startswith("_") and callable(made)
                assert not is_public or made.__doc__, f"{name}.{member}"
