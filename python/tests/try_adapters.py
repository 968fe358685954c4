"""Renders what real packages hold; run by scripts/try-python-adapters.sh, not by pytest."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np

import photosphere as ps

OUT = Path(sys.argv[1])
RENDER: dict[str, Any] = {"width": 320, "height": 240, "spp": 16, "quiet": True}


def show(name: str, scene: ps.Scene) -> None:
    """Renders a scene and says what it has."""
    picture = scene.render(**RENDER)
    picture.save(OUT / f"{name}.png")
    particles = scene._particles
    columns = particles.columns if particles is not None else []
    print(f"{name}: {scene.n} spheres, columns {', '.join(columns)}; mean {np.asarray(picture).mean():.3f}")


def try_ase() -> Any:
    """A molecule, a crystal, and both plug-ins."""
    from ase.build import bulk, molecule

    show("ase-molecule", ps.from_ase(molecule("C6H6"), style="ball-and-stick"))
    salt = bulk("NaCl", "rocksalt", a=5.64, cubic=True) * (3, 3, 3)
    show("ase-crystal", ps.from_ase(salt, cell=True))
    salt.write(OUT / "ase-format.png", format="photosphere", width=320, height=240, spp=16)
    return salt


def try_mdanalysis() -> None:
    """Water in a box."""
    import MDAnalysis as mda

    random = np.random.default_rng(0)
    count = 200
    universe = mda.Universe.empty(
        3 * count, n_residues=count, atom_resindex=np.repeat(range(count), 3), trajectory=True
    )
    universe.add_TopologyAttr("names", ["OW", "HW1", "HW2"] * count)
    universe.add_TopologyAttr("elements", ["O", "H", "H"] * count)
    oxygen = random.uniform(0, 20, (count, 1, 3))
    offsets = np.array([[0, 0, 0], [0.96, 0, 0], [-0.24, 0.93, 0]])
    universe.atoms.positions = (oxygen + offsets).reshape(-1, 3)
    universe.dimensions = [20, 20, 20, 90, 90, 90]
    bonds = [(3 * at, 3 * at + one) for at in range(count) for one in (1, 2)]
    universe.add_TopologyAttr("bonds", bonds)
    show("mdanalysis", ps.from_mdanalysis(universe, color="element", cell=True))
    some = universe.select_atoms("index 30:330")
    show("mdanalysis-sticks", ps.from_mdanalysis(some, style="ball-and-stick"))


def try_ovito(salt: Any) -> None:
    """A crystal through OVITO's own types."""
    from ovito.io.ase import ase_to_ovito

    data = ase_to_ovito(salt)
    show("ovito", ps.from_ovito(data, cell=True))
    energy = np.linspace(-1, 1, data.particles.count)
    data.particles_.create_property("Potential Energy", data=energy)
    show("ovito-energy", ps.from_ovito(data, color=ps.by("Potential_Energy", "vik")))


def try_pyvista() -> None:
    """Points with a scalar."""
    import pyvista as pv

    mesh = pv.Sphere(radius=3, theta_resolution=30, phi_resolution=30)
    mesh.point_data["height"] = mesh.points[:, 2]
    show("pyvista", ps.from_pyvista(mesh, color=ps.by("height", "batlow")))


def try_gsd() -> None:
    """A frame that is written and read."""
    import gsd.hoomd

    frame = gsd.hoomd.Frame()
    random = np.random.default_rng(0)
    frame.particles.N = 300
    frame.particles.position = random.uniform(-5, 5, (300, 3))
    frame.particles.types = ["A", "B"]
    frame.particles.typeid = random.integers(0, 2, 300)
    frame.particles.diameter = np.where(frame.particles.typeid == 0, 0.8, 0.5)
    frame.configuration.box = [10, 10, 10, 0, 0, 0]
    path = OUT / "a.gsd"
    with gsd.hoomd.open(str(path), "w") as file:
        file.append(frame)
    with gsd.hoomd.open(str(path)) as file:
        show("gsd", ps.from_gsd(file[-1], cell=True))
    show("gsd-file", ps.read(path).scene(cell=True))


crystal = try_ase()
try_mdanalysis()
try_ovito(crystal)
try_pyvista()
try_gsd()
