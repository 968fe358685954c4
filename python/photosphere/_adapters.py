"""Particles of other packages. None of them is imported here: their objects bring what is needed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._bonds import STYLES, bonds_within
from ._particles import Cell, Particles

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._options import LookOptions
    from ._scene import Scene

__all__ = ["from_ase", "from_gsd", "from_mdanalysis", "from_ovito", "from_pyvista"]


def from_ase(atoms: Any, **options: Unpack[LookOptions]) -> Scene:
    """The scene of ASE's `Atoms`: positions, elements, cell, and all arrays as columns.

    Args:
        atoms: `ase.Atoms`.
        options: Those of `Particles.scene`; style="ball-and-stick" also draws bonds.
    """
    import numpy as np

    columns: dict[str, Any] = {"element": np.array(atoms.get_chemical_symbols())}
    for name, values in atoms.arrays.items():
        if name not in ("positions", "numbers"):
            _add(columns, name, values)
    edges = np.asarray(atoms.cell[:])
    has_cell = bool(np.abs(np.linalg.det(edges)) > 0)
    cell = Cell(edges, periodic=list(atoms.pbc)) if has_cell else None
    return _scene(np.asarray(atoms.positions), columns, cell, "Å", options)


def from_mdanalysis(atoms: Any, **options: Unpack[LookOptions]) -> Scene:
    """The scene of an `AtomGroup` or a `Universe` of MDAnalysis, in its present frame.

    Args:
        atoms: `universe.select_atoms(...)`, or the universe.
        options: Those of `Particles.scene`.
    """
    import numpy as np

    atoms = getattr(atoms, "atoms", atoms)
    columns: dict[str, Any] = {}
    names = {"elements": "element", "names": "name", "resnames": "resname", "resids": "resid",
             "masses": "mass", "charges": "charge", "radii": "radius", "segids": "segid"}
    for theirs, ours in names.items():
        values = _attribute(atoms, theirs)
        if values is not None and not (ours == "radius" and np.min(values) <= 0):
            _add(columns, ours, values)
    if "element" not in columns and "name" in columns:
        columns["element"] = np.array([_element_of(str(name)) for name in columns["name"]])
    box = _attribute(atoms, "dimensions")
    cell = None if box is None or not np.all(np.asarray(box[:3]) > 0) else Cell(_edges(box))
    made, bonds = _particles(np.asarray(atoms.positions), columns, cell, "Å"), None
    if options.get("style") == "ball-and-stick":
        bonds = _attribute(atoms, "bonds")
    if bonds is not None:
        made._bonds = bonds_within(bonds, np.asarray(atoms.indices))
    return _look(made, options)


def from_ovito(data: Any, **options: Unpack[LookOptions]) -> Scene:
    """The scene of OVITO's `DataCollection`: Position, Radius, Color, types with their names, radii
    and colours, the cell, bonds, and all other properties as columns.

    Transparent particles are drawn opaque, and fully transparent ones are left out.

    Args:
        data: `pipeline.compute(frame)`.
        options: Those of `Particles.scene`.
    """
    import numpy as np

    particles = data.particles
    positions = np.asarray(particles["Position"])
    columns: dict[str, Any] = {}
    for name in particles.keys():
        if name not in ("Position", "Radius", "Color", "Particle Type", "Transparency"):
            _add(columns, name.replace(" ", "_"), np.asarray(particles[name]))
    types = _get(particles, "Particle Type")
    radius, color = _get(particles, "Radius"), _get(particles, "Color")
    if types is not None:
        ids = np.asarray(types)
        by_id = {one.id: one for one in types.types}
        columns["type"] = np.array([_type_name(by_id.get(int(one)), one) for one in ids])
        if radius is None:
            radii = {at: float(getattr(one, "radius", 0.0)) for at, one in by_id.items()}
            if radii and min(radii.values()) > 0:
                radius = np.array([radii.get(int(one), 1.0) for one in ids])
        if color is None and by_id and "color" not in options:
            colors = {at: tuple(one.color) for at, one in by_id.items()}
            color = np.array([colors.get(int(one), (0.5, 0.5, 0.5)) for one in ids], dtype=float)
    if radius is not None and np.all(np.asarray(radius) > 0):
        columns["radius"] = np.asarray(radius)
    if color is not None and "color" not in options:
        options["color"] = np.asarray(color)
    look: dict[str, Any] = dict(options)
    transparency = _get(particles, "Transparency")
    visible = None if transparency is None else np.asarray(transparency) < 1.0
    cell = getattr(data, "cell", None)
    if cell is not None:
        matrix = np.asarray(cell[...] if hasattr(cell, "__getitem__") else cell)
        cell = Cell(matrix[:, :3].T, matrix[:, 3].tolist(), list(getattr(cell, "pbc", (True,) * 3)))
    made = _particles(positions, columns, cell, None)
    bonds = getattr(particles, "bonds", None)
    if bonds is not None:
        made._bonds = np.asarray(bonds["Topology"])
    if visible is not None and not visible.all():
        made = made.where(visible)
    return _look(made, look)


def from_pyvista(mesh: Any, **options: Unpack[LookOptions]) -> Scene:
    """The scene of the points of a PyVista mesh, with its point data as columns.

    Args:
        mesh: `pyvista.PolyData`, or any mesh with `points` and `point_data`.
        options: Those of `Particles.scene`. Columns `radius` and `diameter` are used by themselves.
    """
    import numpy as np

    columns: dict[str, Any] = {}
    for name in mesh.point_data.keys():
        _add(columns, name, np.asarray(mesh.point_data[name]))
    return _scene(np.asarray(mesh.points), columns, None, None, options)


def from_gsd(snapshot: Any, **options: Unpack[LookOptions]) -> Scene:
    """The scene of a frame of GSD: types, diameters, and the box.

    Args:
        snapshot: A frame, `gsd.hoomd.open(path)[-1]`.
        options: Those of `Particles.scene`. Files of GSD can also be read by `read`.
    """
    import numpy as np

    particles = snapshot.particles
    positions = np.asarray(particles.position)
    count = len(positions)
    columns: dict[str, Any] = {}
    types = list(particles.types or ["A"])
    ids = np.zeros(count, int) if particles.typeid is None else np.asarray(particles.typeid)
    columns["type"] = np.array([types[one] for one in ids])
    for name in ("mass", "charge", "body"):
        values = getattr(particles, name, None)
        if values is not None:
            _add(columns, name, values)
    diameter = getattr(particles, "diameter", None)
    columns["radius"] = 0.5 * (np.ones(count) if diameter is None else np.asarray(diameter))
    cell = None
    box = getattr(getattr(snapshot, "configuration", None), "box", None)
    if box is not None:
        lx, ly, lz, xy, xz, yz = (float(one) for one in box)
        edges = np.array([[lx, 0, 0], [xy * ly, ly, 0], [xz * lz, yz * lz, lz]])
        cell = Cell(edges, (-0.5 * edges.sum(axis=0)).tolist())
    return _scene(positions, columns, cell, None, options)


# What the adapters share.


def _scene(
    positions: Any, columns: dict[str, Any], cell: Any, unit: Any, options: Any
) -> Scene:
    return _look(_particles(positions, columns, cell, unit), options)


def _look(particles: Particles, options: Any) -> Scene:
    """The scene of particles, whose radii are not those of balls between sticks."""
    if options.get("style") in STYLES:
        options = {"radius": "auto", **options}
    return particles.scene(**options)


def _particles(positions: Any, columns: dict[str, Any], cell: Any, unit: Any) -> Particles:
    columns = {name: one for name, one in columns.items() if name not in ("x", "y", "z", "row")}
    radius = columns.pop("radius", None)
    return Particles(positions, radius=radius, cell=cell, unit=unit, **columns)


def _add(columns: dict[str, Any], name: str, values: Any) -> None:
    """Adds a column; of vectors, one for each component; nothing of other arrays."""
    import numpy as np

    array = np.asarray(values)
    if array.dtype.kind == "O":
        array = np.array([str(one) for one in array.flat]).reshape(array.shape)
    if array.ndim == 1:
        columns[name] = array
    elif array.ndim == 2 and array.shape[1] == 3:
        for at, axis in enumerate("xyz"):
            columns[f"{name}_{axis}"] = array[:, at]


def _attribute(owner: Any, name: str) -> Any:
    """An attribute, or None: MDAnalysis has errors of its own for those that a file lacks."""
    try:
        return getattr(owner, name)
    except Exception:  # noqa: BLE001
        return None


def _get(mapping: Any, name: str) -> Any:
    return mapping[name] if name in mapping.keys() else None


def _type_name(kind: Any, at: Any) -> str:
    return str(getattr(kind, "name", "") or at)


def _element_of(name: str) -> str:
    """The element of an atom's name such as CA or HG21: the first letter, by the usual names."""
    letters = name.strip().lstrip("0123456789")
    return letters[:1].upper() or "C"


def _edges(box: Any) -> Any:
    """Edges from lengths and angles in degrees: a along x, b in the plane of x and y."""
    import numpy as np

    a, b, c = (float(one) for one in box[:3])
    cos_a, cos_b, cos_c = np.cos(np.radians([float(one) for one in box[3:6]]))
    sin_c = float(np.sqrt(1 - cos_c**2))
    y = (cos_a - cos_b * cos_c) / sin_c
    z = float(np.sqrt(max(0.0, 1 - cos_b**2 - y**2)))
    return np.array([[a, 0, 0], [b * cos_c, b * sin_c, 0], [c * cos_b, c * y, c * z]])
