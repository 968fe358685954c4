"""Particles: columns of arrays, or of a file."""

from __future__ import annotations

import difflib
import os
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from . import _arrays, _core
from ._file import ParticleFile
from ._options import LookOptions, Options, ReadOptions, ViewOptions, check_names
from ._values import VALUE, By, Cell, by

if TYPE_CHECKING:
    from typing_extensions import Unpack

    import numpy as np

    from ._picture import Picture
    from ._render import Render
    from ._scene import Scene

__all__ = ["By", "Cell", "Particles", "by", "read", "spheres"]

#: The coordinates as columns.
_AXES = ("x", "y", "z")

#: Options of a file that its particles no longer need once they are arrays.
_OF_FILE = ("input_format", "frame", "columns", "topology", "select")

#: Options that move particles before conditions see them.
_MOVES = ("unwrap", "center", "wrap")

#: Types of columns that are kept as they are.
_KINDS = {"uint8": "u8", "int32": "i32", "int64": "i64", "float32": "f32"}


class Particles:
    """Particles as columns: positions, and a number or word for each.

    `len(p)` is their number, `p["mass"]` a column, `"mass" in p` whether there is one, and
    `for name in p` goes through the names of all. `p.where(...)` or `p[mask]` keeps some of them.

    Args:
        positions: (n, 3), in any unit of length and any type of numbers.
        radius: (n,) or one number, in the same unit [default: half the typical distance].
        color: (n, 3) sRGB, as bytes or from 0 to 1; or a colour such as "gold", or `by(...)`.
        cell: The simulation cell: a `Cell`, or its three edges (3, 3).
        unit: The unit of length, for scale bars: "Å" or "nm".
        nan: "drop" leaves out rows whose position is not finite; otherwise they are an error.
        columns: Further columns: arrays (n,) of numbers or words, such as element=["O", "H"].

    The arrays are not copied: a scene takes its copy when it is made.

    Raises:
        ValueError: An array has a wrong shape, type or number; the message names it.
    """

    _file: ParticleFile | None
    _options: dict[str, Any]
    _positions: Any
    _columns: dict[str, Any]
    _unit: str | None
    _cell: Cell | None
    _bonds: Any
    # Rows of the arrays of the caller that these particles are, if not all; and how many those have.
    # Of a file, the rows that a condition keeps, once somebody has asked.
    _rows: Any
    _total: int
    # The atoms of balls and beads, and the row there of each.
    _atoms: tuple[Particles, Any] | None

    def __init__(
        self,
        positions: Any,
        *,
        radius: Any = None,
        color: Any = None,
        cell: Cell | Any = None,
        unit: str | None = None,
        nan: str | None = None,
        **columns: Any,
    ) -> None:
        self._clear()
        self._positions = _arrays.positions(positions)
        self._total = len(self._positions)
        self._unit = unit
        if isinstance(cell, bool):
            raise ValueError("cell: expected a cell; to draw it, say scene(cell=True)")
        self._cell = cell if cell is None or isinstance(cell, Cell) else Cell(cell)
        if self._cell is not None:
            self._cell.numbers()
        self._rows = _kept_rows(self._positions, nan)
        if self._rows is not None:
            self._positions = self._positions[self._rows]
        for name, values in columns.items():
            self._add(name, self._fit(_as_array(values)))
        given = {"radius": radius, "color": color}
        self._options.update(self._absorb({k: v for k, v in given.items() if v is not None}))

    @classmethod
    def _of_file(cls, file: ParticleFile, options: dict[str, Any]) -> Particles:
        self = cls.__new__(cls)
        self._clear()
        self._file, self._options = file, options
        return self

    def _clear(self) -> None:
        self._file, self._options = None, {}
        self._positions, self._columns = None, {}
        self._unit, self._cell, self._bonds = None, None, None
        self._rows, self._total, self._atoms = None, 0, None

    @property
    def n(self) -> int:
        """The number of particles."""
        return len(self)

    def __len__(self) -> int:
        if self._file is None:
            return len(self._positions)
        rows = self._selected()
        return self._file.count() if rows is None else len(rows)

    @property
    def columns(self) -> list[str]:
        """Names of the columns, without the positions."""
        return self._file.column_names() if self._file else list(self._columns)

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __contains__(self, name: object) -> bool:
        return name in self.columns or name in _AXES

    @property
    def positions(self) -> np.ndarray:
        """The positions, (n, 3)."""
        return self._positions if self._file is None else self._kept(self._file.read().positions())

    @property
    def rows(self) -> np.ndarray:
        """Rows of the arrays that were given, or of the file, that these particles are: (n,)."""
        import numpy as np

        if self._file is not None:
            rows = self._selected()
            return np.arange(self._file.count(), dtype=np.uint32) if rows is None else rows
        rows = self._all_rows()
        return np.arange(len(self), dtype=np.uint32) if rows is None else rows

    @property
    def cell(self) -> Cell | None:
        """The simulation cell."""
        if self._file is None:
            return self._cell
        cell = self._file.read().cell()
        return cell and Cell(cell[1], cell[0], cell[2])

    @property
    def frames(self) -> int:
        """The number of frames of a file; counting them may read all of it."""
        return self._file.frames() if self._file else 1

    def __getitem__(self, name: Any) -> Any:
        """A column by its name: numbers, or words, (n,). Of a mask: `where(mask)`.

        Raises:
            KeyError: There is no such column.
        """
        if not isinstance(name, str):
            return self.where(name)
        if name in self.columns:
            return self._kept(self._column(name))
        if name in _AXES:
            return self.positions[:, _AXES.index(name)]
        near = difflib.get_close_matches(name, [*self.columns, *_AXES], 1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        known = ", ".join(self.columns) or "none beside x, y and z"
        raise KeyError(f"there is no column {name!r}{hint} The columns are: {known}")

    def frame(self, index: int) -> Particles:
        """Another frame of the file: 0 is the first, -1 the last."""
        if self._file is None:
            raise ValueError("frame: arrays have one frame")
        options = {**self._options, "frame": index}
        return Particles._of_file(replace(self._file, frame=index), options)

    def where(self, condition: str | Any) -> Particles:
        """Those that fulfil a condition.

        Pictures still name rows of all particles: those of your arrays, or of the file.

        Args:
            condition: A text such as "type == 2 && z < 10", or a mask (n,) of booleans. By a text, a
                file is still read only where it is rendered; by a mask, it becomes arrays.

        Raises:
            Error: The text is wrong, or names no column.
            ValueError: The mask has another shape or type.
        """
        if not isinstance(condition, str):
            import numpy as np

            mask = _arrays.mask(condition, "condition", len(self))
            return self._in_memory()._at(np.flatnonzero(mask).astype(np.uint32))
        if self._file is None:
            return self._at(self._core_columns().selected(condition, [False] * 3))
        earlier = self._options.get("select")
        select = condition if earlier is None else f"({earlier}) && ({condition})"
        return Particles._of_file(self._file, {**self._options, "select": select})

    def scene(self, **options: Unpack[LookOptions]) -> Scene:
        """The scene of these particles: framed, lit, with radii and colours.

        The options are those of `photosphere render` for particle files, and `camera`, `background`
        and `material` also take objects such as `Sky()` and `Glass("bk7")`. Here the arrays are
        copied.
        """
        from ._scene import Scene

        return Scene._of_particles(self, dict(options))

    def render(
        self, width: int | None = None, height: int | None = None, **options: Unpack[Options]
    ) -> Picture:
        """Renders them: `scene` and `Scene.render` in one."""
        look, rest = _part(options)
        return self.scene(**look).render(width, height, **rest)

    def start(
        self, width: int | None = None, height: int | None = None, **options: Unpack[Options]
    ) -> Render:
        """Starts to render them: `scene` and `Scene.start` in one."""
        look, rest = _part(options)
        return self.scene(**look).start(width, height, **rest)

    def __repr__(self) -> str:
        what = f" of {self._file.path!r}" if self._file else ""
        return f"<{len(self)} particles{what}: {', '.join(self.columns) or 'positions'}>"

    # What follows is for scenes.

    def _add(self, name: str, values: Any) -> None:
        """Checks a column and keeps it."""
        if name in (*_AXES, "row"):
            raise ValueError(f"{name}: the coordinates and `row` are columns already")
        array, count = _as_array(values), len(self._positions)
        if array.dtype.kind in "USTO":
            _arrays.words(array, name, count)
        else:
            _arrays.numbers(array, name, count, positive=name == "radius")
        self._columns[name] = array

    def _absorb(self, options: dict[str, Any]) -> dict[str, Any]:
        """Turns arrays among the options into columns, and objects into plain options."""
        options = dict(options)
        radius = options.get("radius")
        if radius is not None and not isinstance(radius, str):
            if _arrays.is_number(radius):
                options["radius"] = _arrays.positive(radius, "radius")
            else:
                self._require_arrays("radius")
                if isinstance(radius, (Mapping, set)) or callable(radius):
                    raise ValueError(
                        f"radius: expected a number, an array ({len(self)},) or the name of a "
                        f"column, not {radius!r}"
                    )
                self._add("radius", self._fit(_as_array(radius)))
                options["radius"] = "radius"
        color = options.get("color")
        if isinstance(color, By):
            if not isinstance(color.values, str):
                self._require_arrays("color")
                values = self._fit(_as_array(color.values))
                if values.shape != (len(self),):
                    expected = f"expected an array of the shape ({len(self)},)"
                    raise ValueError(f"color: {expected}, not {values.shape}")
                self._add(VALUE, values)
            options.update(color.options())
        elif color is not None and not isinstance(color, str):
            self._require_arrays("color")
            rows = self._fit(_arrays.colors(color, "color"))
            if len(rows) != len(self):
                raise ValueError(f"color: expected {len(self)} rows, not {len(rows)}")
            for at, name in enumerate(("red", "green", "blue")):
                self._add(name, rows[:, at])
            options["color"] = "rgb"
        return options

    def _require_arrays(self, name: str) -> None:
        if self._file is not None:
            raise ValueError(f"{name}: name a column of the file, or read it into Particles")

    # Rows.

    def _fit(self, array: np.ndarray) -> np.ndarray:
        """Of an array for all rows of the caller, those of these particles."""
        if self._rows is None or array.ndim == 0 or len(array) != self._total:
            return array
        return array[self._rows]

    def _at(self, index: np.ndarray) -> Particles:
        """Some of these particles, which are in memory."""
        other = object.__new__(Particles)
        other.__dict__.update(self.__dict__)
        other._positions = self._positions[index]
        other._columns = {name: values[index] for name, values in self._columns.items()}
        other._rows = index if self._rows is None else self._rows[index]
        if self._bonds is not None:
            from ._bonds import bonds_within

            other._bonds = bonds_within(self._bonds, index)
        return other

    def _in_memory(self) -> Particles:
        """The particles as arrays."""
        if self._file is None:
            return self
        made = object.__new__(Particles)
        made._clear()
        core = self._file.read()
        made._total = core.count()
        made._rows = self._selected()
        made._positions = self._kept(core.positions())
        for name in core.names():
            if name not in (*_AXES, "row"):
                made._columns[name] = self._kept(self._column(name))
        made._cell, made._unit = self.cell, core.unit()
        made._options = {n: one for n, one in self._options.items() if n not in _OF_FILE}
        return made

    def _column(self, name: str) -> np.ndarray:
        """A column of all rows, before any condition."""
        import numpy as np

        if self._file is None:
            return self._columns[name]
        values, names = self._file.read().column(name)
        return values if names is None else np.array(names, dtype=str)[values]

    def _selected(self) -> Any:
        """Rows of the file that a condition keeps; None without one."""
        condition = self._options.get("select")
        if self._file is None or condition is None:
            return None
        if self._rows is None:
            moves = [bool(self._options.get(name)) for name in _MOVES]
            self._rows = self._file.read_for(condition).selected(condition, moves)
        return self._rows

    def _kept(self, array: np.ndarray) -> np.ndarray:
        rows = self._selected()
        return array if rows is None else array[rows]

    def _all_rows(self) -> Any:
        """Rows of the caller of all particles in memory; None if they are the same."""
        if self._atoms is None:
            return self._rows
        atoms, owners = self._atoms
        rows = atoms._all_rows()
        return owners if rows is None else rows[owners]

    def _row_and_values(self, index: int) -> tuple[int, dict[str, Any]]:
        """The row of the caller or of the file, and its values, of a particle of a scene."""
        if self._atoms is not None:
            atoms, owners = self._atoms
            return atoms._row_and_values(int(owners[index]))
        is_part = self._file is None and self._rows is not None
        row = int(self._rows[index]) if is_part else index
        values = {name: self._column(name)[index] for name in self.columns}
        return row, {k: v.item() if hasattr(v, "item") else v for k, v in values.items()}

    def _core_columns(self) -> _core.Columns:
        """A copy of the arrays, each by one pass."""
        numbers, words = [], []
        for name, array in self._columns.items():
            if array.dtype.kind in "USTO":
                codes, names = _arrays.words(array, name, len(self._positions))
                words.append((name, names, codes))
            else:
                kind = _KINDS.get(array.dtype.newbyteorder("=").name)
                if kind is None:
                    small = array.dtype.kind in "iu" and array.dtype.itemsize < 4
                    kind = "i32" if small else ("f32" if _arrays.is_single(array) else "f64")
                numbers.append((name, kind, array))
        cell = None if self._cell is None else self._cell.numbers()
        single = _arrays.is_single(self._positions)
        name = "arrays.npz"
        return _core.Columns(name, self._positions, single, numbers, words, cell, self._unit)


def _part(options: Any) -> tuple[dict[str, Any], dict[str, Any]]:
    """Options of the scene, and those of the render."""
    of_scene = set(LookOptions.__annotations__)
    look = {name: one for name, one in options.items() if name in of_scene}
    return look, {name: one for name, one in options.items() if name not in of_scene}


def _as_array(values: Any) -> np.ndarray:
    import numpy as np

    return values if isinstance(values, np.ndarray) else np.asarray(values)


def _kept_rows(positions: np.ndarray, nan: str | None) -> np.ndarray | None:
    import numpy as np

    if nan not in (None, "drop"):
        raise ValueError(f'nan: expected "drop" or None, not {nan!r}')
    if nan is None or positions.dtype.kind != "f":
        return None
    keep = np.isfinite(positions).all(axis=1)
    if keep.all():
        return None
    warnings.warn(f"{(~keep).sum()} rows are left out: not finite", stacklevel=3)
    return np.flatnonzero(keep).astype(np.uint32)


def spheres(
    positions: Any,
    radius: Any = None,
    *,
    cell: Cell | Any = None,
    nan: str | None = None,
    values: dict[str, Any] | None = None,
    **options: Unpack[ViewOptions],
) -> Scene:
    """The scene of spheres in arrays: framed, lit and ready to render.

    Args:
        positions: (n, 3), any type of numbers and any strides; f64 is kept as f64.
        radius: One number or (n,), in the unit of the positions.
        cell: The simulation cell. To draw it: `Particles(..., cell=...).scene(cell=True)`.
        nan: "drop" leaves out rows that are not finite.
        values: Further columns (n,), for `select`, `color` and `pick`.
        options: `color=by(values, "batlow")`, `style`, `material`, `view`, ... as in `Particles.scene`.

    >>> import numpy as np, photosphere as ps
    >>> xyz = np.random.default_rng(0).uniform(-5, 5, (1000, 3))
    >>> ps.spheres(xyz, radius=0.4).render(64, 48, spp=4)
    <picture of 64 x 48 pixels, 4 samples per pixel>
    """
    check_names(options)
    particles = Particles(positions, radius=radius, cell=cell, nan=nan, **(values or {}))
    return particles.scene(**options)


def read(
    path: str | os.PathLike[str],
    *,
    frame: int = 0,
    columns: Sequence[str] | str | None = None,
    input_format: str | None = None,
    topology: str | os.PathLike[str] | None = None,
    **options: Unpack[ReadOptions],
) -> Particles:
    """The particles of a file: LAMMPS, (extended) XYZ, PDB, mmCIF, GRO, XTC, POSCAR, PLY, VTK, GSD,
    CSV, NPY, NPZ, also within gzip and Zstandard.

    Nothing is read before it is needed, and a scene never makes Python objects of it.

    Args:
        path: The file.
        frame: 0 is the first, -1 the last.
        columns: A list of the columns to read [default: all]; or, as a text, names for the columns
            of a file that names none, such as "x,y,z,radius".
        input_format: The format [default: by content].
        topology: The file with names and types for a trajectory without.
        options: Options of the scene.
    """
    check_names(options)
    path = os.fspath(path)
    os.stat(path)
    given = {"frame": frame or None, "input_format": input_format, "topology": topology}
    named = columns if isinstance(columns, str) else None
    kept = {**given, "columns": named, **options}
    wanted = None if columns is None or named is not None else tuple(columns)
    top = None if topology is None else os.fspath(topology)
    names = () if named is None else tuple(name.strip() for name in named.split(","))
    file = ParticleFile(path, input_format, frame, wanted, top, names)
    return Particles._of_file(file, {name: one for name, one in kept.items() if one is not None})
