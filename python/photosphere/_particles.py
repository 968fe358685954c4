"""Particles: columns of arrays, or of a file."""

from __future__ import annotations

import functools
import json
import os
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from . import _arrays, _core
from ._options import LookOptions, Options, ReadOptions, ViewOptions, check_names

if TYPE_CHECKING:
    from typing_extensions import Unpack

    import numpy as np

    from ._picture import Picture
    from ._render import Render
    from ._scene import Scene

__all__ = ["By", "Cell", "Particles", "by", "read", "spheres"]

#: The column of colours that an array gives.
_VALUE = "value"

#: Types of columns that are kept as they are.
_KINDS = {"uint8": "u8", "int32": "i32", "int64": "i64", "float32": "f32"}


@dataclass(frozen=True)
class By:
    """Colours by a column or an array, through a map. Made by `by`."""

    values: Any
    colormap: str | None = None
    range: tuple[float | str, float | str] | str | None = None
    title: str | None = None
    unit: str | None = None
    log: bool = False

    def options(self) -> dict[str, Any]:
        """The options of the command line that say this."""
        column = self.values if isinstance(self.values, str) else _VALUE
        title = self.title
        if self.unit is not None:
            title = f"{title if title is not None else column} ({self.unit})"
        given = {
            "color": column,
            "colormap": self.colormap,
            "range": self.range,
            "title": title,
            "log": self.log or None,
        }
        return {name: one for name, one in given.items() if one is not None}


def by(
    values: Any,
    colormap: str | None = None,
    *,
    range: tuple[float | str, float | str] | str | None = None,
    title: str | None = None,
    unit: str | None = None,
    log: bool = False,
) -> By:
    """Colours by numbers or words.

    Args:
        values: An array (n,), or the name of a column, or an expression such as "c_pe / mass".
        colormap: "viridis", "batlow", "vik", ... [default: viridis]
        range: The numbers at the ends of the map; "p1" is a percentile.
        title: The title of the colour bar [default: the column].
        unit: Its unit, in brackets after the title.
        log: Map the logarithm.
    """
    return By(values, colormap, range, title, unit, log)


@dataclass(frozen=True)
class Cell:
    """A simulation cell: three edges (rows) that start at the origin."""

    vectors: Any
    origin: Sequence[float] = (0.0, 0.0, 0.0)
    periodic: Sequence[bool] = (True, True, True)

    def numbers(self) -> tuple[list[float], list[list[float]], list[bool]]:
        """Origin, edges and periodicity as plain numbers."""
        vectors = [[float(one) for one in edge] for edge in self.vectors]
        if [len(edge) for edge in vectors] != [3, 3, 3]:
            raise ValueError("cell: expected three edges of three numbers")
        origin, periodic = [float(one) for one in self.origin], [bool(p) for p in self.periodic]
        return origin, vectors, periodic


