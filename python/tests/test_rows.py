"""Pictures name rows of the arrays that were given, or of the file, whatever conditions leave out."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import command, write_xyz

import photosphere as ps

hypothesis = pytest.importorskip("hypothesis")
from hypothesis import given, settings  # noqa: E402
from hypothesis import strategies as st  # noqa: E402

SMALL: dict[str, Any] = {"spp": 4, "quiet": True}
SIZE: dict[str, Any] = {"size": (64, 48), **SMALL}


def check_rows(
    scene: ps.Scene, positions: np.ndarray, column: np.ndarray | None = None
) -> np.ndarray:
    """Checks that picks and the layer `row` name the positions that a picture shows."""
    picture = scene.render(layers=["row", "sphere_id", "depth"], **SIZE)
    rows = picture["row"]
    assert rows.dtype == np.uint32 and rows.shape == (48, 64)
    shown = np.argwhere(rows != ps.NONE)
    assert len(shown) > 20
    for y, x in shown[:: len(shown) // 12]:
        pick = picture.pick(int(x), int(y))
        assert pick is not None and pick.row == rows[y, x]
        assert np.allclose(pick.position, positions[pick.row], atol=1e-5)
        if column is not None:
            assert pick.values["e"] == pytest.approx(column[pick.row])
    return np.unique(rows[rows != ps.NONE])


def test_rows_of_arrays(xyz: np.ndarray) -> None:
    e = np.random.default_rng(5).uniform(0, 1, 1000)
    seen = check_rows(ps.spheres(xyz, 0.4, values={"e": e}), xyz, e)
    assert len(seen) > 100
    kept = np.flatnonzero((e > 0.4) & (xyz[:, 2] < 3))
    condition = "e > 0.4 && z < 3"
    for scene in (
        ps.spheres(xyz, 0.4, values={"e": e}, select=condition),
        ps.Particles(xyz, radius=0.4, e=e).where(condition).scene(),
        ps.Particles(xyz, radius=0.4, e=e).where("e > 0.4").scene(select="z < 3"),
        ps.Particles(xyz, radius=0.4, e=e).where((e > 0.4) & (xyz[:, 2] < 3)).scene(),
        ps.Particles(xyz, radius=0.4, e=e)[e > 0.4].where("z < 3").scene(slice="x > 0"),
    ):
        assert set(check_rows(scene, xyz, e)) <= set(kept)
        check_rows(pickle.loads(pickle.dumps(scene)), xyz, e)


def test_rows_without_those_that_are_not_finite(xyz: np.ndarray) -> None:
    rows, e = xyz.copy(), np.arange(1000.0)
    rows[::3, 1] = np.nan
    with pytest.warns(UserWarning, match="left out"):
        particles = ps.Particles(rows, radius=0.4, nan="drop", e=e)
    seen = check_rows(particles.where("e > 100").scene(color=ps.by(e)), rows, e)
    assert seen.min() > 100 and not (seen % 3 == 0).any()


def test_rows_of_a_file(in_folder: Path) -> None:
    write_xyz(Path("a.xyz"), 200)
    p = ps.read("a.xyz")
    e = p["e"]
    kept = np.flatnonzero((e > 4) & (p.positions[:, 2] > 1))
    condition = "e > 4 && z > 1"
    part = p.where(condition)
    assert np.array_equal(part.rows, kept) and len(part) == len(kept)
    for one in (part.scene(), p.scene(select=condition), p[np.isin(np.arange(200), kept)].scene()):
        assert set(check_rows(one, p.positions, e)) <= set(kept)
    part.scene().save("mine.toml")
    assert set(check_rows(ps.scene("mine.toml"), p.positions)) <= set(kept)


def test_rows_of_periodic_copies_and_a_cell(in_folder: Path) -> None:
    write_xyz(Path("a.xyz"))
    scene = ps.read("a.xyz").where("e > 4").scene(replicate=(2, 1, 1), cell=True)
    picture = scene.render(layers=["row", "sphere_id"], **SIZE)
    seen = np.unique(picture["row"][picture["row"] != ps.NONE])
    assert set(seen) <= set(ps.read("a.xyz").where("e > 4").rows)
    edges = (picture["row"] == ps.NONE) & (picture["sphere_id"] > seen.max())
    edges &= picture["sphere_id"] != ps.NONE
    y, x = np.argwhere(edges)[0]
    pick = picture.pick(x, y)
    assert pick is not None and pick.row is None and pick.values == {}


def test_the_command_line_writes_the_same_rows(in_folder: Path) -> None:
    write_xyz(Path("a.xyz"))
    options = {"select": "e > 4", "layers": ["row", "e"], "no_run_figures": True}
    ps.read("a.xyz").render(64, 48, **options, **SMALL).save("a.exr")
    words = ["--size", "64x48", "--spp", 4, "--select", "e > 4", "--layers", "row,e"]
    done = command("render", "a.xyz", *words, "--no-run-figures", "-o", "b.exr")
    assert done.returncode == 0, done.stderr
    assert Path("a.exr").read_bytes() == Path("b.exr").read_bytes()


def test_rows_of_objects() -> None:
    table = ps.Spheres(np.array([[0.0, 1, 0], [3, 1, 0]]), 1.0, name="pair")
    floor = ps.Sphere((0, -100, 0), 100, name="floor")
    scene = ps.Scene([floor, table], camera=ps.Camera((3, 1, 9), (3, 1, 0)), background="white")
    pick = scene.pick(32, 24, size=(64, 48))
    assert pick is not None and (pick.name, pick.row) == ("pair:1", 1)
    below = scene.pick(32, 47, size=(64, 48))
    assert below is not None and (below.name, below.row) == ("floor", 0)


@pytest.mark.parametrize("x, y", [(-1, 0), (0, -1), (64, 0), (0, 48), (1.5, 0), ("a", 0)])
def test_pixels_that_a_picture_lacks(scene: ps.Scene, x: Any, y: Any) -> None:
    picture = scene.render(**SIZE)
    with pytest.raises((ValueError, ps.Error), match="expected a (column|row)|has no pixel"):
        picture.pick(x, y)


def test_particles_are_like_a_table(in_folder: Path) -> None:
    write_xyz(Path("a.xyz"))
    file = ps.read("a.xyz")
    arrays = ps.Particles(file.positions, species=file["species"], e=file["e"])
    for p in (file, arrays):
        assert len(p) == p.n == 60
        assert list(p) == p.columns == ["species", "e"]
        assert "e" in p and "x" in p and "mass" not in p
        assert np.array_equal(p["z"], p.positions[:, 2])
        with pytest.raises(KeyError, match="no column 'specis'; did you mean 'species'.*species, e"):
            p["specis"]
        oxygen = p.where('species == "O"')
        assert len(oxygen) == (p["species"] == "O").sum() == len(oxygen["e"])
        assert set(oxygen["species"]) == {"O"} and len(oxygen.positions) == len(oxygen)
        assert np.array_equal(oxygen.where(oxygen["e"] > 8).rows, oxygen.where("e > 8").rows)
        assert np.array_equal(p["e"][oxygen.rows], oxygen["e"])
        assert "particles" in repr(oxygen)
        with pytest.raises(ValueError, match="condition: .*mask of 60 booleans, not bool"):
            p.where(np.ones(59, bool))
        with pytest.raises(ValueError, match="condition: .*mask of 60 booleans, not int"):
            p.where(np.arange(60))
        with pytest.raises(ps.Error, match="no column `ee`"):
            len(p.where("ee > 8"))
        with pytest.raises((ValueError, ps.Error), match="no particle fulfils the condition"):
            assert p.where("e > 1e9").scene().n == 0


def test_arrays_for_all_particles_fit_some_of_them(xyz: np.ndarray) -> None:
    value, radius = xyz[:, 0], np.full(1000, 0.4)
    p = ps.Particles(xyz).where("z > 0")
    scenes = [
        p.scene(color=ps.by(value), radius=radius),
        p.scene(color=ps.by(value[xyz[:, 2] > 0]), radius=radius[: len(p)]),
    ]
    assert scenes[0].content_hash == scenes[1].content_hash
    with pytest.raises(ValueError, match=rf"color: .*\({len(p)},\), not \(7,\)"):
        p.scene(color=ps.by(value[:7]))


def test_a_file_that_names_no_columns(in_folder: Path) -> None:
    Path("a.txt").write_text("0 0 0 0.5\n1 0 0 0.25\n0 1 0 0.5\n")
    p = ps.read("a.txt", input_format="table", columns="x,y,z,radius")
    assert (p.n, p.columns) == (3, ["radius"])
    assert len(p.where("radius > 0.3")) == 2 and list(p["radius"]) == [0.5, 0.25, 0.5]
    assert p.render(64, 48, **SMALL).width == 64


def test_frames_keep_conditions(in_folder: Path) -> None:
    write_xyz(Path("a.xyz"), 60, seed=0)
    write_xyz(Path("b.xyz"), 60, seed=1)
    Path("two.xyz").write_text(Path("a.xyz").read_text() + Path("b.xyz").read_text())
    p = ps.read("two.xyz").where("z > 4")
    later = p.frame(1)
    assert np.array_equal(later.rows, ps.read("b.xyz").where("z > 4").rows)
    assert not np.array_equal(later.rows, p.rows)
    theirs = ps.read("b.xyz").where("z > 4").render(64, 48, **SMALL)
    assert np.array_equal(np.asarray(later.render(64, 48, **SMALL)), np.asarray(theirs))


@given(st.lists(st.tuples(st.booleans(), st.booleans(), st.integers(-3, 3)), min_size=1, max_size=40))
@settings(max_examples=60, deadline=None)
def test_masks_and_conditions_one_after_the_other(rows: list[tuple[bool, bool, int]]) -> None:
    first, second, numbers = (np.array(column) for column in zip(*rows))
    p = ps.Particles(np.arange(3.0 * len(rows)).reshape(-1, 3), q=numbers, word=first.astype(str))
    expected = np.flatnonzero(first)
    assert np.array_equal(p[first].rows, expected)
    expected = expected[second[first]]
    part = p[first].where(second[first])
    assert np.array_equal(part.rows, expected)
    expected = expected[numbers[expected] > 0]
    for last in (part.where("q > 0"), part[part["q"] > 0]):
        assert np.array_equal(last.rows, expected)
        assert np.array_equal(last["q"], numbers[expected])
        assert np.array_equal(last.positions, p.positions[expected])
