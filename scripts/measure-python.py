"""Measures the Python package: its import, a million spheres from import to picture, memory, Ctrl-C.

    target/wheel-python/bin/python scripts/measure-python.py

On a machine that does other work, too, times of the processor tell more than those of the clock.
"""

import os
import subprocess
import sys

IMPORT = """
import time
clock, processor = time.perf_counter(), time.process_time()
import photosphere
print(time.perf_counter() - clock, time.process_time() - processor)
"""

MILLION = """
import time

def now():
    return time.perf_counter(), time.process_time()

times = [now()]
import numpy as np, photosphere as ps
xyz = np.random.default_rng(0).uniform(-50, 50, (1_000_000, 3)){convert}
times.append(now())
scene = ps.spheres(xyz, radius=0.4)
times.append(now())
picture = scene.render(640, 480, spp=16)
times.append(now())
shown = picture._repr_png_()
times.append(now())
steps = ("import and numbers", "scene", "render", "PNG")
for name, begin, end in [*zip(steps, times, times[1:]), ("all", times[0], times[-1])]:
    clock, processor = (b - a for a, b in zip(begin, end))
    print(f"  {{name}}: {{clock:.2f}} s, {{processor:.2f}} s of processors")
"""

MEMORY = """
import resource
import numpy as np, photosphere as ps

def resident():
    return int(open("/proc/self/statm").read().split()[1]) * resource.getpagesize()

n = 10_000_000
xyz = np.random.default_rng(0).uniform(-50, 50, (n, 3)){convert}
radius = np.full(n, 0.2){convert}
color = ps.by(xyz[:, 0])
ps.spheres(xyz[:10], radius=radius[:10], color=ps.by(xyz[:10, 0]))
before = resident()
scene = ps.spheres(xyz, radius=radius, color=color)
print(f"{{(resident() - before) / n:.1f}} bytes per sphere in a scene of {{xyz.dtype}}")
"""

PEAK = """
import resource
import numpy as np, photosphere as ps

def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024

xyz = np.random.default_rng(0).uniform(-50, 50, (1_000_000, 3))
before = peak()
ps.spheres(xyz, radius=0.4).render(800, 600, spp=16)
print(f"{peak() - before:.0f} MiB more at the peak of a render of a million spheres")
"""

INTERRUPT = """
import os, signal, threading, time
import numpy as np, photosphere as ps

xyz = np.random.default_rng(0).uniform(-50, 50, (1_000_000, 3))
scene = ps.spheres(xyz, radius=0.4)
render = scene.start(640, 480, spp=100_000)
render.picture
sent = []

def interrupt():
    sent.append(time.perf_counter())
    os.kill(os.getpid(), signal.SIGINT)

threading.Timer(0.5, interrupt).start()
try:
    render.wait()
except KeyboardInterrupt:
    print(f"{1e3 * (time.perf_counter() - sent[0]):.0f} ms from Ctrl-C to KeyboardInterrupt")
"""


def run(code: str) -> str:
    line = [sys.executable, "-c", code]
    return subprocess.run(line, capture_output=True, text=True, check=True).stdout.rstrip()


print("load", *(f"{load:.1f}" for load in os.getloadavg()), "cores", os.cpu_count())
times = [[1e3 * float(word) for word in run(IMPORT).split()] for _ in range(11)]
clock, processor = (sorted(column) for column in zip(*times))
print(f"import: {clock[0]:.1f} ms at best of 11, {clock[5]:.1f} ms in the middle; "
      f"{processor[0]:.1f} and {processor[5]:.1f} ms of processors")
for name, convert in (("f64", ""), ("f32", ".astype('f4')")):
    print(f"a million spheres in {name}, 640 x 480, 16 samples:")
    print(run(MILLION.format(convert=convert)))
for convert in (".astype('f4')", ""):
    print("memory:", run(MEMORY.format(convert=convert)))
print("memory:", run(PEAK))
print("interrupt:", ", ".join(run(INTERRUPT) for _ in range(3)))
