"""Scenes: immutable, made of particles, of a file, or of objects."""

from __future__ import annotations

import dataclasses
import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _arrays, _core, _toml
from ._errors import Error
from ._options import LookOptions, Options, PartOptions, check_names, split

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._objects import AnyBackground, AnyCamera, Material, Sphere, Spheres
    from ._particles import Particles
    from ._picture import Pick, Picture
    from ._render import Part, Render

__all__ = ["Plan", "Scene", "scene"]


class Scene:
    """A scene: camera, background, materials and spheres.

    `Scene(...)` makes one of objects; `scene(path)` reads a file; `spheres(...)` and
    `Particles.scene(...)` frame and light particles. A scene never changes: `replace` makes another
    one. It can be pickled, with its arrays.

    Args:
        spheres: Spheres of their own and tables of many.
        camera: A camera.
        background: One or several backgrounds such as `Sky()` and `Sun(...)`, a radiance, or a
            colour such as "white"; "none" is transparent [default: black].
        light: Light by name, in place of that of a background: "softbox", "rembrandt", "cloudy" or
            "sun"; or the table `light` of a scene file, such as {"preset": "sun", "strength": 2}.
        materials: Materials by name, for spheres that name theirs.
        image: The table `image` of a scene file, such as {"width": 800, "height": 600}.
        render: The table `render`, such as {"samples_per_pixel": 256}.
        folder: Where relative paths start.

    Raises:
        Error: A key is unknown or its value is wrong; all mistakes are listed.
        ValueError: An array is wrong; the message names it.
    """

    _core: _core.Scene
    # A scene of objects has a document, one of a file has a path, one of particles has these.
    _document: dict[str, Any] | None
    _folder: str
    _tables: list[Spheres]
    _path: str | None
    _particles: Particles | None
    _options: dict[str, Any]
    _facts: dict[str, Any] | None

    def __init__(
        self,
        spheres: Sequence[Sphere | Spheres],
        *,
        camera: AnyCamera | None = None,
        background: AnyBackground | Sequence[AnyBackground] | None = None,
        light: str | Mapping[str, Any] | None = None,
        materials: Mapping[str, Material] | None = None,
        image: Mapping[str, Any] | None = None,
        render: Mapping[str, Any] | None = None,
        folder: str | os.PathLike[str] = "",
    ) -> None:
        from ._objects import Sphere, Spheres, background_table, camera_table

        document: dict[str, Any] = {"format": 1}
        if image:
            document["image"] = dict(image)
        document["camera"] = _Camera if camera is None else camera_table(camera)
        if background is not None:
            document["background"] = background_table(background)
        if light is not None:
            document["light"] = {"preset": light} if isinstance(light, str) else dict(light)
        named = {name: one.toml() for name, one in (materials or {}).items()}
        document["materials"] = named
        tables: list[Spheres] = []
        for one in spheres:
            if isinstance(one, Spheres):
                tables.append(_checked(one))
                entry: dict[str, Any] = {"file": f"table-{len(tables)}.npy", "name": one.name}
                entry["color_space"] = one.color_space
            elif isinstance(one, Sphere):
                entry = one.toml()
            else:
                raise TypeError(f"spheres: expected Sphere or Spheres, not {one!r}")
            entry["material"] = _material_name(one.material, named)
            entry = {key: value for key, value in entry.items() if value is not None}
            where = "sphere_tables" if isinstance(one, Spheres) else "spheres"
            document.setdefault(where, []).append(entry)
        if render:
            document["render"] = dict(render)
        self._set_document(document, os.fspath(folder), tables)
        self._describe()

    # Ways to make one.

    def _set_document(self, document: dict[str, Any], folder: str, tables: list[Spheres]) -> None:
        self._clear()
        self._document = document
        self._folder, self._tables = folder, tables
        text = _toml.document(document)
        self._core = _core.Scene.text("the scene", text, folder, [_core_spheres(t) for t in tables])

    def _clear(self) -> None:
        self._document = None
        self._folder, self._tables = "", []
        self._path, self._particles = None, None
        self._options, self._facts = {}, None

    @classmethod
    def _of_file(cls, path: str, options: dict[str, Any]) -> Scene:
        self = cls.__new__(cls)
        self._clear()
        self._path, self._options = path, options
        self._core = _core.Scene.file(path)
        return self

    @classmethod
    def _of_particles(cls, particles: Particles, options: dict[str, Any]) -> Scene:
        from . import _bonds

        check_names(options)
        options = {**particles._options, **_given(options)}
        if options.get("style") in _bonds.STYLES:
            particles, options = _bonds.with_bonds(particles, options)
        if particles._file is not None:
            options = particles._absorb(options)
            return cls._of_file(particles._file.path, options)._with_particles(particles)
        own = object.__new__(type(particles))
        own.__dict__.update(particles.__dict__, _columns=dict(particles._columns))
        if not len(own):
            raise ValueError("where: no particle fulfils the condition")
        options = own._absorb(options)
        self = cls.__new__(cls)
        self._clear()
        self._options = options
        words, changes = split(options, of_particles=True)
        self._core = _core.Scene.particles(
            own._core_columns(), "arrays.npz", words, changes
        )
        return self._with_particles(own)

    def _with_particles(self, particles: Particles) -> Scene:
        self._particles = particles
        return self

    # What it is.

    def _describe(self) -> dict[str, Any]:
        if self._facts is None:
            self._facts = json.loads(self._core.describe(*self._split(self._options)))
        return self._facts

    def _split(self, options: Mapping[str, Any]) -> tuple[list[str], list[tuple[str, str]]]:
        """Options as words and changed keys."""
        return split(options, of_particles=self._particles is not None)

    @property
    def n(self) -> int:
        """The number of spheres, with those that frame and light add."""
        return int(self._describe()["spheres"])

    @property
    def toml(self) -> str:
        """The scene as the text of a scene file."""
        if self._document is not None:
            return _toml.document(self._document)
        text = self._describe()["text"]
        if text is None:
            text = Path(self._path or "").read_text(encoding="utf-8")
        _, changes = self._split(self._options)
        given = dict(self._options.get("set") or {})
        if not changes and not given:
            return str(text)
        document = _read(text)
        for key, one in changes:
            _set_key(document, key, _read(f"v = {one}")["v"])
        for key, one in given.items():
            _set_key(document, key, one)
        return _toml.document(document)

    @property
    def choices(self) -> dict[str, str]:
        """The options that were chosen automatically, with their values."""
        return dict(self._describe()["choices"])

    @property
    def notes(self) -> list[str]:
        """What is worth knowing of the file."""
        return list(self._describe()["notes"])

    @property
    def content_hash(self) -> str:
        """The identity of the scene: equal ones render to equal pictures."""
        return self._core.content_hash(*self._split(self._options))

    def __repr__(self) -> str:
        what = f" {self._path!r}" if self._path else ""
        return f"<scene{what} of {self.n} spheres>"

    # What is made of it.

    def start(
        self, width: int | None = None, height: int | None = None, **options: Unpack[Options]
    ) -> Render:
        """Starts a render and returns at once.

        Args:
            width: Of the picture, in pixels [default: that of the scene].
            height: Likewise.
            options: Those of `photosphere render`, by their names: `spp=256`, `noise="1%"`, ...
        """
        from ._render import Render

        return Render._start(self, self._merged(width, height, options))

    def render(
        self, width: int | None = None, height: int | None = None, **options: Unpack[Options]
    ) -> Picture:
        """Renders a picture; the arguments are those of `start`.

        Ctrl-C, or an interrupt of the kernel, stops the render and raises KeyboardInterrupt. To keep
        the samples so far, use `start`.
        """
        return self.start(width, height, **options).wait().picture

    def part(self, samples: tuple[int, int], **options: Unpack[PartOptions]) -> Part:
        """Renders some samples of every pixel, from the first up to but without the last, both
        multiples of 16. `merge` adds parts, exactly."""
        given = _given(options)
        if not isinstance(samples, (list, tuple)) or len(samples) != 2:
            expected = "the first and the end, such as (0, 256)"
            raise TypeError(f"samples: expected {expected}, not {samples!r}")
        if not {"spp", "noise", "quality", "time"} & set(given):
            given["spp"] = samples[1]
        return self.start(samples=samples, **given).wait().part

    def replace(
        self,
        *,
        materials: Mapping[str, Material] | None = None,
        spheres: Sequence[Sphere] | None = None,
        **options: Unpack[LookOptions],
    ) -> Scene:
        """Another scene with another camera, background, material or look.

        Args:
            materials: Materials by name, of a scene that is no particles.
            spheres: Replace all `[[spheres]]` of such a scene.
            options: `camera=...`, `background=...`, and options such as `style`.
        """
        changed: dict[str, Any] = {**self._options, **_given(options)}
        keys = dict(changed.get("set") or {})
        if materials is not None:
            keys.update({f"materials.{name}": one for name, one in materials.items()})
        if spheres is not None:
            named: dict[str, Any] = {}
            keys["spheres"] = [
                {**s.toml(), "material": _material_name(s.material, named)} for s in spheres
            ]
            keys.update({f"materials.{name}": one for name, one in named.items()})
        if keys:
            changed["set"] = keys
        if self._particles is not None and self._path is None:
            return Scene._of_particles(self._particles, changed)
        if self._path is not None:
            other = Scene._of_file(self._path, changed)
            return other._with_particles(self._particles) if self._particles else other
        other = Scene.__new__(Scene)
        document = dict(self._document or {})
        _, changes = split(changed)
        for key, one in changes:
            _set_key(document, key, _read(f"v = {one}")["v"])
        for key, one in keys.items():
            _set_key(document, key, one.toml() if hasattr(one, "toml") else one)
        other._set_document(document, self._folder, self._tables)
        other._describe()
        return other

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Writes the scene as a file, with its arrays in files beside it.

        Returns:
            The path of the scene file.
        """
        import numpy as np

        path = Path(path)
        text = self.toml
        if self._particles is not None and self._path is None:
            arrays = path.with_suffix(".npz")
            np.savez(arrays, **_named_arrays(self._particles))
            text = text.replace('"arrays.npz"', _toml.value(arrays.name))
        elif self._document is not None:
            for at, table in enumerate(self._tables, 1):
                name = f"{path.stem}-{at}.npy"
                np.save(path.with_name(name), _records(table))
                text = text.replace(f'"table-{at}.npy"', _toml.value(name))
        elif self._path is not None and Path(self._path).parent.resolve() != path.parent.resolve():
            text = _with_moved_files(text, Path(self._path).parent, path.parent)
        path.write_text(text, encoding="utf-8")
        return path

    def plan(
        self,
        shards: int,
        *,
        format: str = "shell",
        output: str | os.PathLike[str] = "picture.exr",
        **options: Unpack[PartOptions],
    ) -> Plan:
        """The commands that render this scene in parts on many machines.

        Args:
            shards: The number of parts.
            format: "shell", "slurm", ... as `photosphere plan --format`.
            output: The picture that the commands make.
            options: Those of `photosphere plan`.

        Raises:
            Error: The scene is not in a file: save it first.
        """
        if self._path is None:
            raise Error("a plan names a scene file", help='save the scene: scene.save("a.toml")')
        import subprocess
        import sys

        check_names(options)
        words, changes = self._split({**self._options, **_given(options)})
        words += [f"--set={key}={value}" for key, value in changes]
        command = [sys.executable, "-m", "photosphere", "plan", self._path, f"--shards={shards}"]
        command += [f"--format={format}", f"--output={os.fspath(output)}", *words]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise _plan_error(done.stderr)
        return Plan(done.stdout)

    def pick(self, x: int, y: int, **options: Unpack[Options]) -> Pick | None:
        """The sphere in the middle of a pixel; None for the background.

        Args:
            x: The column, from 0 on the left.
            y: The row, from 0 on top.
            options: Those of the picture, such as `size`.

        Raises:
            ValueError: The picture has no such pixel.
        """
        from ._picture import Pick

        return Pick._of(self, self._merged(None, None, options), x, y)

    # What follows is for renders.

    def _merged(self, width: Any, height: Any, options: Mapping[str, Any]) -> dict[str, Any]:
        check_names(options)
        self._check_look(options)
        merged = {**self._options, **_given(options)}
        if self._particles is not None and self._path is not None:
            merged = self._particles._absorb(merged)
        for name, pixels in (("width", width), ("height", height)):
            if isinstance(pixels, (list, tuple)):
                raise TypeError(f"{name}: expected a number of pixels, not {pixels!r}; say size=...")
            if pixels is not None and not hasattr(pixels, "__index__"):
                raise TypeError(f"{name}: expected a number of pixels, not {pixels!r}")
        if width is not None or height is not None:
            if "size" in merged:
                raise TypeError("size: give it, or width and height")
            if width is None or height is None:
                facts = self._describe()
                width, height = width or facts["width"], height or facts["height"]
            merged["size"] = (width, height)
        return merged

    def _check_look(self, options: Mapping[str, Any]) -> None:
        """Refuses arrays and objects for the look of particles that are in a scene already."""
        if self._particles is not None and self._path is not None:
            return
        for name in ("color", "radius"):
            given = options.get(name)
            if given is not None and not isinstance(given, (str, int, float)):
                where = "ps.spheres(...), Particles.scene(...) or scene.replace(...)"
                raise Error(
                    f"{name}: it is part of a scene of particles, and no option of a render",
                    help=f"give it where the scene is made: {where}",
                )

    def __getstate__(self) -> dict[str, Any]:
        state = dict(self.__dict__)
        del state["_core"]
        return state

    def __setstate__(self, state: dict[str, Any]) -> None:
        made: Scene
        if state["_document"] is not None:
            made = Scene.__new__(Scene)
            made._set_document(state["_document"], state["_folder"], state["_tables"])
        elif state["_path"] is not None:
            made = Scene._of_file(state["_path"], state["_options"])
        else:
            made = Scene._of_particles(state["_particles"], state["_options"])
        self.__dict__.update(made.__dict__)
        self._particles = state["_particles"]


class Plan(str):
    """The text of a plan: commands, or a script for a queue."""

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Writes it."""
        path = Path(path)
        path.write_text(self, encoding="utf-8")
        return path


