"""What the wheel contains beside the package."""

from __future__ import annotations

from importlib import metadata

import pytest
from conftest import REPOSITORY, command


def test_the_licences_are_in_the_wheel() -> None:
    try:
        files = metadata.files("photosphere") or []
    except metadata.PackageNotFoundError:
        pytest.skip("the package is not installed")
    if not any(file.name == "WHEEL" for file in files):
        pytest.skip("the package is installed from its sources")
    kept = {file.name: file.read_text() for file in files if file.name.startswith("LICENSE")}
    theirs = {path.name: path.read_text() for path in REPOSITORY.glob("LICENSE-*")}
    assert kept == theirs and len(kept) == 2
    names = metadata.metadata("photosphere").get_all("License-File") or []
    assert len(names) == 2


def test_the_doctor_advises_on_what_the_package_can_have() -> None:
    done = command("doctor")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "not in this package" in done.stdout
    for advice in ("cargo", "libclang", "libembree", "python3-venv"):
        assert advice not in done.stdout
