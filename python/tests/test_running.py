"""Interrupts, threads, forks, and the time that an import takes."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import photosphere as ps


def test_an_interrupt_takes_effect_soon_and_keeps_the_samples(scene: ps.Scene) -> None:
    render = scene.start(640, 480, spp=100_000)
    render.wait(timeout=1.0)
    sent = []

    def interrupt() -> None:
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    threading.Timer(0.3, interrupt).start()
    with pytest.raises(KeyboardInterrupt):
        render.wait()
    # 0.3 s on a machine that has nothing else to do.
    assert time.monotonic() - sent[0] < 0.3 * patience()
    render.stop()
    assert render.reason == "stopped" and render.picture.spp >= 1
    pixels = np.asarray(render.picture)
    assert np.isfinite(pixels).all() and pixels.max() > 0


def patience() -> float:
    """How much longer things may take where more threads run than there are cores."""
    return max(1.0, 2.0 * os.getloadavg()[0] / (os.cpu_count() or 1))


def test_python_runs_while_it_renders(scene: ps.Scene) -> None:
    render = scene.start(320, 240, spp=100_000)
    ticks = 0
    end = time.monotonic() + 1.0
    waiter = threading.Thread(target=lambda: render.wait(timeout=1.0))
    waiter.start()
    while time.monotonic() < end:
        ticks += 1
        time.sleep(0.001)
    waiter.join()
    render.stop()
    assert ticks > 50


def test_a_render_that_nobody_wants_stops(scene: ps.Scene) -> None:
    before = threading.active_count()
    render = scene.start(320, 240, spp=100_000)
    render.wait(timeout=0.3)
    core = render._core
    del render
    assert core.is_running()
    del core
    assert threading.active_count() == before


def _in_child(queue: multiprocessing.Queue[bytes]) -> None:
    scene = ps.spheres(np.random.default_rng(0).uniform(-5, 5, (1000, 3)), radius=0.4)
    queue.put(np.asarray(scene.render(64, 48, spp=4, quiet=True)).tobytes())


def test_other_processes_render_alike(scene: ps.Scene) -> None:
    here = np.asarray(scene.render(64, 48, spp=4, quiet=True)).tobytes()
    running = scene.start(64, 48, spp=100_000, threads=1)
    running.wait(timeout=0.2)
    context = multiprocessing.get_context("spawn")
    queue = context.Queue()
    child = context.Process(target=_in_child, args=(queue,))
    child.start()
    assert queue.get(timeout=300) == here
    child.join(timeout=60)
    assert child.exitcode == 0
    running.stop()


def test_a_render_of_the_parent_is_refused(scene: ps.Scene) -> None:
    render = scene.start(64, 48, spp=4).wait()
    child = os.fork()
    if child == 0:
        try:
            render.wait()
        except RuntimeError as error:
            os._exit(0 if "process" in str(error) else 1)
        os._exit(2)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def test_a_forked_process_refuses_to_render(scene: ps.Scene) -> None:
    scene.start(64, 48, spp=4).wait()
    child = os.fork()
    if child == 0:
        try:
            scene.start(64, 48, spp=4)
        except RuntimeError as error:
            os._exit(0 if "spawn" in str(error) else 1)
        os._exit(2)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def test_the_command_line_is_in_the_package(tmp_path: object) -> None:
    line = [sys.executable, "-m", "photosphere", "--version"]
    done = subprocess.run(line, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == f"photosphere {ps.__version__}"
    doctor = subprocess.run([*line[:-1], "doctor"], capture_output=True, text=True, check=False)
    assert "native" in doctor.stdout
    wrong = subprocess.run([*line[:-1], "render"], capture_output=True, text=True, check=False)
    assert wrong.returncode == 2


def test_an_import_is_quick_and_light() -> None:
    code = (
        "import sys, time; t = time.process_time(); import photosphere; "
        "print(time.process_time() - t, 'numpy' in sys.modules)"
    )
    runs = [
        subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        for _ in range(5)
    ]
    times = [float(run.stdout.split()[0]) for run in runs]
    # Time of the processor, which others slow down as well.
    assert min(times) < 0.06 * patience(), times
    assert runs[0].stdout.split()[1] == "False"
