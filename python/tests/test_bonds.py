"""Ball-and-stick: colours, radii and rows are those of the atoms."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import photosphere as ps
from photosphere import _arrays, _bonds

SMALL: dict[str, Any] = {"size": (96, 72), "spp": 4, "quiet": True}

#: Carbon atoms in a row, 1.4 angstrom apart, with an oxygen at the end.
CHAIN = np.array([[1.4 * at, 0.0, 0.0] for at in range(6)])
ELEMENT = ["C"] * 5 + ["O"]


def chain(**options: Any) -> ps.Particles:
    return ps.Particles(CHAIN, element=ELEMENT, **options)


def test_beads_belong_to_the_nearer_atom() -> None:
    scene = chain().scene(style="ball-and-stick", view="-y")
    picture = scene.render(layers=["row"], **SMALL)
    rows = picture["row"][36]
    shown = rows[rows != ps.NONE]
    assert set(shown) == set(range(6)) and (np.diff(shown.astype(int)) >= 0).all()
    for x in np.flatnonzero(rows != ps.NONE)[::5]:
        pick = picture.pick(int(x), 36)
        assert pick is not None and pick.row == rows[x]
        assert pick.values == {"element": ELEMENT[pick.row]}
        assert abs(pick.position[0] - CHAIN[pick.row, 0]) <= 0.75


@pytest.mark.parametrize("select", [None, "x > 2", "row != 3"])
def test_colours_and_rows_with_arrays(select: str | None) -> None:
    value = np.linspace(0, 1, 6)
    kept = {None: range(6), "x > 2": range(2, 6), "row != 3": (0, 1, 2, 4, 5)}[select]
    bars = np.stack([value, 1 - value, 0 * value], axis=1)
    for color in (ps.by(value, "viridis"), ps.by("q"), bars, "gold", "element"):
        look = {"style": "ball-and-stick", "view": "-y", "color": color, "select": select}
        picture = chain(q=value).render(layers=["row", "albedo"], **look, **SMALL)
        rows = picture["row"]
        assert set(rows[rows != ps.NONE]) == set(kept)
    reds = [np.median(picture["albedo"][rows == row][:, 0]) for row in kept]
    assert len(set(np.round(reds, 2))) == 2, "carbon and oxygen differ"


def test_colours_follow_an_array() -> None:
    value = np.linspace(0, 1, 6)
    color = np.stack([value, 0 * value, 0 * value], axis=1)
    look: dict[str, Any] = {"style": "ball-and-stick", "view": "-y", "color": color}
    picture = chain().render(layers=["row", "albedo"], **look, **SMALL)
    reds = [np.median(picture["albedo"][picture["row"] == row][:, 0]) for row in range(6)]
    assert (np.diff(reds) > 0).all()


@pytest.mark.parametrize(
    "radius, expected",
    [
        (None, 0.55 * 0.73),
        ("auto", 0.55 * 0.73),
        (0.3, 0.3),
        (np.full(6, 0.25), 0.25),
        ("size", 0.2),
        ("2 * size", 0.4),
        ("covalent", 0.73),
        ("vdw", 1.7),
    ],
)
def test_radii_of_balls(radius: Any, expected: float) -> None:
    scene = chain(size=np.full(6, 0.2)).scene(style="ball-and-stick", radius=radius)
    particles = scene._particles
    assert particles is not None
    assert particles["radius"][0] == pytest.approx(expected, rel=0.02)
    assert particles["radius"][-1] == pytest.approx(0.14)


def test_hydrogen_is_seen_before_the_background() -> None:
    atoms = ps.Particles(np.array([[0.0, 0, 0], [0, 0, 1.1]]), element=["C", "H"])
    look: dict[str, Any] = {"style": "ball-and-stick", "view": "-y", "no_legend": True, **SMALL}
    picture = atoms.render(layers=["row"], **{**look, "spp": 64})
    light = np.asarray(picture).mean(axis=2)
    hydrogen, behind = light[picture["row"] == 1].mean(), light[:8].mean()
    assert hydrogen > 1.5 * behind
    white = atoms.scene(style="ball-and-stick", background="white")
    assert white.content_hash != atoms.scene(style="ball-and-stick").content_hash


def test_wrong_radii_of_balls() -> None:
    with pytest.raises(ValueError, match="radius: row 0 is -1"):
        chain(size=-np.ones(6)).scene(style="ball-and-stick", radius="size")
    with pytest.raises(ps.Error, match="no column `sizes`"):
        chain(size=np.ones(6)).scene(style="ball-and-stick", radius="sizes")
    with pytest.raises(ValueError, match="no radius of balls"):
        chain().scene(style="ball-and-stick", radius="spacing")


def test_a_file_with_arrays_and_conditions(tmp_path: Path) -> None:
    lines = ["6", ""] + [f"{e} {x} {y} {z}" for e, (x, y, z) in zip(ELEMENT, CHAIN)]
    path = tmp_path / "chain.xyz"
    path.write_text("\n".join(lines) + "\n")
    p = ps.read(path).where("x > 1")
    scene = p.scene(style="ball-and-stick", view="-y", color=ps.by(np.arange(6.0)))
    rows = scene.render(layers=["row"], **SMALL)["row"]
    assert set(rows[rows != ps.NONE]) == set(range(1, 6))


def test_nanometres() -> None:
    small = ps.Particles(CHAIN / 10, element=ELEMENT, unit="nm")
    particles = small.scene(style="ball-and-stick")._particles
    larger = chain(unit="Å").scene(style="ball-and-stick")._particles
    assert particles is not None and larger is not None
    assert abs(len(particles) - len(larger)) < 6, "a bead more or less, by rounding"
    assert np.allclose(particles["radius"][:6] * 10, larger["radius"][:6])
    assert np.allclose(particles["radius"][-1] * 10, larger["radius"][-1])


def test_bonds_are_those_of_all_pairs() -> None:
    random = np.random.default_rng(2)
    positions = random.uniform(-6, 6, (300, 3))
    covalent = random.choice([0.31, 0.76, 0.66], 300)
    apart = np.linalg.norm(positions[:, None] - positions, axis=2)
    reach = covalent[:, None] + covalent
    good = (apart < 1.2 * reach) & (apart > 0.4 * reach)
    first, second = np.nonzero(np.triu(good, 1))
    assert len(first) > 50
    assert np.array_equal(_bonds.find_bonds(positions, covalent), np.stack([first, second], 1))
    assert len(_bonds.find_bonds(positions[:1], covalent[:1])) == 0


def test_bonds_within_some_of_the_atoms() -> None:
    bonds = np.array([[0, 1], [1, 2], [5, 2], [7, 9]])
    assert _bonds.bonds_within(bonds, np.array([5, 2, 1, 8])).tolist() == [[2, 1], [0, 1]]
    assert len(_bonds.bonds_within(bonds, np.array([], dtype=int))) == 0


def test_very_many_beads(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_bonds, "_MANY", 100)
    with pytest.warns(UserWarning, match=r"style: 5 bonds take 2\d\d beads, about .* GiB"):
        chain().scene(style="ball-and-stick")
    monkeypatch.setattr(_arrays, "MOST_ROWS", 200)
    with pytest.raises(ValueError, match="style: 5 bonds take .* more than a scene can have"):
        chain().scene(style="ball-and-stick")
