"""Pictures: arrays of linear light, files, and what is shown in a cell."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _arrays, _core

if TYPE_CHECKING:
    import numpy as np

    from ._scene import Scene

__all__ = ["Legend", "Pick", "Picture"]


@dataclass(frozen=True)
class _Look:
    """How a file for the screen shows a picture; None is as the options of the render say."""

    exposure: float | None = None
    tone: str | None = None
    dither: bool | None = None
    dpi: int | None = None
    font_size: float | None = None
    overlay: bool = True
    run_figures: bool | None = None

    def __post_init__(self) -> None:
        for name in ("exposure", "font_size"):
            given = getattr(self, name)
            if given is not None and not _arrays.is_number(given):
                raise TypeError(f"{name}: expected a number, not {given!r}")
        if self.font_size is not None and not self.font_size > 0:
            raise ValueError(f"font_size: expected a positive number, not {self.font_size!r}")
        if self.tone is not None and not isinstance(self.tone, str):
            raise TypeError(f"tone: expected a name, not {self.tone!r}")
        for name in ("dither", "overlay"):
            given = getattr(self, name)
            if given is not None and not isinstance(given, bool):
                raise TypeError(f"{name}: expected True or False, not {given!r}")
        object.__setattr__(self, "dpi", _whole_dpi(self.dpi))


#: The most pixels per inch of a file.
_MOST_DPI = 100_000


def _whole_dpi(given: Any) -> int | None:
    """Pixels per inch: a whole number, which may be a float."""
    if given is None:
        return None
    is_whole = _arrays.is_number(given) and not isinstance(given, bool) and given == given // 1
    if not is_whole or not 0 < given <= _MOST_DPI:
        expected = f"a whole number of pixels per inch from 1 to {_MOST_DPI}"
        raise ValueError(f"dpi: expected {expected}, not {given!r}")
    return int(given)


class Picture:
    """A rendered picture.

    `picture["depth"]` is a layer, `np.asarray(picture)` the linear light (height, width, 3), row 0 on
    top, in float32; `rgb8()` is what a screen shows. Layers are read-only.
    """

    def __init__(self, core: _core.Picture, scene: Scene | None, options: dict[str, Any]) -> None:
        self._core, self._scene, self._options = core, scene, options

    @property
    def width(self) -> int:
        """Width in pixels."""
        return self._core.width

    @property
    def height(self) -> int:
        """Height in pixels."""
        return self._core.height

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width."""
        return self.height, self.width

    @property
    def layers(self) -> list[str]:
        """Names of the layers."""
        return self._core.names()

    def __getitem__(self, layer: str) -> np.ndarray:
        """A layer: (height, width) or (height, width, channels), float32.

        `sphere_id` and `material_id` are uint32, and NONE where there is nothing. So is `row`: the
        row of your arrays or of the file that a pixel shows. `variance` is that of the mean, `depth`
        is inf where there is nothing, and columns are nan there.

        Raises:
            KeyError: The picture has no such layer: render with layers=[...].
        """
        if layer not in self.layers:
            known = ", ".join(self.layers)
            hint = "others by layers=[...] where it is rendered"
            raise KeyError(f"{layer}: the picture has the layers {known}; {hint}")
        return self._core.layer(layer)

    def __contains__(self, layer: object) -> bool:
        return layer in self.layers

    def __iter__(self) -> Iterator[str]:
        return iter(self.layers)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        import numpy as np

        array = self._core.layer("beauty")
        if dtype is not None and np.dtype(dtype) != array.dtype:
            if copy is False:
                raise ValueError(f"copy: {np.dtype(dtype)} takes a copy of float32")
            return array.astype(dtype)
        return array.copy() if copy else array

    def rgb8(
        self,
        *,
        exposure: float | None = None,
        tone: str | None = None,
        dither: bool | None = None,
        overlay: bool = True,
    ) -> np.ndarray:
        """The pixels for a screen, uint8 sRGB: (height, width, 3), or 4 with transparency.

        Args:
            exposure: In stops.
            tone: "srgb", "filmic" or "agx".
            dither: Hide steps in smooth gradients.
            overlay: With the colour bar and whatever else is drawn over the picture.
        """
        look = _Look(exposure, tone, dither, overlay=overlay)
        return self._core.display(look)

    def save(
        self,
        path: str | os.PathLike[str],
        *,
        exposure: float | None = None,
        tone: str | None = None,
        dither: bool | None = None,
        dpi: int | None = None,
        font_size: float | None = None,
        overlay: bool = True,
        no_run_figures: bool | None = None,
    ) -> Path:
        """Writes a file: .png for the screen, .exr linear with all layers, .hdr or .pfm linear.

        Args:
            path: The file; its ending chooses the format.
            exposure: Of .png files, in stops.
            tone: The tone curve of .png files: "srgb", "filmic" or "agx".
            dither: Dither .png files.
            dpi: The resolution for print, in pixels per inch; texts have their size by it.
            font_size: The size of texts in points.
            overlay: With the colour bar and whatever else is drawn over the picture.
            no_run_figures: Omit time and machine, so that equal pictures are equal files.
        """
        figures = None if no_run_figures is None else not no_run_figures
        look = _Look(exposure, tone, dither, dpi, font_size, overlay, figures)
        self._core.save(os.fspath(path), look)
        return Path(path)

    def denoise(self) -> Picture:
        """The picture without its noise, by Intel Open Image Denoise, which must be installed.

        `["denoised"]` is a layer of it, linear light in float32; notebooks, `rgb8` and files without
        layers show it, and `["beauty"]` stays. The result is biased: nothing says how far it is off.
        A render with denoise=True has the layers that keep mirrors and glass sharp.

        Raises:
            Error: The library is not installed: `pip install pyoidn`.
        """
        return Picture(self._core.denoise(denoiser_package()), self._scene, self._options)

    @property
    def metadata(self) -> dict[str, Any]:
        """How the picture was made, as its files record it."""
        return json.loads(self._core.metadata())

    @property
    def spp(self) -> int:
        """Samples per pixel; the most where pixels differ."""
        return int(self.metadata["samples"]["max_count"])

    @property
    def error(self) -> float | None:
        """The estimated error that 95 % of the values stay below, relative to the brightness."""
        return self.metadata.get("error")

    @property
    def legend(self) -> Legend | None:
        """The colour bar or the legend; None if there is none."""
        overlay = json.loads(self._core.overlay())
        legend = overlay and overlay["legend"]
        return None if not legend or legend == "nothing" else Legend(legend)

    def pick(self, x: int, y: int) -> Pick | None:
        """The sphere in the middle of a pixel, column x and row y; None for the background.

        For all pixels at once, render with layers=["row"].

        Args:
            x: The column, from 0 on the left.
            y: The row, from 0 on top.

        Raises:
            ValueError: There is no such pixel; or the picture was merged, so that its scene is not
                here.
        """
        if self._scene is None:
            raise ValueError("the picture has no scene: ask it, scene.pick(x, y, ...)")
        return Pick._of(self._scene, self._options, x, y)

    def _repr_png_(self) -> bytes:
        return self._core.encode("png", _Look(), True)

    def __repr__(self) -> str:
        error = self.error
        noise = "" if error is None else f", error {100 * error:.2g} %"
        return (
            f"<picture of {self.width} x {self.height} pixels, "
            f"{self.spp} samples per pixel{noise}>"
        )

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, (*self._core.pickled(), self._scene, self._options)


