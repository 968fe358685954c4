#!/usr/bin/env python3
"""Measures the way from a particle file to its first picture, for benches/record/.

    scripts/measure-particles.py [PROGRAM] [LARGEST]

Prints, for files of 1e5, 1e6, ... particles in a binary and a text format: the seconds of loading
(reading, radii, colours), building and rendering 640x480 pixels with 16 samples, the share of
loading, the processor time of all, and the peak memory beside the plan of `photosphere info`. Then
the processor time of pandas' C reader, where pandas is installed, beside that of loading, framing
and hashing on one thread; `cargo bench --bench particles` measures the readers alone. On a busy
machine, believe the shares and the processor times.

Needs: pip install numpy pandas
"""

import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

PROGRAM = sys.argv[1] if len(sys.argv) > 1 else "target/release/photosphere"
LARGEST = int(float(sys.argv[2])) if len(sys.argv) > 2 else 10_000_000


def particles(count):
    r = np.random.default_rng(1)
    side = (count / 0.5) ** (1 / 3)
    return r.uniform(0, side, (count, 3)).astype("<f4")


def write_dump(path, points):
    side = points.max()
    with open(path, "w") as f:
        f.write(f"ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n{len(points)}\n")
        f.write("ITEM: BOX BOUNDS pp pp pp\n" + 3 * f"0 {side}\n" + "ITEM: ATOMS id type x y z\n")
        for start in range(0, len(points), 100_000):
            part = points[start:start + 100_000]
            f.writelines("%d %d %.5f %.5f %.5f\n" % (start + i + 1, 1 + i % 2, *p) for i, p in enumerate(part))


def render(path, *options):
    words = [PROGRAM, "render", path, "-o", "none", "--quiet", "--json", *options]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    result = json.loads(subprocess.run(words, check=True, capture_output=True).stdout)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    result["cpu_s"] = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return result


def pandas_seconds(path):
    try:
        import pandas
    except ImportError:
        return None
    began = time.process_time()
    pandas.read_csv(path, engine="c", sep=" ", header=None, skiprows=9)
    return time.process_time() - began


with tempfile.TemporaryDirectory() as folder:
    print("file       load s  build s  render s  load share   cpu s  peak MB  plan MB  peak/plan")
    count = 100_000
    while count <= LARGEST:
        points = particles(count)
        for ending in ("npy", "dump"):
            path = Path(folder) / f"a.{ending}"
            if ending == "npy":
                np.save(path, points)
            else:
                write_dump(path, points)
            plan = json.loads(subprocess.run([PROGRAM, "info", path, "--json"], check=True, capture_output=True).stdout)
            r = render(path, "--size", "640x480", "--spp", "16")
            whole = r["load_s"] + r["build_s"] + r["render_s"]
            peak, planned = r["peak_rss_bytes"], plan["memory_bytes"]
            print(f"{count:.0e} {ending:4} {r['load_s']:7.2f} {r['build_s']:8.2f} {r['render_s']:9.2f} "
                  f"{r['load_s'] / whole:10.0%} {r['cpu_s']:8.2f} {peak / 1e6:8.0f} {planned / 1e6:8.0f} "
                  f"{peak / planned:9.2f}", flush=True)
            if ending == "dump":
                small = ["--size", "16x16", "--spp", "1", "--radius", "0.5", "--threads", "1", "--accel", "native"]
                ours, theirs = render(path, *small), pandas_seconds(path)
                if theirs:
                    # The share of loading is that of its seconds: nothing else runs beside it.
                    all_s = ours["load_s"] + ours["build_s"] + ours["render_s"]
                    loading = ours["cpu_s"] * ours["load_s"] / all_s
                    print(f"     processor time: pandas' C reader {theirs:.2f} s, loading {loading:.2f} s")
            path.unlink()
        count *= 10
