"""Parts of a render by joblib and Dask add up to the bits of one render; run by
scripts/try-python-adapters.sh, not by pytest."""

from __future__ import annotations

import numpy as np

import photosphere as ps

SIZE = (160, 120)
RANGES = [(first, first + 32) for first in range(0, 256, 32)]


def make_scene() -> ps.Scene:
    """Spheres with colours by an array."""
    xyz = np.random.default_rng(0).uniform(-5, 5, (2000, 3))
    return ps.spheres(xyz, radius=0.4, color=ps.by(xyz[:, 0], "batlow"))


def compare(name: str, parts: list[ps.Part], whole: np.ndarray) -> None:
    """Merges parts and compares the bits."""
    merged = np.asarray(ps.merge(parts))
    assert np.array_equal(merged, whole), name
    print(f"{name}: {len(parts)} parts add up to the bits of one render")


def main() -> None:
    """Tries every way."""
    from dask.distributed import Client, LocalCluster
    from joblib import Parallel, delayed

    scene = make_scene()
    whole = np.asarray(scene.render(*SIZE, spp=256))
    for backend in ("loky", "multiprocessing", "threading"):
        jobs = (delayed(scene.part)(samples=samples, size=SIZE) for samples in RANGES)
        compare(f"joblib, {backend}", Parallel(n_jobs=2, backend=backend)(jobs), whole)
    for processes in (True, False):
        with (
            LocalCluster(n_workers=2, processes=processes, dashboard_address=None) as cluster,
            Client(cluster) as client,
        ):
            futures = client.map(lambda one: scene.part(samples=one, size=SIZE), RANGES)
            name = "Dask, processes" if processes else "Dask, threads"
            compare(name, client.gather(futures), whole)


if __name__ == "__main__":
    main()
