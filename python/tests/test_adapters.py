"""Objects of other packages, here small ones with the same attributes."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import photosphere as ps

WATER = np.array([[0, 0, 0], [0.96, 0, 0], [-0.24, 0.93, 0]]) + 2.0
SMALL: dict[str, Any] = {"spp": 4, "quiet": True}


def ase_atoms() -> SimpleNamespace:
    """What `ase.Atoms` has."""
    return SimpleNamespace(
        positions=WATER,
        arrays={"positions": WATER, "numbers": np.array([8, 1, 1]), "forces": WATER * 0.1},
        cell=np.eye(3) * 6.0,
        pbc=np.array([True, True, False]),
        get_chemical_symbols=lambda: ["O", "H", "H"],
    )


def test_ase() -> None:
    scene = ps.from_ase(ase_atoms(), cell=True)
    particles = scene._particles
    assert particles is not None
    assert particles.columns == ["element", "forces_x", "forces_y", "forces_z"]
    assert scene._describe()["edges"] > 0
    assert scene.render(64, 48, **SMALL).legend is not None


def test_ball_and_stick() -> None:
    scene = ps.from_ase(ase_atoms(), style="ball-and-stick", cell=True)
    beads = scene._describe()["particles"] - 3
    assert 2 * 14 <= beads <= 2 * 60, "two bonds"
    assert scene.render(64, 48, **SMALL).width == 64
    with pytest.raises(ValueError, match="needs a column `element`"):
        ps.spheres(WATER, style="ball-and-stick")


def test_mdanalysis() -> None:
    class Group(SimpleNamespace):
        def __getattr__(self, name: str) -> Any:
            raise LookupError(name)

    atoms = Group(
        positions=WATER.astype("f4"),
        names=np.array(["OW", "HW1", "HW2"], dtype=object),
        resids=np.array([1, 1, 1]),
        dimensions=np.array([6, 6, 6, 90, 90, 60], dtype="f4"),
        indices=np.arange(3),
        bonds=SimpleNamespace(indices=np.array([[0, 1], [0, 2]])),
    )
    atoms.atoms = atoms
    scene = ps.from_mdanalysis(SimpleNamespace(atoms=atoms), color="element")
    particles = scene._particles
    assert particles is not None
    assert list(particles["element"]) == ["O", "H", "H"] and particles.cell is not None
    assert np.allclose(particles.cell.vectors[1], [3, 3 * np.sqrt(3), 0], atol=1e-5)
    sticks = ps.from_mdanalysis(atoms, style="ball-and-stick")
    assert sticks._describe()["particles"] > 3


def test_ovito() -> None:
    class Property(np.ndarray):
        types: list[Any]

    kinds = np.array([1, 2, 2]).view(Property)
    kinds.types = [
        SimpleNamespace(id=1, name="O", radius=0.6, color=(1, 0, 0)),
        SimpleNamespace(id=2, name="H", radius=0.3, color=(1, 1, 1)),
    ]

    class Table(dict[str, Any]):
        bonds = None

    properties = Table(
        {"Position": WATER, "Particle Type": kinds, "Potential Energy": np.array([1.0, 2, 3])}
    )
    cell = np.hstack([np.eye(3) * 6, np.zeros((3, 1))])
    data = SimpleNamespace(particles=properties, cell=cell)
    scene = ps.from_ovito(data)
    particles = scene._particles
    assert particles is not None
    assert list(particles["radius"]) == [0.6, 0.3, 0.3]
    assert list(particles["type"]) == ["O", "H", "H"]
    assert "Potential_Energy" in particles.columns
    assert scene.render(64, 48, layers=["albedo"], **SMALL)["albedo"].max() > 0.5
    properties["Transparency"] = np.array([0.0, 1.0, 0.0])
    assert ps.from_ovito(data, color="Potential_Energy")._describe()["particles"] == 2


def test_pyvista() -> None:
    mesh = SimpleNamespace(
        points=WATER.astype("f4"), point_data={"diameter": np.array([1.0, 0.5, 0.5]), "v": WATER}
    )
    scene = ps.from_pyvista(mesh, color="v_x")
    assert scene.render(64, 48, **SMALL).legend is not None
    assert "diameter" in scene.choices.get("radius", "diameter")


def test_pyvista_backend() -> None:
    from photosphere._plugins import pyvista_backend

    mesh = SimpleNamespace(points=WATER, point_data={})
    camera = SimpleNamespace(position=(2, 2, 20), focal_point=(2, 2, 2), up=(0, 1, 0), view_angle=30)
    plotter = SimpleNamespace(meshes=[mesh], camera=camera, window_size=[64, 48])
    render = pyvista_backend(plotter)
    assert (render.wait().picture.width, render.picture.height) == (64, 48)


def test_gsd() -> None:
    particles = SimpleNamespace(
        position=WATER.astype("f4"),
        types=["A", "B"],
        typeid=np.array([0, 1, 1]),
        diameter=np.array([1.2, 0.6, 0.6], dtype="f4"),
        mass=None,
    )
    configuration = SimpleNamespace(box=[6, 6, 6, 0.5, 0, 0])
    scene = ps.from_gsd(SimpleNamespace(particles=particles, configuration=configuration))
    made = scene._particles
    assert made is not None and list(made["type"]) == ["A", "B", "B"]
    assert made["radius"][0] == pytest.approx(0.6)
    assert np.allclose(made.cell.vectors[1], [3, 6, 0])  # type: ignore[union-attr]


def test_the_entry_points_of_ase(tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    from importlib.metadata import entry_points

    ase = pytest.importorskip("ase")
    if not any(one.name == "photosphere" for one in entry_points(group="ase.ioformats")):
        pytest.skip("the package is not installed")
    from ase.visualize import view
    from ase.visualize.viewers import VIEWERS

    atoms = ase.Atoms("OH2", positions=WATER)
    path = tmp_path / "a.png"
    atoms.write(path, format="photosphere", width=64, height=48, spp=4, style="dark", quiet=True)
    assert path.read_bytes().startswith(b"\x89PNG")
    assert "photosphere" in VIEWERS

    # As ASE calls it, with a small render and no viewer.
    from photosphere import _plugins

    small = lambda atoms, **look: SimpleNamespace(  # noqa: E731
        start=lambda: ps.from_ase(atoms, **look).start(48, 32, spp=2, quiet=True)
    )
    monkeypatch.setattr(_plugins, "from_ase", small)
    monkeypatch.setattr(_plugins, "_in_notebook", lambda: False)
    opened = []
    monkeypatch.setattr(_plugins.subprocess, "Popen", lambda words, **_: opened.append(words))
    view(atoms, viewer="photosphere")
    atoms.set_cell([4, 4, 4])
    view(atoms, viewer="photosphere", repeat=(2, 1, 1))
    assert len(opened) == 2
    for _, file in opened:
        assert Path(file).read_bytes().startswith(b"\x89PNG")
        Path(file).unlink()
