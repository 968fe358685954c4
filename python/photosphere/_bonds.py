"""Ball-and-stick: bonds as rows of small spheres, each half in the colour of its atom.

A scene has spheres only; beads that overlap by seven eighths look like a stick.
"""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

from . import _arrays, _core

if TYPE_CHECKING:
    import numpy as np

    from ._particles import Particles

__all__ = ["STYLES", "bonds_within", "find_bonds", "with_bonds"]

#: Styles that draw bonds, beside those of the command line.
STYLES = ("ball-and-stick",)

#: Radius of a ball in covalent radii, and of a stick in angstrom.
_BALL, _STICK = 0.55, 0.14

#: Atoms nearer than this in sums of covalent radii are bonded; nearer than 0.4 they are one.
_REACH, _MIN_REACH = 1.2, 0.4

#: Beads along a stick, in radii.
_STEP = 0.25

#: What is behind balls and sticks: white would hide hydrogen.
_BACKDROP = "#94a8b9"

#: From this number of beads on, a warning says how many there are.
_MANY = 2_000_000

#: Memory that a bead takes while a scene is made, in bytes.
_BYTES = 100

#: Radius and covalent radius of labels that are no elements, in angstrom.
_UNKNOWN = (0.77, 1.7)


def with_bonds(
    particles: Particles, options: dict[str, Any]
) -> tuple[Particles, dict[str, Any]]:
    """Balls for atoms and beads for bonds, and the options without the style.

    Raises:
        ValueError: The particles have no elements, or an option is wrong.
    """
    import numpy as np

    from ._particles import Particles as Made

    atoms, options = _atoms(particles, options)
    scale = 0.1 if atoms._unit == "nm" else 1.0
    covalent, vdw = (scale * radii for radii in _radii_of_elements(atoms._columns))
    balls = _balls(atoms, options.get("radius"), covalent, vdw)
    positions = np.asarray(atoms.positions, dtype=np.float64)
    bonds = atoms._bonds if atoms._bonds is not None else find_bonds(positions, covalent)
    bonds = np.asarray(bonds, dtype=np.int64).reshape(-1, 2)
    beads, owners = _beads(positions, bonds, scale * _STICK)
    rows = np.concatenate([np.arange(len(positions)), owners])
    columns = {name: values[rows] for name, values in atoms._columns.items()}
    columns["radius"] = np.concatenate([balls, np.full(len(beads), scale * _STICK)])
    centers = np.concatenate([positions, beads])
    made = Made(centers, cell=atoms.cell, unit=atoms._unit, **columns)
    made._atoms = atoms, rows.astype(np.uint32)
    options.setdefault("color", "element")
    options.setdefault("background", _BACKDROP)
    return made, {**options, "radius": "radius"}


def _atoms(
    particles: Particles, options: dict[str, Any]
) -> tuple[Particles, dict[str, Any]]:
    """The atoms in memory that are drawn, with arrays of the options as columns."""
    from ._particles import _OF_FILE
    from ._particles import Particles as Made

    select = options.get("select")
    if particles._file is not None:
        atoms = Made._of_file(particles._file, options)._in_memory()
    else:
        atoms = Made.__new__(Made)
        atoms.__dict__.update(particles.__dict__, _columns=dict(particles._columns))
    rest = {n: one for n, one in options.items() if n != "style" and n not in _OF_FILE}
    # Arrays are as long as all atoms.
    rest = atoms._absorb(rest)
    if particles._file is None and select is not None:
        atoms = atoms.where(select)
    if not len(atoms):
        raise ValueError("select: no particle fulfils the condition")
    return atoms, rest


