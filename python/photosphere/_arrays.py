"""Checks of arrays before they are copied: what is wrong is said with the name of the argument."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np

__all__ = [
    "MOST_ROWS",
    "colors",
    "ids",
    "is_number",
    "is_single",
    "mask",
    "numbers",
    "positions",
    "positive",
    "within",
    "words",
]

#: The most spheres of a scene: ids have 32 bits.
MOST_ROWS = 4_294_967_293

#: Coordinates and radii have at most this size.
_MOST = 1e15

#: Types whose numbers f32 holds exactly, apart from f32 itself.
_SINGLE = ("float16", "float32", "int8", "int16", "uint8", "uint16")


def _array(given: Any, name: str) -> np.ndarray:
    import numpy as np

    if hasattr(given, "__dlpack__") and not isinstance(given, np.ndarray):
        given = np.from_dlpack(given)
    try:
        array = np.asarray(given)
    except ValueError as error:
        raise ValueError(f"{name}: expected an array of numbers ({error})") from None
    if isinstance(given, np.ma.MaskedArray) and np.ma.is_masked(given):
        raise ValueError(f"{name}: has masked values; leave their rows out of all arrays")
    if array.dtype.kind not in "fiub":
        raise ValueError(f"{name}: expected numbers, not the type {array.dtype}")
    return array


def is_single(array: np.ndarray) -> bool:
    """True if f32 holds all values of the type of an array."""
    return array.dtype.newbyteorder("=").name in _SINGLE


def positions(given: Any, name: str = "positions", columns: int = 3) -> np.ndarray:
    """Rows of numbers.

    Raises:
        ValueError: They are no numbers, have another shape, or are none or too many.
    """
    array = _array(given, name)
    if array.ndim != 2 or array.shape[1] != columns:
        raise ValueError(
            f"{name}: expected an array of the shape (n, {columns}), not {array.shape}"
        )
    _check_count(len(array), name)
    return array


def is_number(given: Any) -> bool:
    """True for one number, of Python or NumPy."""
    if getattr(given, "ndim", None) == 0:
        return bool(given.dtype.kind in "fiub")
    return isinstance(given, (int, float))


def positive(given: Any, name: str) -> float:
    """One positive number.

    Raises:
        ValueError: It is not positive, or too large.
    """
    number = float(given)
    if not 0 < number <= _MOST:
        raise ValueError(f"{name}: expected a positive number of at most {_MOST:g}, not {given}")
    return number


def mask(given: Any, name: str, count: int) -> np.ndarray:
    """Which rows to keep.

    Raises:
        ValueError: They are no booleans, or not as many as rows.
    """
    import numpy as np

    array = np.asarray(given)
    if array.dtype.kind != "b" or array.shape != (count,):
        got = f"{array.dtype} {array.shape}" if array.ndim else repr(given)
        raise ValueError(
            f'{name}: expected a text such as "z > 0", or a mask of {count} booleans, not {got}'
        )
    return array


def ids(given: Any, name: str, count: int) -> np.ndarray:
    """An id of 32 bits for each row; the last one stands for no sphere.

    Raises:
        ValueError: They are no whole numbers, not as many as rows, or out of range.
    """
    import numpy as np

    array = numbers(given, name, count)
    most = 2**32 - 2
    with np.errstate(invalid="ignore"):
        good = (array >= 0) & (array <= most)
        if array.dtype.kind == "f":
            good &= array == np.floor(array)
    if not good.all():
        row = int(np.argmin(good))
        raise ValueError(
            f"{name}: row {row} is {array[row]}: expected a whole number from 0 to {most}"
        )
    return array.astype(np.uint32)


def within(rows: np.ndarray, name: str, most: float) -> np.ndarray:
    """Rows of numbers from 0 to a limit.

    Raises:
        ValueError: Some are not; with the row.
    """
    import numpy as np

    # A comparison with NaN is false.
    inside = ((rows >= 0) & (rows <= most)).all(axis=1)
    if not inside.all():
        row = int(np.argmin(inside))
        raise ValueError(
            f"{name}: row {row} is {rows[row].tolist()}: expected numbers from 0 to {most:g}"
        )
    return rows


def colors(given: Any, name: str) -> np.ndarray:
    """Rows of red, green and blue: fractions from 0 to 1, or whole numbers from 0 to 255.

    Raises:
        ValueError: They are no numbers, have another shape, or lie outside; with the row.
    """
    import numpy as np

    rows = positions(given, name)
    most = 1 if rows.dtype.kind == "f" else 255
    # A comparison with NaN is false.
    inside = (rows >= 0) & (rows <= most)
    if not inside.all():
        row = int(np.argmin(inside.all(axis=1)))
        wanted = "numbers from 0 to 1" if most == 1 else "whole numbers from 0 to 255"
        raise ValueError(f"{name}: expected {wanted}, not {rows[row].tolist()} in row {row}")
    if rows.dtype.kind in "iu" and 0 < rows.max() <= 1:
        text = f"{name}: whole numbers count up to 255, so that these are black; use floats up to 1"
        warnings.warn(text, stacklevel=2)
    return rows


def numbers(given: Any, name: str, count: int, *, positive: bool = False) -> np.ndarray:
    """A number for each particle.

    Raises:
        ValueError: They are no numbers, not as many, or not positive where they have to be.
    """
    import numpy as np

    array = _array(given, name)
    if array.shape != (count,):
        raise ValueError(f"{name}: expected an array of the shape ({count},), not {array.shape}")
    if positive:
        # A comparison with NaN is false.
        good = (array > 0) & (array <= _MOST)
        if not good.all():
            row = int(np.argmin(good))
            most = "" if array[row] <= _MOST or np.isnan(array[row]) else f" of at most {_MOST:g}"
            raise ValueError(
                f"{name}: row {row} is {array[row]}: expected a positive number{most}"
            )
    return array


def words(given: Any, name: str, count: int) -> tuple[np.ndarray, list[str]]:
    """A word for each particle, as codes and names in the order of their first appearance.

    Raises:
        ValueError: They are no words, or not as many.
    """
    import numpy as np

    array = np.asarray(given)
    if array.dtype.kind == "O" and all(isinstance(one, str) for one in array.flat):
        array = array.astype(str)
    if array.dtype.kind not in "UST" or array.shape != (count,):
        raise ValueError(f"{name}: expected {count} words, not {array.dtype} {array.shape}")
    if array.dtype.kind == "S":
        array = np.char.decode(array, "utf-8")
    names, first, codes = np.unique(array, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty(len(order), dtype=np.uint32)
    rank[order] = np.arange(len(order), dtype=np.uint32)
    return rank[codes], [str(names[at]) for at in order]


def _check_count(count: int, name: str) -> None:
    if count == 0:
        raise ValueError(f"{name}: there are no rows")
    if count > MOST_ROWS:
        raise ValueError(f"{name}: {count} rows are more than the {MOST_ROWS} of a scene")
