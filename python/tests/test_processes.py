"""Other processes, forked and new ones, render alike."""

from __future__ import annotations

import multiprocessing
import os
import signal
import traceback
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from conftest import endless, write_xyz

import photosphere as ps

pytestmark = pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")


def in_fork(work: Callable[[], object]) -> None:
    """Runs `work` in a forked process; fails if it fails there. A child that hangs is ended."""
    child = os.fork()
    if child == 0:
        signal.alarm(600)
        try:
            work()
        except BaseException:
            traceback.print_exc()
            os._exit(1)
        os._exit(0)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def use_everything(scene: ps.Scene, folder: Path) -> np.ndarray:
    """Whatever needs threads: reading, rendering, saving, merging."""
    folder.mkdir()
    write_xyz(folder / "a.xyz")
    particles = ps.read(folder / "a.xyz")
    assert particles.scene(color="element").render(64, 48, spp=4, quiet=True).legend is not None
    render = scene.start(64, 48, spp=64, checkpoint=folder / "a.state", checkpoint_every=0.05)
    for picture in render.stream(every=0.01):
        assert picture.width == 64
    assert render.error is not None and render.reason == "finished"
    ps.resume(folder / "a.state", scene=scene).extend_to(96).wait().save(folder / "a.exr")
    parts = [scene.part(samples=(first, first + 32), size=(64, 48)) for first in (0, 32, 64)]
    merged = ps.merge(parts)
    merged.save(folder / "a.png")
    assert scene.pick(32, 24, size=(64, 48)) is not None
    light = np.asarray(merged)
    assert np.array_equal(light, np.asarray(scene.render(64, 48, spp=96)))
    return light


def test_a_forked_process_renders(scene: ps.Scene, tmp_path: Path) -> None:
    here = use_everything(scene, tmp_path / "here")

    def check() -> None:
        assert np.array_equal(use_everything(scene, tmp_path / "there"), here)

    in_fork(check)


def test_a_process_that_is_forked_during_a_render_renders(scene: ps.Scene, tmp_path: Path) -> None:
    render = endless(scene)
    in_fork(lambda: use_everything(scene, tmp_path / "there"))
    render.stop()
    assert render.reason == "stopped"


def test_a_fork_of_a_fork_renders(scene: ps.Scene, tmp_path: Path) -> None:
    def fork_again() -> None:
        scene.render(64, 48, spp=4)
        in_fork(lambda: use_everything(scene, tmp_path / "there"))

    in_fork(fork_again)


def test_a_render_belongs_to_the_process_that_started_it(scene: ps.Scene) -> None:
    render, ended = endless(scene), scene.start(64, 48, spp=4).wait()

    def check() -> None:
        for one in (render, ended):
            for ask in (one.wait, one.stop, lambda: one.picture, lambda: one.error):
                with pytest.raises(RuntimeError, match="process that started it"):
                    ask()
            assert repr(one) == "<render: of another process>"

    in_fork(check)
    render.stop()


def part(scene: ps.Scene, first: int) -> ps.Part:
    """A worker's share."""
    return scene.part(samples=(first, first + 16), size=(64, 48), threads=1)


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_parts_of_other_processes_add_up_to_the_same_bits(method: str, scene: ps.Scene) -> None:
    whole = scene.render(64, 48, spp=64)
    context = multiprocessing.get_context(method)
    with ProcessPoolExecutor(2, mp_context=context) as pool:
        parts = list(pool.map(part, [scene] * 4, range(0, 64, 16)))
    assert np.array_equal(np.asarray(ps.merge(parts)), np.asarray(whole))