def _radii_of_elements(columns: dict[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Covalent and van der Waals radius of each atom, in angstrom."""
    import numpy as np

    symbols, codes = np.unique(_elements(columns), return_inverse=True)
    known = [(_core.element(str(symbol)) or _UNKNOWN)[:2] for symbol in symbols]
    radii = np.array(known)[codes]
    return radii[:, 0], radii[:, 1]


def _balls(
    atoms: Particles, radius: Any, covalent: np.ndarray, vdw: np.ndarray
) -> np.ndarray:
    """The radius of each ball."""
    import numpy as np

    if radius in (None, "auto"):
        return _BALL * covalent
    if radius in ("covalent", "vdw"):
        return covalent if radius == "covalent" else vdw
    if radius == "spacing":
        raise ValueError('radius: "spacing" is no radius of balls; give a number or a column')
    if not isinstance(radius, str):
        return np.full(len(covalent), float(radius))
    balls = atoms._core_columns().radii(radius)
    return _arrays.numbers(balls, "radius", len(covalent), positive=True)


def find_bonds(positions: np.ndarray, covalent: np.ndarray) -> np.ndarray:
    """Pairs of atoms that are near enough for a bond, by a grid of cells as large as the longest."""
    import numpy as np

    size = max(_REACH * 2.0 * float(covalent.max(initial=0.0)), 1e-9)
    extent = np.ptp(positions, axis=0)
    # The cells are numbered in 64 bits.
    size = max(size, float(extent.max(initial=0.0)) / 1e6)
    cells = np.floor((positions - positions.min(axis=0)) / size).astype(np.int64) + 1
    _, rows, layers = (int(one) + 2 for one in cells.max(axis=0))
    number = (cells[:, 0] * rows + cells[:, 1]) * layers + cells[:, 2]
    order = np.argsort(number, kind="stable")
    sorted_numbers = number[order]
    steps = [(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1)]
    pairs = [np.empty((0, 2), dtype=np.int64)]
    # Half of the neighbours: each pair is found from one of its atoms.
    for i, j, k in steps[13:]:
        there = number + (i * rows + j) * layers + k
        begin = np.searchsorted(sorted_numbers, there, "left")
        count = np.searchsorted(sorted_numbers, there, "right") - begin
        first = np.repeat(np.arange(len(positions)), count)
        second = order[np.repeat(begin, count) + _counted(count)]
        if (i, j, k) == (0, 0, 0):
            first, second = first[first < second], second[first < second]
        apart = np.linalg.norm(positions[first] - positions[second], axis=1)
        reach = covalent[first] + covalent[second]
        good = (apart < _REACH * reach) & (apart > _MIN_REACH * reach)
        pairs.append(np.sort(np.stack([first[good], second[good]], axis=1), axis=1))
    found = np.concatenate(pairs)
    return found[np.lexsort((found[:, 1], found[:, 0]))]


def bonds_within(bonds: Any, indices: Any) -> np.ndarray:
    """Pairs of places in `indices`, of bonds between indices that are all there."""
    import numpy as np

    pairs = np.asarray(bonds.indices if hasattr(bonds, "indices") else bonds).reshape(-1, 2)
    if not len(indices):
        return np.empty((0, 2), dtype=np.int64)
    order = np.argsort(indices)
    at = np.searchsorted(indices, pairs, sorter=order)
    place = order[np.minimum(at, len(indices) - 1)]
    return place[(indices[place] == pairs).all(axis=1)]


def _counted(counts: np.ndarray) -> np.ndarray:
    """0, 1, 2 ... anew for each count."""
    import numpy as np

    return np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)


def _beads(
    positions: np.ndarray, bonds: np.ndarray, stick: float
) -> tuple[np.ndarray, np.ndarray]:
    """Centres of beads, and the atom whose colour each has."""
    import numpy as np

    first, second = bonds[:, 0], bonds[:, 1]
    along = positions[second] - positions[first]
    counts = np.ceil(np.linalg.norm(along, axis=1) / (_STEP * stick)).astype(np.int64)
    counts = np.maximum(counts, 2)
    _check_count(len(positions), len(bonds), int(counts.sum()))
    bond = np.repeat(np.arange(len(bonds)), counts)
    share = (_counted(counts) + 0.5) / counts[bond]
    centers = positions[first[bond]] + share[:, None] * along[bond]
    return centers, np.where(share < 0.5, first[bond], second[bond])


def _check_count(atoms: int, bonds: int, beads: int) -> None:
    """Warns of very many beads, and refuses more than a scene can have."""
    if atoms + beads > _arrays.MOST_ROWS:
        raise ValueError(f"style: {bonds} bonds take {beads} beads, more than a scene can have")
    if beads > _MANY:
        memory = beads * _BYTES / 2**30
        warnings.warn(
            f"style: {bonds} bonds take {beads} beads, about {memory:.1f} GiB of memory; "
            "`select` leaves atoms out, and other styles draw no bonds",
            stacklevel=6,
        )


def _elements(columns: dict[str, np.ndarray]) -> np.ndarray:
    for name in ("element", "species", "symbol", "type"):
        if name in columns and columns[name].dtype.kind in "UST":
            return columns[name].astype(str)
    raise ValueError('style: "ball-and-stick" needs a column `element` of words such as "C"')