class Particles:
    """Particles as columns: positions, and a number or word for each.

    Args:
        positions: (n, 3), in any unit of length and any type of numbers.
        radius: (n,) or one number, in the same unit [default: half the typical distance].
        color: (n, 3) sRGB, as bytes or from 0 to 1; or a colour such as "gold", or `by(...)`.
        cell: The simulation cell.
        unit: The unit of length, for scale bars: "Å" or "nm".
        nan: "drop" leaves out rows whose position is not finite; otherwise they are an error.
        columns: Further columns: arrays (n,) of numbers or words, such as element=["O", "H"].

    The arrays are not copied: a scene takes its copy when it is made.

    Raises:
        ValueError: An array has a wrong shape, type or number; the message names it.
    """

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
        self._file: _File | None = None
        self._bonds: Any = None
        self._options: dict[str, Any] = {}
        self._positions: Any = _arrays.positions(positions)
        self._columns: dict[str, Any] = {}
        self._unit = unit
        if isinstance(cell, bool):
            raise ValueError("cell: expected a cell; to draw it, say scene(cell=True)")
        self._cell = cell if cell is None or isinstance(cell, Cell) else Cell(cell)
        keep = _kept_rows(self._positions, nan)
        if keep is not None:
            self._positions = self._positions[keep]

        def take(array: Any) -> Any:
            return array if keep is None else array[keep]

        self._take = take
        for name, values in columns.items():
            self._add(name, take(_as_array(values)))
        given = {"radius": radius, "color": color}
        self._options.update(self._absorb({k: v for k, v in given.items() if v is not None}))

    @classmethod
    def _of_file(cls, file: _File, options: dict[str, Any]) -> Particles:
        self = cls.__new__(cls)
        self._file, self._options = file, options
        self._positions, self._columns = None, {}
        self._unit, self._cell, self._bonds = None, None, None
        return self

    @property
    def n(self) -> int:
        """The number of particles."""
        return len(self)

    def __len__(self) -> int:
        return self._file.count() if self._file else len(self._positions)

    @property
    def columns(self) -> list[str]:
        """Names of the columns, without the positions."""
        return self._file.column_names() if self._file else list(self._columns)

    @property
    def positions(self) -> np.ndarray:
        """The positions, (n, 3)."""
        return self._file.read().positions() if self._file else self._positions

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

    def __getitem__(self, name: str) -> np.ndarray:
        """A column: numbers, or words."""
        import numpy as np

        if self._file is None:
            return self._columns[name]
        values, names = self._file.read().column(name)
        return values if names is None else np.array(names, dtype=str)[values]

    def frame(self, index: int) -> Particles:
        """Another frame of the file: 0 is the first, -1 the last."""
        if self._file is None:
            raise ValueError("frame: arrays have one frame")
        return Particles._of_file(replace(self._file, frame=index), dict(self._options))

    def where(self, condition: str) -> Particles:
        """Those that fulfil a condition such as "type == 2 && z < 10"."""
        other = object.__new__(Particles)
        other.__dict__.update(self.__dict__)
        earlier = self._options.get("select")
        select = condition if earlier is None else f"({earlier}) && ({condition})"
        other._options = {**self._options, "select": select}
        return other

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
        if name in ("x", "y", "z", "row"):
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
        take = getattr(self, "_take", lambda array: array)
        radius = options.get("radius")
        if radius is not None and not isinstance(radius, str):
            if getattr(radius, "ndim", None) == 0 or isinstance(radius, (int, float)):
                if not radius > 0:
                    raise ValueError(f"radius: expected a positive number, not {radius}")
                options["radius"] = float(radius)
            else:
                self._require_arrays("radius")
                self._add("radius", take(_as_array(radius)))
                options["radius"] = "radius"
        color = options.get("color")
        if isinstance(color, By):
            if not isinstance(color.values, str):
                self._require_arrays("color")
                self._add(_VALUE, take(_as_array(color.values)))
            options.update(color.options())
        elif color is not None and not isinstance(color, str):
            self._require_arrays("color")
            rows = take(_arrays.colors(color, "color"))
            if len(rows) != len(self._positions):
                raise ValueError(
                    f"color: expected {len(self._positions)} rows, not {len(rows)}"
                )
            for at, name in enumerate(("red", "green", "blue")):
                self._add(name, rows[:, at])
            options["color"] = "rgb"
        return options

    def _require_arrays(self, name: str) -> None:
        if self._file is not None:
            raise ValueError(f"{name}: name a column of the file, or read it into Particles")

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

    def _values_of(self, row: int) -> dict[str, Any]:
        """The values of a row, as plain Python values."""
        names = self.columns
        values = {name: self[name][row] for name in names}
        return {k: v.item() if hasattr(v, "item") else v for k, v in values.items()}

    def __getstate__(self) -> dict[str, Any]:
        state = dict(self.__dict__)
        state.pop("_take", None)
        return state


@dataclass(frozen=True)
class _File:
    """A particle file, which is read when something of it is asked for."""

    path: str
    format: str | None
    frame: int
    columns: tuple[str, ...] | None
    topology: str | None

    def survey(self, count: bool = False) -> dict[str, Any]:
        return json.loads(_core.survey(self.path, self.format, self.frame, self.topology, count))

    def frames(self) -> int:
        return int(self.survey(count=True)["frames"])

    def count(self) -> int:
        known = self.survey()["count"]
        return int(known) if known is not None else self.read().count()

    def column_names(self) -> list[str]:
        if self.columns is not None:
            return list(self.columns)
        return [column["name"] for column in self.survey()["columns"]]

    def read(self) -> _core.Columns:
        return _read(self, os.stat(self.path).st_mtime_ns)


@functools.lru_cache(maxsize=1)
def _read(file: _File, _changed: int) -> _core.Columns:
    columns = None if file.columns is None else list(file.columns)
    return _core.Columns.read(
        file.path, file.format, file.frame, columns, file.topology
    )


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
    return keep


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
    file = _File(path, input_format, frame, wanted, top)
    return Particles._of_file(file, {name: one for name, one in kept.items() if one is not None})
