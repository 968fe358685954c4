#!/usr/bin/env python3
"""Makes the particle files of docs/gallery.md in a folder.

    scripts/make-gallery-data.py FOLDER [NAME...]

Needs: pip install numpy scipy; for the protein also nglview, which has rhodopsin (PDB 1U19).
"""

import sys
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree


def rng():
    return np.random.default_rng(7)


def protein(out):
    import nglview

    source = Path(nglview.__file__).parent / "datafiles/md_1u19.pdb"
    (out / "protein.pdb").write_bytes(source.read_bytes())


def water(out):
    """1000 molecules on a disturbed lattice, turned at random."""
    r, n, side = rng(), 10, 3.11
    grid = np.stack(np.meshgrid(*[np.arange(n)] * 3, indexing="ij"), -1).reshape(-1, 3)
    oxygen = (grid + 0.5 + r.uniform(-0.24, 0.24, grid.shape)) * side / n
    axes = np.linalg.qr(r.normal(size=(len(grid), 3, 3)))[0]
    half = np.radians(109.47 / 2)
    legs = [axes[:, 0] * np.cos(half) + sign * axes[:, 1] * np.sin(half) for sign in (1, -1)]
    atoms = np.stack([oxygen, *(oxygen + 0.1 * leg for leg in legs)], 1)
    with open(out / "water.gro", "w") as f:
        f.write(f"Water\n{3 * len(grid)}\n")
        for i, molecule in enumerate(atoms):
            for j, (name, p) in enumerate(zip(("OW", "HW1", "HW2"), molecule)):
                number = 3 * i + j + 1
                f.write(f"{i + 1:5d}SOL  {name:>5}{number:5d}{p[0]:8.3f}{p[1]:8.3f}{p[2]:8.3f}\n")
        f.write(f"{side:10.5f}{side:10.5f}{side:10.5f}\n")


def packed(r, radii, counts, tries, size):
    """Balls that do not overlap, large ones first, in a box: at most `counts` of each radius, out
    of so many `tries`."""
    centers, sizes = np.empty((0, 3)), np.empty(0)
    for radius, count, many in zip(radii, counts, tries):
        new = r.uniform(radius, np.asarray(size) - radius, (many, 3))
        for other in np.unique(sizes):
            apart = radius + other
            tree = cKDTree(centers[sizes == other])
            new = new[tree.query(new, distance_upper_bound=apart)[0] >= apart]
        pairs = cKDTree(new).query_pairs(2 * radius, output_type="ndarray")
        keep = np.ones(len(new), bool)
        for a, b in pairs[np.argsort(pairs[:, 0])]:
            if keep[a]:
                keep[b] = False
        new = new[keep][:count]
        centers = np.concatenate([centers, new])
        sizes = np.concatenate([sizes, np.full(len(new), radius)])
    return centers, sizes


def beads(out):
    """A dense pack of beads whose radii span two decades."""
    radii = np.geomspace(1.0, 0.01, 16)
    tries = np.minimum(20000 / radii**1.2, 300000).astype(int)
    tries[0] = 300
    counts = np.full(16, 100000)
    centers, sizes = packed(rng(), radii, counts, tries, (6, 6, 2.6))
    np.savetxt(out / "beads.csv", np.column_stack([centers, sizes]), fmt="%.5g", delimiter=",",
               comments="", header="x,y,z,radius")


def galaxy(out):
    r, n = rng(), 120000
    distance = 10 * r.gamma(1.6, 0.28, n)
    arm = r.integers(0, 2, n) * np.pi
    angle = arm + 1.9 * np.log(distance + 0.4) + r.normal(0, 0.28, n)
    bulge = r.random(n) < 0.28
    x, y = distance * np.cos(angle), distance * np.sin(angle)
    z = r.normal(0, 0.12, n)
    ball = r.normal(0, 0.75, (n, 3)) * [1, 1, 0.7]
    x, y, z = np.where(bulge, ball.T, [x, y, z])
    heat = np.clip(1.15 - np.hypot(x, y) / 6 + r.normal(0, 0.15, n), 0, 1)
    warm, cool = np.array([1.0, 0.72, 0.38]), np.array([0.45, 0.62, 1.0])
    color = heat[:, None] * warm + (1 - heat[:, None]) * cool
    radius = 0.008 * np.exp(r.normal(0, 0.45, n))
    pink = (~bulge) & (r.random(n) < 0.02)
    color[pink], radius[pink] = [1.0, 0.3, 0.45], 0.03
    names = ["x", "y", "z", "radius", "red", "green", "blue"]
    rows = np.rec.fromarrays([x, y, z, radius, *color.T], dtype=[(name, "<f4") for name in names])
    np.save(out / "galaxy.npy", rows)


def gold(out):
    """A truncated octahedron of gold."""
    a, n = 4.078, 11
    grid = np.stack(np.meshgrid(*[np.arange(-n, n + 1)] * 3, indexing="ij"), -1).reshape(-1, 3)
    grid = grid[grid.sum(1) % 2 == 0]
    size = np.abs(grid)
    grid = grid[(size.max(1) <= 9) & (size.sum(1) <= 15)]
    with open(out / "gold.xyz", "w") as f:
        f.write(f"{len(grid)}\nA gold nanoparticle\n")
        f.writelines("Au %.4f %.4f %.4f\n" % tuple(p) for p in grid * a / 2)