def denoiser_package() -> str | None:
    """The folder of the package that contains Open Image Denoise, if it is installed."""
    import importlib.util

    spec = importlib.util.find_spec("pyoidn")
    return None if spec is None or spec.origin is None else os.path.dirname(spec.origin)


def _restore(text: str, arrays: list[Any], scene: Any, options: dict[str, Any]) -> Picture:
    return Picture(_core.Picture.restore(text, arrays), scene, options)


@dataclass(frozen=True)
class Pick:
    """A sphere that a pixel shows.

    Attributes:
        row: The row of your arrays or of the file, from 0, whatever conditions leave out; of a bead
            of a bond, that of the nearer atom. None for the ground and edges of a cell. In scenes
            of objects, the row of the `Spheres`, or the number of the `Sphere`.
        values: The values of that row, by column.
        position: The centre of the sphere.
        radius: Its radius.
        depth: The distance from the camera.
        name: The name of the sphere.
    """

    row: int | None
    values: dict[str, Any] = field(repr=False)
    position: tuple[float, float, float]
    radius: float
    depth: float
    name: str

    @classmethod
    def _of(cls, scene: Scene, options: dict[str, Any], x: int, y: int) -> Pick | None:
        kept = {name: one for name, one in options.items() if name not in _NOT_OF_PICKS}
        pixel = [_pixel(x, "x", "column"), _pixel(y, "y", "row")]
        found = scene._core.pick(*scene._split(kept), pixel)
        if found is None:
            return None
        facts = json.loads(found)
        row: int | None = facts["row"]
        values: dict[str, Any] = {}
        if facts["is_of_particles"] or scene._particles is not None:
            row = facts["particle"]
        elif facts["table_row"] is not None:
            row = facts["table_row"]
        if scene._particles is not None and row is not None:
            row, values = scene._particles._row_and_values(row)
        center = tuple(facts["center"])
        return cls(row, values, center, facts["radius"], facts["depth"], facts["name"])


