"""Measures the Python package: its import, a million spheres from import to picture, memory.

    target/wheel-python/bin/python scripts/measure-python.py
"""

import os
import subprocess
import sys

IMPORT = """
import time
t = time.perf_counter()
import photosphere
print(time.perf_counter() - t)
"""

MILLION = """
import time
t = time.perf_counter()
import numpy as np, photosphere as ps
xyz = np.random.default_rng(0).uniform(-50, 50, (1_000_000, 3)){convert}
made = time.perf_counter()
scene = ps.spheres(xyz, radius=0.4)
framed = time.perf_counter()
picture = scene.render(640, 480, spp=16)
shown = picture._repr_png_()
end = time.perf_counter()
print(f"{{end - t:.2f}} s: import and numbers {{made - t:.2f}}, scene {{framed - made:.2f}}, "
      f"picture {{end - framed:.2f}}; {{len(shown)}} bytes of PNG")
"""

MEMORY = """
import numpy as np, photosphere as ps

def resident():
    return int(open("/proc/self/statm").read().split()[1]) * 4096

n = 4_000_000
xyz = np.random.default_rng(0).uniform(-50, 50, (n, 3)){convert}
v = xyz[:, 0].copy()
ps.spheres(xyz[:10], radius=v[:10] ** 2 + 1, color=ps.by(v[:10]))
before = resident()
scene = ps.spheres(xyz, radius=np.abs(v) * 0 + 0.2, color=ps.by(v))
print(f"{{(resident() - before) / n:.1f}} bytes per sphere in a scene of {{xyz.dtype}}")
"""


def run(code: str) -> str:
    return subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.strip()


print("load", os.getloadavg(), "cores", os.cpu_count())
times = sorted(float(run(IMPORT)) for _ in range(11))
print(f"import: {1e3 * times[0]:.1f} ms at best, {1e3 * times[5]:.1f} ms in the middle of 11")
for name, convert in (("f64", ""), ("f32", ".astype('f4')")):
    print(f"a million spheres, {name}:", run(MILLION.format(convert=convert)))
for convert in (".astype('f4')", ""):
    print("memory:", run(MEMORY.format(convert=convert)))