def melt(out):
    """Chains that walk at random, with the number of neighbours of each bead."""
    r, chains, beads = rng(), 220, 100
    side = (chains * beads / 0.85) ** (1 / 3)
    steps = r.normal(size=(chains, beads, 3))
    for i in range(1, beads):
        # A chain does not turn back.
        steps[:, i] = 0.9 * steps[:, i - 1] / np.linalg.norm(steps[:, i - 1], axis=1)[:, None] \
            + 0.75 * r.normal(size=(chains, 3))
    steps *= 0.97 / np.linalg.norm(steps, axis=2)[:, :, None]
    walk = (np.cumsum(steps, 1) + r.uniform(0, side, (chains, 1, 3))).reshape(-1, 3) % side
    for _ in range(60):
        # Beads push each other apart.
        tree = cKDTree(walk, boxsize=side)
        pairs = tree.query_pairs(0.95, output_type="ndarray")
        apart = walk[pairs[:, 0]] - walk[pairs[:, 1]]
        apart -= side * np.round(apart / side)
        length = np.linalg.norm(apart, axis=1)[:, None] + 1e-9
        push = 0.25 * (0.95 - length) * apart / length
        np.add.at(walk, pairs[:, 0], push)
        np.add.at(walk, pairs[:, 1], -push)
        walk %= side
    ends = np.linalg.norm(np.cumsum(steps, 1)[:, -1] - steps[:, 0], axis=1)
    stretch = np.repeat(ends, beads)
    with open(out / "melt.dump", "w") as f:
        f.write(f"ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n{len(walk)}\n")
        f.write("ITEM: BOX BOUNDS pp pp pp\n" + 3 * f"0 {side:.6f}\n")
        f.write("ITEM: ATOMS id mol x y z c_ree\n")
        for i, (p, s) in enumerate(zip(walk, stretch)):
            f.write("%d %d %.4f %.4f %.4f %.3f\n" % (i + 1, i // beads + 1, *p, s))


def chair(out):
    """Points on a chair, as those of papers on point clouds."""
    r = rng()
    boxes = [((-0.5, -0.5, 0.9), (0.5, 0.5, 1.0))]
    boxes += [((x, y, 0), (x + 0.09, y + 0.09, 0.9)) for x in (-0.5, 0.41) for y in (-0.5, 0.41)]
    boxes += [((x, 0.42, 1.0), (x + 0.07, 0.5, 2.0)) for x in (-0.5, 0.43)]
    boxes += [((-0.5, 0.43, z), (0.5, 0.49, z + 0.12)) for z in (1.2, 1.5, 1.85)]
    points = []
    for low, high in boxes:
        low, high = np.array(low), np.array(high)
        size = high - low
        areas = np.array([size[1] * size[2], size[0] * size[2], size[0] * size[1]])
        count = int(900 * 2 * areas.sum())
        axis = r.choice(3, count, p=areas / areas.sum())
        p = low + size * r.random((count, 3))
        side = r.integers(0, 2, count)
        p[np.arange(count), axis] = np.where(side, high[axis], low[axis])
        points.append(p)
    points = np.concatenate(points)
    points[:, 1] += 0.12 * np.maximum(points[:, 2] - 1, 0) ** 1.5
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
    head += "property float x\nproperty float y\nproperty float z\nend_header\n"
    (out / "chair.ply").write_bytes(head.encode() + points.astype("<f4").tobytes())


def gyroid(out):
    """Ten million points in one of the two labyrinths of a gyroid, in a ball."""
    r, n, parts = rng(), 10_000_000, []
    while sum(map(len, parts)) < n:
        p = r.uniform(-1, 1, (4_000_000, 3)).astype("<f4")
        p = p[(p**2).sum(1) < 1]
        x, y, z = (p * 11).T
        g = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)
        parts.append(p[g > 0.75])
    np.save(out / "gyroid.npy", np.concatenate(parts)[:n])


def glass(out):
    r = rng()
    counts = np.array([6, 8, 12, 16, 24, 34, 50, 70, 90])
    centers, sizes = packed(r, np.geomspace(0.6, 0.16, 9), counts, 12 * counts, (7, 7, 1.2))
    centers[:, 2] = sizes
    order = np.argsort(-sizes)
    kept = []
    for i in order:
        if all(np.linalg.norm(centers[i] - centers[j]) > sizes[i] + sizes[j] for j in kept):
            kept.append(i)
    colors = np.array([[0.95, 0.97, 0.96], [0.55, 0.8, 0.95], [0.98, 0.75, 0.4], [0.6, 0.9, 0.65],
                       [0.95, 0.55, 0.55]])
    color = colors[r.choice(5, len(kept), p=[0.4, 0.2, 0.15, 0.15, 0.1])]
    rows = np.column_stack([centers[kept], sizes[kept], color])
    np.savetxt(out / "glass.csv", rows, fmt="%.5g", delimiter=",", comments="",
               header="x,y,z,radius,red,green,blue")


ALL = [protein, water, beads, galaxy, gold, melt, chair, gyroid, glass]

if __name__ == "__main__":
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for make in ALL:
        if not sys.argv[2:] or make.__name__ in sys.argv[2:]:
            make(folder)
