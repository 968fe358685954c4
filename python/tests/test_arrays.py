"""Arrays of any type, byte order and strides give the same spheres as a plain copy of them."""

from __future__ import annotations

import numpy as np
import pytest

import photosphere as ps
from photosphere import _core

hypothesis = pytest.importorskip("hypothesis")
from hypothesis import given, settings  # noqa: E402
from hypothesis import strategies as st  # noqa: E402

TYPES = ["f2", "f4", "f8", "i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8"]


@st.composite
def layouts(draw: st.DrawFn) -> np.ndarray:
    """Rows of three numbers that lie in memory in some way."""
    count, order = draw(st.integers(1, 40)), draw(st.sampled_from("<>"))
    kind = np.dtype(order + draw(st.sampled_from(TYPES)))
    low = 0 if kind.kind == "u" else -100
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    step, column = draw(st.integers(1, 3)), draw(st.integers(1, 2))
    whole = random.integers(low, 100, (count * step, 3 * column + 1)).astype(kind)
    layout = draw(st.sampled_from(["strided", "reversed", "fortran", "transposed", "unaligned"]))
    if layout == "strided":
        return whole[::step, 1 : 1 + 3 * column : column]
    if layout == "reversed":
        return whole[::-step, 2::-1]
    if layout == "fortran":
        return np.asfortranarray(whole[:, :3])
    if layout == "transposed":
        return np.ascontiguousarray(whole[:, :3].T).T
    records = np.zeros(len(whole), [("tag", "u1"), ("xyz", kind, 3)])
    records["xyz"] = whole[:, :3]
    return records["xyz"]


@given(layouts())
@settings(max_examples=150, deadline=None)
def test_positions_of_any_layout(rows: np.ndarray) -> None:
    single = np.dtype(rows.dtype).newbyteorder("=").name in (
        "float16", "float32", "int8", "int16", "uint8", "uint16"
    )
    particles = ps.Particles(rows)
    copied = particles._core_columns().positions()
    assert copied.dtype == (np.float32 if single else np.float64)
    assert np.array_equal(copied, rows.astype(copied.dtype))


@given(layouts())
@settings(max_examples=100, deadline=None)
def test_columns_of_any_layout(rows: np.ndarray) -> None:
    particles = ps.Particles(np.zeros((len(rows), 3)), q=rows[:, 1])
    values, names = particles._core_columns().column("q")
    assert names is None
    assert np.array_equal(values.astype("f8"), rows[:, 1].astype("f8"))


def test_words_become_categories_in_order_of_appearance() -> None:
    given = np.array(["O", "H", "H", "C", "O"])
    for words in (given, list(given), given.astype(object), given.astype("S")):
        particles = ps.Particles(np.zeros((5, 3)), element=words)
        codes, names = particles._core_columns().column("element")
        assert (list(codes), names) == ([0, 1, 1, 2, 0], ["O", "H", "C"])


def test_f64_stays_f64_and_f32_takes_half_of_it() -> None:
    far = np.array([[1e6 + 0.25, 0, 0], [1e6, 0, 0]])
    assert ps.Particles(far)._core_columns().positions()[0, 0] == 1e6 + 0.25
    assert ps.Particles(far.astype("f4"))._core_columns().positions().dtype == np.float32


def test_tables_of_spheres_of_any_layout() -> None:
    xyz = np.random.default_rng(3).uniform(-1, 1, (50, 3))
    camera = ps.Camera((0, 0, 6), (0, 0, 0))
    made = [
        ps.Scene(
            [ps.Spheres(xyz.astype(kind)[::step], 0.1)], camera=camera, background=1.0
        ).content_hash
        for kind, step in ((">f8", 1), ("<f8", 1), ("f8", 2))
    ]
    assert made[0] == made[1] != made[2]


def test_numbers_are_copied_by_one_function() -> None:
    with pytest.raises(ValueError, match="shape"):
        _core.Columns("a", np.zeros((3, 2)), False, [], [], None, None)
