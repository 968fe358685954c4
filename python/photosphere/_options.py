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

#: Options of the command line that have no keyword: they concern its standard output, a viewer that
#: it talks to, and files of pictures alone: `photosphere denoise` denoises one that was saved.
NOT_HERE = {"denoise", "format", "json", "tev"}

#: Names for times, whose numbers are seconds.
_TIMES = {"time", "checkpoint_every", "preview_every"}

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
    confidence: float | str | None
    max_spp: int | None
    time: float | str | None
    layers: Sequence[str] | str | None
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


def split(options: Mapping[str, Any]) -> tuple[list[str], list[tuple[str, str]]]:
    """Options as words of a command line, and as keys of the scene with values in TOML.

    Raises:
        TypeError: An option is not known, or its value has the wrong type.
    """
    words: list[str] = []
    changes: list[tuple[str, str]] = []
    for name, given in options.items():
        if given is None or name in ("output", "preview"):
            continue
        if name == "camera":
            changes.append(("camera", _toml.value(given)))
        elif name == "background" and not isinstance(given, str):
            from ._objects import background_table

            table = background_table(given)
            changes.append(("background", _toml.value({"up": [0, 0, 1], **table})))
        elif name == "material" and not isinstance(given, str):
            changes.append(("materials.particles", _toml.value(given)))
        elif name == "set":
            words += [f"--set={key}={_toml.value(one)}" for key, one in given.items()]
        else:
            words += _word(name, given)
    return words, changes


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
    if isinstance(given, Sequence):
        between = {"size": "x", "samples": ".."}.get(name, ",")
        return between.join(_text(name, one) for one in given)
    raise TypeError(f"{name}: {given!r} is no value of an option")
