"""The notebooks of docs/notebooks run from top to bottom, and show pictures."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import REPOSITORY

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")
pytest.importorskip("ipykernel")
pytest.importorskip("matplotlib")

BOOKS = sorted((REPOSITORY / "docs/notebooks").glob("*.ipynb"))

#: What replaces the parameters, so that a test takes seconds.
SMALL = "SPP = 16\nWIDTH, HEIGHT = 64, 48\nSEEDS = 2"


@pytest.mark.parametrize("path", BOOKS, ids=lambda path: path.stem)
def test_a_notebook(path: Path) -> None:
    book = nbformat.read(path, as_version=4)
    nbformat.validate(book)
    assert all(not cell.get("outputs") for cell in book.cells), "kept without outputs"
    assert book.cells[0].source.startswith("# "), "a title"
    tags = [cell.metadata.get("tags", []) for cell in book.cells]
    book.cells.insert(tags.index(["parameters"]) + 1, nbformat.v4.new_code_cell(SMALL))
    resources = {"metadata": {"path": path.parent}}
    nbclient.NotebookClient(book, timeout=1200, resources=resources).execute()
    shown = [output for cell in book.cells for output in cell.get("outputs", [])]
    pictures = [output for output in shown if "image/png" in output.get("data", {})]
    assert len(pictures) >= 2
    warnings = [output.text for output in shown if output.get("name") == "stderr"]
    assert warnings == []