#: The camera of a scene that names none.
_Camera = {"position": [0, 0, 10], "look_at": [0, 0, 0]}


def scene(path: str | os.PathLike[str], keys: Mapping[str, Any] | None = None) -> Scene:
    """The scene of a file.

    Args:
        path: A scene file (.toml).
        keys: Keys to change, such as {"render.samples_per_pixel": 256,
            "materials.red.albedo": [0.7, 0.1, 0.1]}.

    Raises:
        Error: The file or a key is wrong; `.file` and `.line` say where.
    """
    options = {"set": dict(keys)} if keys else {}
    made = Scene._of_file(os.fspath(path), options)
    made._describe()
    return made


def _plan_error(text: str) -> Error:
    """The error of the command `plan`, without what belongs to a terminal."""
    lines = text.strip().removeprefix("error: ").split("\n")
    advice = ("help: ", "tip: ", "[possible values: ")
    rest = [line.strip() for line in lines[1:]]
    helps = [line.split(": ", 1)[1].rstrip("]") for line in rest if line.startswith(advice)]
    return Error(lines[0], help=", or ".join(helps) or None, category="usage")


def _read(text: str) -> dict[str, Any]:
    import tomllib

    return tomllib.loads(text)


def _given(options: Mapping[str, Any]) -> dict[str, Any]:
    return {name: one for name, one in options.items() if one is not None}


