"""What is wrong is said with the name of the argument, and nothing else happens."""

from __future__ import annotations

import gc
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import REPOSITORY

import photosphere as ps

GOOD = np.zeros((3, 3)) + np.arange(3)[:, None]


def with_nan() -> np.ndarray:
    """One row is not finite."""
    rows = GOOD.copy()
    rows[1, 2] = np.nan
    return rows


@pytest.mark.parametrize(
    "call, message",
    [
        (lambda: ps.spheres(np.zeros(5)), r"positions: .*\(n, 3\), not \(5,\)"),
        (lambda: ps.spheres(np.zeros((5, 2))), r"positions: .*\(n, 3\), not \(5, 2\)"),
        (lambda: ps.spheres(np.zeros((0, 3))), "positions: there are no rows"),
        (lambda: ps.spheres([[1, 2, 3], [4, 5]]), "positions: expected an array of numbers"),
        (lambda: ps.spheres(np.array([["a"] * 3])), "positions: expected numbers"),
        (lambda: ps.spheres(np.array([[None] * 3])), "positions: expected numbers"),
        (lambda: ps.spheres(GOOD + 1j), "positions: expected numbers, not the type complex128"),
        (lambda: ps.spheres(with_nan()), "positions: row 1 is"),
        (lambda: ps.spheres(GOOD, radius=-1), "radius: expected a positive number"),
        (lambda: ps.spheres(GOOD, radius=[1, 0, 1]), "radius: row 1 is 0: expected a positive"),
        (lambda: ps.spheres(GOOD, radius=[1, np.nan, 1]), "radius: row 1 is nan"),
        (lambda: ps.spheres(GOOD, radius=[1, 2]), r"radius: .*\(3,\), not \(2,\)"),
        (lambda: ps.spheres(GOOD, color=np.zeros((2, 3))), "color: expected 3 rows, not 2"),
        (lambda: ps.spheres(GOOD, color=GOOD + [9, 0, 0]), "color: expected numbers from 0 to 1"),
        (lambda: ps.spheres(GOOD, color=GOOD * np.nan), "color: .* in row 0"),
        (lambda: ps.spheres(GOOD, color=np.full((3, 3), 256)), "color: .* from 0 to 255"),
        (lambda: ps.spheres(np.ma.masked_less(GOOD, 1.0)), "positions: has masked values"),
        (lambda: ps.spheres(GOOD, color=ps.by([1, 2])), r"color: .*\(3,\), not \(2,\)"),
        (lambda: ps.Particles(GOOD, x=[1, 2, 3]), "x: the coordinates"),
        (lambda: ps.Particles(GOOD, nan="keep"), 'nan: expected "drop"'),
        (lambda: ps.Particles(GOOD, cell=np.eye(2)), "cell: expected three edges"),
        (lambda: ps.Scene([ps.Spheres(GOOD[:, :2], 1)]), "center: "),
        (lambda: ps.Scene([ps.Spheres(with_nan(), 1)]), "center: row 1 is"),
        (lambda: ps.Scene([ps.Spheres(GOOD, -1.0)]), "radius: expected a positive number"),
        (lambda: ps.Scene([ps.Spheres(GOOD, 1, color=GOOD[:2])]), "color: expected 3 rows"),
    ],
)
def test_arrays(call: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        made = call()
        if isinstance(made, ps.Particles):
            made.scene()


def test_more_rows_than_ids() -> None:
    rows = np.broadcast_to(np.float32(0), (2**32, 3))
    with pytest.raises(ValueError, match="positions: 4294967296 rows are more"):
        ps.spheres(rows)


def test_rows_that_are_not_finite_can_be_dropped() -> None:
    with pytest.warns(UserWarning, match="1 rows are left out"):
        scene = ps.spheres(with_nan(), radius=[0.1, 0.2, 0.3], nan="drop")
    assert scene._describe()["particles"] == 2


def test_arrays_may_be_freed_and_changed_meanwhile() -> None:
    xyz = np.random.default_rng(1).uniform(-5, 5, (2000, 3))
    scene = ps.spheres(xyz, radius=0.3)
    before = np.asarray(scene.render(64, 48, spp=4))
    xyz[:] = 0
    del xyz
    gc.collect()
    render = scene.start(64, 48, spp=4)
    del scene
    gc.collect()
    assert np.array_equal(np.asarray(render.wait().picture), before)


def test_a_wrong_scene_file_says_where(in_folder: Path) -> None:
    text = (REPOSITORY / "scenes/cornell-spheres.toml").read_text()
    key = "vertical_fov_degrees"
    line = text[: text.index(key)].count("\n") + 1
    Path("bad.toml").write_text(text.replace(key, "vertical_fov_degree", 1))
    with pytest.raises(ps.Error) as caught:
        ps.scene("bad.toml")
    error = caught.value
    assert (error.file, error.line) == ("bad.toml", line)
    assert "vertical_fov_degree" in error.message
    assert f"did you mean `{key}`?" in (error.help or "")


def test_a_wrong_key_is_named() -> None:
    with pytest.raises(ps.Error, match="albedo"):
        ps.Scene([ps.Sphere((0, 0, 0), 1, ps.Diffuse(2.0))])
    with pytest.raises(ps.Error, match="did you mean"):
        ps.Scene([ps.Sphere((0, 0, 0), 1, ps.Glass("bk77"))])
    with pytest.raises(TypeError, match="iorr"):
        ps.Dielectric(iorr=1.5)  # type: ignore[call-arg]
    with pytest.raises(ps.Error, match="there is no material|material"):
        ps.Scene([ps.Sphere((0, 0, 0), 1, "gras")], materials={"grass": ps.Diffuse()})


def test_a_missing_file_and_a_broken_one(in_folder: Path) -> None:
    with pytest.raises(ps.Error, match="nowhere.toml"):
        ps.scene("nowhere.toml")
    with pytest.raises(FileNotFoundError):
        ps.read("nowhere.xyz")
    Path("broken.xyz").write_text("2\n\nO 1 2 3\nH 1 2\n")
    with pytest.raises(ps.Error, match="broken.xyz"):
        ps.read("broken.xyz").render()


def test_the_look_of_arrays_is_part_of_their_scene(scene: ps.Scene) -> None:
    with pytest.raises(ps.Error, match="part of their scene"):
        scene.render(64, 48, style="dark")
    other = scene.replace(style="dark")
    assert other.render(64, 48, spp=4, quiet=True).width == 64


def test_errors_can_be_pickled() -> None:
    import pickle

    error = ps.Error("what", help="how", file="a.toml", line=3)
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.file, again.line) == (str(error), "a.toml", 3)


def test_whole_numbers_that_look_like_fractions_are_warned_of() -> None:
    with pytest.warns(UserWarning, match="color: .*use floats"):
        ps.spheres(GOOD, color=np.eye(3, dtype=int))
