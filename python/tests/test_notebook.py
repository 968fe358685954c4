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


def test_an_interrupt_of_the_kernel_keeps_the_samples() -> None:
    manager = pytest.importorskip("jupyter_client.manager")
    pytest.importorskip("ipykernel")
    kernel, client = manager.start_new_kernel()
    try:

        def output_of(code: str) -> str:
            lines: list[str] = []

            def hook(message: Any) -> None:
                if message["msg_type"] == "stream":
                    lines.append(message["content"]["text"])
                if "waiting" in "".join(lines[-1:]):
                    kernel.interrupt_kernel()
                if message["msg_type"] == "error":
                    lines.append(message["content"]["ename"])

            client.execute_interactive(code, output_hook=hook, timeout=600, allow_stdin=False)
            return "".join(lines)

        output_of(
            "import numpy as np, photosphere as ps\n"
            "xyz = np.random.default_rng(0).uniform(-5, 5, (1000, 3))\n"
            "r = ps.spheres(xyz, radius=0.4).start(64, 48, spp=1 << 20)\n"
            "r.picture"
        )
        # IPython may fail to print the traceback that follows, at the end of which it says so again.
        assert "KeyboardInterrupt" in output_of("print('waiting', flush=True); r.wait()")
        shown = output_of("r.stop(); print(r.reason, r.picture.spp > 0)")
        assert shown == "stopped True\n"
    finally:
        client.stop_channels()
        kernel.shutdown_kernel(now=True)


def test_a_picture_is_shown_as_png(xyz: np.ndarray) -> None:
    picture = ps.spheres(xyz, radius=0.4, color=ps.by(xyz[:, 0])).render(64, 48, spp=4, quiet=True)
    assert picture._repr_png_().startswith(b"\x89PNG")
    assert picture.legend is not None and picture.legend._repr_svg_().startswith("<svg")