def _material_name(material: Any, named: dict[str, Any]) -> str:
    """The name of a material, under which it is kept among those of the scene."""
    if isinstance(material, str):
        return material
    table = material.toml()
    for name, known in named.items():
        if known == table:
            return name
    kind = table["type"]
    at = sum(one["type"] == kind for one in named.values()) + 1
    while f"{kind}-{at}" in named:
        at += 1
    named[f"{kind}-{at}"] = table
    return f"{kind}-{at}"


def _set_key(document: dict[str, Any], key: str, one: Any) -> None:
    """Sets a key such as `materials.left.albedo` or `spheres.0.radius`."""
    *way, last = key.split(".")
    place: Any = document
    for step in way:
        if isinstance(place, list):
            names = [entry.get("name") for entry in place]
            place = place[names.index(step) if step in names else int(step)]
        else:
            place = place.setdefault(step, {})
    place[int(last) if isinstance(place, list) else last] = one


def _checked(table: Spheres) -> Spheres:
    """A copy of a table whose arrays are checked."""
    import numpy as np

    center = _arrays.positions(table.center, "center")
    count = len(center)
    radius = table.radius
    if _arrays.is_number(radius):
        radius = _arrays.positive(radius, "radius")
    else:
        radius = _arrays.numbers(radius, "radius", count, positive=True).copy()
    colors: dict[str, Any] = {}
    for name in ("color", "emission"):
        given = getattr(table, name)
        if given is not None:
            rows = _arrays.positions(given, name)
            if len(rows) != count:
                raise ValueError(f"{name}: expected {count} rows, not {len(rows)}")
            most = 1.0 if name == "color" else 1e15
            colors[name] = _arrays.within(rows, name, most).astype(np.float32)
    ids = table.ids
    if ids is not None:
        ids = _arrays.ids(ids, "ids", count)
    return dataclasses.replace(table, center=center.copy(), radius=radius, ids=ids, **colors)


