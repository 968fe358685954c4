"""Values of the arguments of particles: colours by numbers, and cells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

__all__ = ["VALUE", "By", "Cell", "by"]

#: The column of colours that an array gives.
VALUE = "value"


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
        column = self.values if isinstance(self.values, str) else VALUE
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
        """Origin, edges and periodicity as plain numbers.

        Raises:
            ValueError: They are no numbers, or not as many.
        """
        try:
            vectors = [[float(one) for one in edge] for edge in self.vectors]
        except TypeError:
            vectors = []
        if [len(edge) for edge in vectors] != [3, 3, 3]:
            hint = "for a box of the lengths a, b, c: numpy.diag([a, b, c])"
            raise ValueError(
                f"cell: expected three edges of three numbers, not {self.vectors!r}; {hint}"
            )
        origin, periodic = [float(one) for one in self.origin], [bool(p) for p in self.periodic]
        if len(origin) != 3 or len(periodic) != 3:
            raise ValueError("cell: expected three numbers in `origin` and three in `periodic`")
        return origin, vectors, periodic
