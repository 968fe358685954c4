"""The options of the command line as keywords: `--max-depth 5` is `max_depth=5`."""

from __future__ import annotations

import difflib
import functools
import numbers
import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypedDict

from . import _core, _toml

if TYPE_CHECKING:
    from ._objects import AnyBackground, AnyCamera, Material
    from ._particles import By

__all__ = ["NOT_HERE", "LookOptions", "Options", "PartOptions", "ReadOptions", "ViewOptions", "split"]

#: Options of the command line that have no keyword: they concern its standard output, and a viewer
#: that it talks to.
NOT_HERE = {"format", "json", "tev"}

#: Names for times, whose numbers are seconds.
_TIMES = {"time", "checkpoint_every", "preview_every"}

#: How many numbers the options have that take several, and an example of each.
_SEVERAL = {
    "size": (2, "(640, 480)"),
    "samples": (2, "(0, 64), from the first up to but without the last"),
    "crop": (4, "(x0, y0, x1, y1)"),
    "replicate": (3, "(2, 2, 1)"),
    "range": (2, '(0, 80) or ("p1", "p99")'),
    "view": (2, "(-55, 25), azimuth and elevation in degrees"),
}

#: What the values of options are, by how the command line calls them.
_EXPECTED = {
    "N": "a whole number",
    "D": "a whole number",
    "S": "a whole number",
    "T": "a whole number",
    "X": "a number",
    "L": "a number",
    "PT": "a number",
    "EV": "a number of stops",
    "TIME": "a number of seconds, or a time such as \"5m\"",
    "NAME": "a name",
    "TEXT": "a text",
    "FILE": "a path",
    "EXPR": "a condition such as \"z > 0\"",
    "WHAT": "a text, a number or an array",
}

#: Names of materials that the scene format has and the options call otherwise.
_MATERIALS = {"diffuse": "lambert"}


class ViewOptions(TypedDict, total=False):
    """Options that frame and light particles, and give them colours."""

    view: str | tuple[float, float] | None
    up: str | None
    zoom: float | None
    ortho: bool
    style: str | None
    material: str | Material | None
    ground: bool | None
    background: str | AnyBackground | Sequence[AnyBackground] | None
    select: str | None
    slice: str | None
    radius_scale: float | None
    color: str | By | Any
    colormap: str | None
    range: str | tuple[float | str, float | str] | None
    log: bool
    wrap: bool
    unwrap: bool
    center: bool
    replicate: tuple[int, int, int] | None
    glow: float | None
    no_legend: bool
    title: str | None
    scale_bar: bool
    unit: str | None
    axes: bool
    font_size: float | None
    camera: AnyCamera | None


class ReadOptions(ViewOptions, total=False):
    """Options that give particles radii, too."""

    radius: Any
    cell: bool


class LookOptions(ReadOptions, total=False):
    """All options for particles: those above, and how a file is read."""

    input_format: str | None
    frame: int | None
    columns: str | None
    topology: str | os.PathLike[str] | None


class PartOptions(LookOptions, total=False):
    """Options of a render, but for its samples and files."""

    size: tuple[int, int] | str | None
    spp: int | None
    seed: int | None
    integrator: str | None
    estimator: str | None
    caustics: str | None
    sampler: str | None
    max_depth: int | None
    crop: tuple[int, int, int, int] | None
    noise: float | str | None
    quality: str | None
    confidence: float | str | None
    max_spp: int | None
    time: float | str | None
    layers: Sequence[str] | str | None
    denoise: bool
    accel: str | None
    build: str | None
    threads: int | None
    memory_limit: int | str | None
    set: Mapping[str, Any] | None
    exposure: float | None
    tone: str | None
    dither: bool
    dpi: int | None
    no_run_figures: bool
    checkpoint: str | os.PathLike[str] | None
    checkpoint_every: float | str | None
    preview: str | os.PathLike[str] | None
    preview_every: float | str | None
    quiet: bool


class Options(PartOptions, total=False):
    """Options of a render. Their names, values and defaults are those of `photosphere render`."""

    samples: tuple[int, int] | str | None
    output: str | os.PathLike[str] | Sequence[str | os.PathLike[str]] | None