def _is_single(table: Spheres) -> bool:
    both = [table.center] + ([] if _arrays.is_number(table.radius) else [table.radius])
    return all(_arrays.is_single(array) for array in both)


def _core_spheres(table: Spheres) -> _core.Spheres:
    return _core.Spheres(
        table.center, _is_single(table), table.radius, table.color, table.emission, table.ids
    )


def _records(table: Spheres) -> Any:
    """A table as an array of records, whose fields are the columns of a sphere table."""
    import numpy as np

    kind = np.float32 if _is_single(table) else np.float64
    columns = {name: (kind, table.center[:, at]) for at, name in enumerate("xyz")}
    columns["radius"] = (kind, table.radius)
    for given, names in (("color", "rgb"), ("emission", ("emission_r", "emission_g", "emission_b"))):
        rows = getattr(table, given)
        if rows is not None:
            for at, name in enumerate(names):
                columns[name] = (np.float32, rows[:, at])
    if table.ids is not None:
        raise Error("a sphere table in a file has no ids", help="leave them out to save the scene")
    records = np.empty(len(table.center), [(name, kind) for name, (kind, _) in columns.items()])
    for name, (_, numbers) in columns.items():
        records[name] = numbers
    return records


def _named_arrays(particles: Particles) -> dict[str, Any]:
    import numpy as np

    single = _arrays.is_single(particles._positions)
    rows = np.asarray(particles._positions, np.float32 if single else np.float64)
    return {"x": rows[:, 0], "y": rows[:, 1], "z": rows[:, 2], **particles._columns}


def _with_moved_files(text: str, old: Path, new: Path) -> str:
    """Lets relative names of files in a scene start at another folder."""
    document = _read(text)
    tables = [*document.get("sphere_tables", []), *document.get("particles", [])]
    image = document.get("background", {}).get("image")
    for table in tables + ([image] if image else []):
        for key in ("file", "topology"):
            if key in table and not Path(table[key]).is_absolute():
                table[key] = os.path.relpath(old / table[key], new)
    return _toml.document(document) if tables or image else text