#: Options of renders that do not matter for what a pixel shows.
_NOT_OF_PICKS = ("checkpoint", "samples", "layers")


def _pixel(given: Any, name: str, what: str) -> int:
    """The number of a column or a row."""
    if not hasattr(given, "__index__") or not 0 <= given < 2**32:
        raise ValueError(f"{name}: expected a {what} of the picture, from 0, not {given!r}")
    return int(given)


class Legend:
    """A colour bar, or names with their colours."""

    def __init__(self, facts: dict[str, Any]) -> None:
        self.kind, self._facts = next(iter(facts.items()))

    @property
    def title(self) -> str:
        """The title, with the unit."""
        return self._facts["title"]

    def svg(self) -> str:
        """The bar alone, as a drawing."""
        return _bar(self._facts) if self.kind == "bar" else _names(self._facts)

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Writes an .svg file."""
        if Path(path).suffix.lower() != ".svg":
            raise ValueError(f"path: expected a name that ends in .svg, not {os.fspath(path)!r}")
        Path(path).write_text(self.svg(), encoding="utf-8")
        return Path(path)

    def _repr_svg_(self) -> str:
        return self.svg()


_FONT = 'font-family="DejaVu Sans, Arial, sans-serif" font-size="12"'


def _svg(width: float, height: float, body: list[str]) -> str:
    size = f'width="{width:g}" height="{height:g}" viewBox="0 0 {width:g} {height:g}"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size}>\n' + "\n".join(body) + "\n</svg>\n"


def _escape(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;")


def _bar(facts: dict[str, Any]) -> str:
    import math

    low, high = facts["ends"]
    values, labels = _core.ticks(low, high, facts["log"], 5)
    top, tall, left, wide = 28.0, 200.0, 10.0, 16.0
    colors = _core.colormap(facts["map"])
    stops = [
        f'<stop offset="{at / 255:.4f}" stop-color="rgb({r},{g},{b})"/>'
        for at, (r, g, b) in enumerate(colors)
    ]
    scale = math.log if facts["log"] else float
    body = [
        '<defs><linearGradient id="map" x1="0" y1="1" x2="0" y2="0">',
        *stops,
        "</linearGradient></defs>",
        f'<text x="{left}" y="16" {_FONT}>{_escape(facts["title"])}</text>',
        f'<rect x="{left}" y="{top}" width="{wide}" height="{tall}" fill="url(#map)" '
        'stroke="black" stroke-width="0.7"/>',
    ]
    for number, label in zip(values, labels):
        share = (scale(number) - scale(low)) / ((scale(high) - scale(low)) or 1.0)
        y, end = top + tall * (1 - share), left + wide
        body.append(f'<path d="M{end} {y:.2f}h5" stroke="black" stroke-width="0.7"/>')
        body.append(f'<text x="{end + 8}" y="{y + 4:.2f}" {_FONT}>{_escape(label)}</text>')
    return _svg(160, top + tall + 12, body)


def _names(facts: dict[str, Any]) -> str:
    body = [f'<text x="10" y="16" {_FONT}>{_escape(facts["title"])}</text>']
    for at, (name, (r, g, b)) in enumerate(facts["entries"]):
        y = 36 + 20 * at
        body.append(f'<circle cx="17" cy="{y}" r="7" fill="rgb({r},{g},{b})" stroke="black"/>')
        body.append(f'<text x="32" y="{y + 4}" {_FONT}>{_escape(name)}</text>')
    return _svg(160, 36 + 20 * len(facts["entries"]), body)
