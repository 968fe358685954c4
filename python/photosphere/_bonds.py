"""Ball-and-stick: bonds as rows of small spheres, each half in the colour of its atom.

A scene has spheres only; beads that overlap by seven eighths look like a stick.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import _core

if TYPE_CHECKING:
    import numpy as np

    from ._particles import Particles

__all__ = ["STYLES", "find_bonds", "with_bonds"]

#: Styles that draw bonds, beside those of the command line.
STYLES = ("ball-and-stick",)

#: Radius of a ball in covalent radii, and of a stick in angstrom.
_BALL, _STICK = 0.55, 0.14

#: Atoms nearer than this in sums of covalent radii are bonded; nearer than 0.4 they are one.
_REACH, _MIN_REACH = 1.2, 0.4

#: Beads along a stick, in radii.
_STEP = 0.25


def with_bonds(
    particles: Particles, options: dict[str, Any]
) -> tuple[Particles, dict[str, Any]]:
    """Particles with beads for bonds, and the options without the style.

    Raises:
        ValueError: The particles have no elements, or are in a file.
    """
    import numpy as np

    from ._particles import Particles as Made

    options = {name: one for name, one in options.items() if name != "style"}
    positions = np.asarray(particles.positions, dtype=np.float64)
    columns: dict[str, Any] = {n: np.asarray(particles[n]) for n in particles.columns}
    elements = _elements(columns)
    known = {symbol: _core.element(symbol) for symbol in np.unique(elements)}
    covalent = np.array([(known[symbol] or (0.77,))[0] for symbol in elements])
    bonds = particles._bonds
    if bonds is None:
        bonds = find_bonds(positions, covalent)
    beads, owner = _beads(positions, np.asarray(bonds, dtype=np.int64).reshape(-1, 2))
    radius = np.concatenate([_BALL * covalent, np.full(len(beads), _STICK)])
    rows = np.concatenate([np.arange(len(positions)), owner])
    columns["radius"] = radius
    made = Made(
        np.concatenate([positions, beads]),
        cell=particles.cell,
        unit=particles._unit,
        **{name: one if name == "radius" else one[rows] for name, one in columns.items()},
    )
    options.setdefault("color", "element")
    return made, {**options, "radius": "radius"}


def find_bonds(positions: np.ndarray, covalent: np.ndarray) -> np.ndarray:
    """Pairs of atoms that are near enough for a bond, by a grid of cells as large as the longest."""
    import numpy as np

    longest = _REACH * 2.0 * float(covalent.max(initial=0.0))
    keys = np.floor((positions - positions.min(axis=0)) / max(longest, 1e-9)).astype(np.int64)
    cells: dict[tuple[int, ...], list[int]] = {}
    for at, key in enumerate(map(tuple, keys)):
        cells.setdefault(key, []).append(at)
    near = [(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1)]
    pairs = []
    for key, here in cells.items():
        around = [tuple(a + b for a, b in zip(key, step)) for step in near]
        others = np.array([at for cell in around for at in cells.get(cell, ())])
        for at in here:
            far = others[others > at]
            apart = np.linalg.norm(positions[far] - positions[at], axis=1)
            reach = covalent[far] + covalent[at]
            good = (apart < _REACH * reach) & (apart > _MIN_REACH * reach)
            pairs += [(at, int(other)) for other in far[good]]
    return np.array(pairs, dtype=np.int64).reshape(-1, 2)


def _beads(positions: np.ndarray, bonds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Centres of beads, and the atom whose colour each has."""
    import numpy as np

    centers, owners = [], []
    for first, second in bonds:
        a, b = positions[first], positions[second]
        count = max(2, int(np.ceil(np.linalg.norm(b - a) / (_STEP * _STICK))))
        share = (np.arange(count) + 0.5) / count
        centers.append(a + share[:, None] * (b - a))
        owners.append(np.where(share < 0.5, first, second))
    if not centers:
        return np.empty((0, 3)), np.empty(0, dtype=np.int64)
    return np.concatenate(centers), np.concatenate(owners)


def _elements(columns: dict[str, np.ndarray]) -> np.ndarray:
    for name in ("element", "species", "symbol", "type"):
        if name in columns and columns[name].dtype.kind in "UST":
            return columns[name].astype(str)
    raise ValueError('style: "ball-and-stick" needs a column `element`')