@functools.cache
def known() -> dict[str, tuple[str | None, str, str | None, list[str]]]:
    """Value, help, default and choices of every option."""
    return {
        name.replace("-", "_"): (value, text, default, choices)
        for name, value, text, default, choices in _core.keywords()
        if name not in NOT_HERE
    }


def split(
    options: Mapping[str, Any], of_particles: bool = False
) -> tuple[list[str], list[tuple[str, str]]]:
    """Options as words of a command line, and as keys of the scene with values in TOML.

    In scenes of particles z points up, or what `up` says, for cameras and backgrounds, too.

    Raises:
        TypeError: An option is not known, or its value has the wrong type.
    """
    words: list[str] = []
    changes: list[tuple[str, str]] = []
    for name, given in options.items():
        if given is None or name in ("output", "preview", "preview_every"):
            continue
        if name == "camera":
            from ._objects import camera_table

            up = _up(options) if of_particles else None
            changes.append(("camera", _toml.value(camera_table(given, up))))
        elif name == "background" and not (of_particles and isinstance(given, str)):
            from ._objects import background_table

            table = background_table(given)
            if of_particles:
                table = {"up": _up(options), **table}
            changes.append(("background", _toml.value(table)))
        elif name == "material" and not isinstance(given, str):
            if not hasattr(given, "toml"):
                raise TypeError(f"material: expected a material or its name, not {given!r}")
            changes.append(("materials.particles", _toml.value(given)))
        elif name == "set":
            if not isinstance(given, Mapping):
                raise TypeError(f"set: expected keys with their values, not {given!r}")
            words += [f"--set={key}={_toml.value(one)}" for key, one in given.items()]
        else:
            words += _word(name, given)
    return words, changes


def _up(options: Mapping[str, Any]) -> list[int]:
    """The direction that points up in a scene of particles."""
    given = str(options.get("up") or "z").lower()
    sign, axis = (-1 if given.startswith("-") else 1), given.lstrip("+-")
    return [sign * (axis == one) for one in "xyz"] if axis in ("x", "y", "z") else [0, 0, 1]


def check_names(options: Mapping[str, Any], also: Sequence[str] = ()) -> None:
    """Refuses options that do not exist.

    Raises:
        TypeError: Names the first one, and what may be meant.
    """
    names = [*known(), "camera", *also]
    for name in options:
        if name not in names:
            near = difflib.get_close_matches(name, names, 1)
            hint = f"; did you mean `{near[0]}`?" if near else ""
            raise TypeError(f"there is no option `{name}`{hint}")


def _word(name: str, given: Any) -> list[str]:
    if name not in known():
        check_names({name: given})
    option = f"--{name.replace('_', '-')}"
    if known()[name][0] is None:
        if not isinstance(given, bool):
            raise TypeError(f"{name}: expected True or False, not {given!r}")
        return [option] if given else []
    if name == "material":
        given = _MATERIALS.get(given, given)
    return [f"{option}={_text(name, given)}"]


def _text(name: str, given: Any) -> str:
    if isinstance(given, str):
        return given
    if isinstance(given, os.PathLike):
        return str(os.fspath(given))
    if isinstance(given, bool):
        return "true" if given else "false"
    if isinstance(given, numbers.Integral):
        return str(int(given)) + ("s" if name in _TIMES else "")
    if isinstance(given, numbers.Real):
        return repr(float(given)) + ("s" if name in _TIMES else "")
    if hasattr(given, "tolist"):
        return _text(name, given.tolist())
    if name in _SEVERAL:
        count, example = _SEVERAL[name]
        if not isinstance(given, (list, tuple)) or len(given) != count:
            raise TypeError(f"{name}: expected {count} values such as {example}, not {given!r}")
    if isinstance(given, Sequence):
        between = {"size": "x", "samples": ".."}.get(name, ",")
        return between.join(_text(name, one) for one in given)
    expected = known()[name][0]
    raise TypeError(f"{name}: expected {_EXPECTED.get(str(expected), expected)}, not {given!r}")
