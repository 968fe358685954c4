"""What notebooks show."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from conftest import endless

import photosphere as ps


def test_a_render_shows_a_picture_that_gets_better(
    scene: ps.Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    display = pytest.importorskip("IPython.display")
    shown: list[Any] = []

    class Handle:
        def update(self, frame: Any) -> None:
            shown.append(frame._repr_mimebundle_())

    def show(frame: Any, display_id: bool) -> Handle:
        shown.append(frame._repr_mimebundle_())
        return Handle()

    monkeypatch.setattr(display, "display", show)
    render = endless(scene)
    render._ipython_display_()
    while len(shown) < 2:
        render.wait(timeout=0.1)
    render.stop()
    render._ipython_display_()
    assert "data:image/png;base64" in shown[-1]["text/html"]
    assert "samples per pixel" in shown[-1]["text/plain"]
    assert render._repr_png_() is not None


def test_a_picture_is_shown_as_png(xyz: np.ndarray) -> None:
    picture = ps.spheres(xyz, radius=0.4, color=ps.by(xyz[:, 0])).render(64, 48, spp=4, quiet=True)
    assert picture._repr_png_().startswith(b"\x89PNG")
    assert picture.legend is not None and picture.legend._repr_svg_().startswith("<svg")
