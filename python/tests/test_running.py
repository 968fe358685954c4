"""Interrupts, threads, the command line in the package, and what an import loads."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from conftest import endless

import photosphere as ps


def interrupt() -> None:
    """What Ctrl-C does."""
    os.kill(os.getpid(), signal.SIGINT)


def test_an_interrupt_keeps_the_samples_and_the_render_goes_on_from_them(scene: ps.Scene) -> None:
    render = endless(scene)
    threading.Timer(0.1, interrupt).start()
    with pytest.raises(KeyboardInterrupt):
        render.wait()
    light = np.asarray(render.picture)
    assert np.isfinite(light).all() and light.max() > 0
    render.stop()
    assert render.reason == "stopped" and not render.running
    # Whole blocks of samples, to which the rest is added without a trace.
    spp = render.picture.spp + 16
    resumed = ps.resume(render.part, scene=scene, extend_to=spp).wait().picture
    assert np.array_equal(np.asarray(resumed), np.asarray(scene.render(64, 48, spp=spp)))


def test_an_interrupt_ends_reading(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("x,y,z\n" + "1.5,2.5,3.5\n4.5,5.5,6.5\n" * 2_000_000)
    # Python handles the signal when the wait for the threads that read looks for it.
    interrupt_after = threading.Thread(target=interrupt)
    particles = ps.read(path)
    with pytest.raises(KeyboardInterrupt):
        interrupt_after.start()
        particles.scene(radius=1.0).n  # noqa: B018


def test_python_runs_while_it_renders(scene: ps.Scene) -> None:
    render = scene.start(64, 48, spp=20_000)
    assert render.picture.width == 64, "there are samples"
    waiter = threading.Thread(target=render.wait)
    waiter.start()
    # If the waiter held the GIL, this would come after the last sample.
    render.stop()
    waiter.join()
    assert render.reason == "stopped"


def test_a_render_that_nobody_wants_ends(scene: ps.Scene) -> None:
    before = set(os.listdir("/proc/self/task"))
    render = endless(scene)
    # Threads of earlier tests may still end.
    assert set(os.listdir("/proc/self/task")) - before
    del render
    for _ in range(600):
        if not set(os.listdir("/proc/self/task")) - before:
            return
        time.sleep(0.1)
    pytest.fail("its threads are still there after a minute")


def test_the_command_line_is_in_the_package() -> None:
    line = [sys.executable, "-m", "photosphere", "--version"]
    done = subprocess.run(line, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == f"photosphere {ps.__version__}"
    doctor = subprocess.run([*line[:-1], "doctor"], capture_output=True, text=True, check=False)
    assert "native" in doctor.stdout
    wrong = subprocess.run([*line[:-1], "render"], capture_output=True, text=True, check=False)
    assert wrong.returncode == 2
    script = os.path.join(os.path.dirname(sys.executable), "photosphere")
    done = subprocess.run([script, "--version"], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == f"photosphere {ps.__version__}"


def test_an_import_loads_nothing_that_may_not_be_needed() -> None:
    code = "import sys; before = set(sys.modules); import photosphere; print(*sys.modules.keys() - before)"
    line = [sys.executable, "-c", code]
    loaded = subprocess.run(line, capture_output=True, text=True, check=True).stdout.split()
    assert sorted(loaded) == ["__future__", "photosphere", "photosphere._core"]


def test_a_process_ends_well_beside_previews_and_endless_renders(tmp_path: Path) -> None:
    """Threads that are in Rust when the interpreter ends would crash it."""
    script = """
import numpy as np, photosphere as ps, sys
scene = ps.spheres(np.random.default_rng(0).uniform(-5, 5, (100, 3)), radius=0.4)
scene.render(40, 30, spp=4, preview=sys.argv[1], quiet=True)
endless = scene.start(40, 30, spp=1_000_000_000, preview=sys.argv[1], preview_every=0.05)
"""
    for _ in range(3):
        command = [sys.executable, "-c", script, str(tmp_path / "p.png")]
        assert subprocess.run(command, timeout=300).returncode == 0


def test_what_cannot_be_written_is_refused_before_the_first_sample(scene: ps.Scene) -> None:
    for output, words in [("a.jpg", "ends in"), ("-", "ends in"), ("missing/a.png", "no folder")]:
        with pytest.raises((ValueError, FileNotFoundError), match=words):
            scene.start(output=output)
    with pytest.raises(TypeError, match="output: expected a path"):
        scene.start(output=3)  # type: ignore[arg-type]


def test_an_endless_wait_may_be_written(scene: ps.Scene) -> None:
    render = scene.start(32, 24, spp=1, quiet=True)
    assert not render.wait(float("inf")).running
