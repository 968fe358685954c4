"""Writes particle files with other programs, and compares what `photosphere pick` reads of them.

Run by scripts/try-adapters.sh. Each file is rendered small, with the view along z, and the particles
in random pixels must have the position and the values that the writing program has.
"""

import json
import os
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path

import numpy as np

warnings.filterwarnings("ignore")
PROGRAM = os.path.abspath(os.environ["PHOTOSPHERE"])
SEED = int.from_bytes(os.urandom(2), "little")
R = np.random.default_rng(SEED)
FAILED = []

# Pixels of each picture that are looked at.
PICKS = 14


def lattice(count):
    """Points of which none hides another from above."""
    side = int(np.ceil(np.sqrt(count)))
    grid = np.array([(i % side, i // side) for i in range(count)], float) * 2.0
    return np.column_stack([grid + R.uniform(-0.2, 0.2, (count, 2)), R.uniform(0, 1, count)])


def run(*words):
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(done.stderr.strip())
    return done.stdout


def check(name, path, positions, columns=None, tolerance=1e-6, radius=0.9):
    """Compares a file with positions and columns, particle by particle."""
    try:
        survey = json.loads(run("info", path, "--json"))
        if survey["count"] not in (None, len(positions)):
            raise RuntimeError(f"{survey['count']} particles instead of {len(positions)}")
        picture = path.with_suffix(".png")
        look = f"--view z --ortho --radius {radius} --spp 1 --size 96x96 --no-legend --quiet --ground false"
        run("render", path, "-o", picture, *look.split())
        seen = set()
        for x, y in R.integers(10, 86, (PICKS, 2)):
            found = json.loads(run("pick", picture, x, y, "--json"))
            if not found or found.get("row") is None:
                continue
            row = found["row"]
            seen.add(row)
            if not np.allclose(found["center"], positions[row], rtol=tolerance, atol=tolerance):
                raise RuntimeError(f"row {row}: {found['center']} instead of {positions[row]}")
            for key, values in (columns or {}).items():
                have, want = found["columns"][key], values[row]
                same = have == want if isinstance(have, str) else np.isclose(have, want, rtol=tolerance)
                if not same:
                    raise RuntimeError(f"row {row}: {key} is {have} instead of {want}")
        if len(seen) < 4:
            raise RuntimeError(f"only {len(seen)} particles are seen")
        print(f"ok      {name}: {len(seen)} particles compared")
    except Exception as error:
        FAILED.append(name)
        print(f"FAILED  {name}: {error}")


def with_ase(folder, points):
    import ase
    import ase.io

    symbols = R.choice(["O", "H", "Si", "Fe"], len(points))
    atoms = ase.Atoms(symbols, points, cell=[40, 40, 10], pbc=True)
    for name, style in [("a.xyz", "xyz"), ("b.xyz", "extxyz"), ("POSCAR", "vasp"), ("a.pdb", "proteindatabank")]:
        path = folder / f"ase-{name}" if name != "POSCAR" else folder / "POSCAR.poscar"
        if style == "vasp":
            atoms = atoms[np.argsort(atoms.symbols)]
        ase.io.write(path, atoms, format=style)
        back = ase.io.read(path, format=style)
        tolerance = 1e-3 if style == "proteindatabank" else 1e-6
        element = "species" if style == "extxyz" else "element"
        check(f"ase {ase.__version__} {style}", path, back.positions, {element: back.get_chemical_symbols()}, tolerance)


def with_gsd(folder, points):
    import gsd.hoomd

    frame = gsd.hoomd.Frame()
    frame.particles.N = len(points)
    frame.particles.position = points.astype("<f4")
    frame.particles.typeid = R.integers(0, 2, len(points))
    frame.particles.types = ["A", "B"]
    frame.configuration.box = [60, 60, 60, 0, 0, 0]
    path = folder / "a.gsd"
    with gsd.hoomd.open(str(path), "w") as file:
        file.append(frame)
    with gsd.hoomd.open(str(path), "r") as file:
        check(f"gsd {gsd.version.version}", path, file[0].particles.position)


def with_mdanalysis(folder, points):
    import MDAnalysis

    universe = MDAnalysis.Universe.empty(len(points), trajectory=True)
    universe.add_TopologyAttr("names", ["O"] * len(points))
    universe.add_TopologyAttr("resnames", ["SOL"])
    universe.atoms.positions = points
    universe.dimensions = [60, 60, 60, 90, 90, 90]
    for name in ["mda.gro", "mda.pdb"]:
        path = folder / name
        universe.atoms.write(path)
        # GRO files are in nanometres.
        scale = 0.1 if name.endswith("gro") else 1.0
        positions = MDAnalysis.Universe(str(path)).atoms.positions * scale
        check(f"MDAnalysis {MDAnalysis.__version__} {name[4:]}", path, positions, tolerance=1e-3, radius=0.9 * scale)


def with_ovito(folder, points):
    import ovito
    from ovito.data import DataCollection, Particles, SimulationCell
    from ovito.io import export_file

    data = DataCollection()
    particles = Particles(count=len(points))
    particles.create_property("Position", data=points)
    particles.create_property("Particle Type", data=np.ones(len(points), int))
    energy = R.normal(size=len(points))
    particles.create_property("c_pe", data=energy)
    data.objects.append(particles)
    cell = SimulationCell(pbc=(True, True, True))
    cell[...] = [[60, 0, 0, 0], [0, 60, 0, 0], [0, 0, 60, 0]]
    data.objects.append(cell)
    columns = ["Particle Type", "Position.X", "Position.Y", "Position.Z", "c_pe"]
    path = folder / "ovito.dump"
    export_file(data, str(path), "lammps/dump", columns=columns, precision=17)
    check(f"OVITO {ovito.version_string} dump", path, points, {"c_pe": energy})
    path = folder / "ovito.data"
    export_file(data, str(path), "lammps/data", atom_style="atomic", precision=17)
    check(f"OVITO {ovito.version_string} data", path, points)


def with_plyfile(folder, points):
    import importlib.metadata

    from plyfile import PlyData, PlyElement

    rows = np.rec.fromarrays([*points.T.astype("<f4"), R.normal(size=len(points))], names="x,y,z,quality")
    for text in (True, False):
        path = folder / f"text-{text}.ply"
        PlyData([PlyElement.describe(np.array(rows), "vertex")], text=text).write(str(path))
        back = PlyData.read(str(path))["vertex"]
        positions = np.column_stack([back["x"], back["y"], back["z"]])
        version = importlib.metadata.version("plyfile")
        check(f"plyfile {version} text={text}", path, positions, {"quality": back["quality"]})


def with_vtk(folder, points):
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk

    cloud, data = vtk.vtkPoints(), vtk.vtkPolyData()
    cloud.SetData(numpy_to_vtk(points, deep=True))
    data.SetPoints(cloud)
    values = R.normal(size=len(points))
    array = numpy_to_vtk(values, deep=True)
    array.SetName("heat")
    data.GetPointData().AddArray(array)
    for name, writer in [("a.vtp", vtk.vtkXMLPolyDataWriter()), ("a.vtk", vtk.vtkPolyDataWriter())]:
        path = folder / name
        writer.SetFileName(str(path))
        writer.SetInputData(data)
        writer.Write()
        tolerance = 1e-6 if name.endswith("vtp") else 1e-4
        check(f"vtk {vtk.vtkVersion.GetVTKVersion()} {name}", path, points, {"heat": values}, tolerance)


print(f"seed {SEED}")
with tempfile.TemporaryDirectory() as folder:
    for write in [with_ase, with_gsd, with_mdanalysis, with_ovito, with_plyfile, with_vtk]:
        try:
            write(Path(folder), lattice(int(R.integers(40, 120))))
        except Exception as error:
            FAILED.append(write.__name__)
            print(f"FAILED  {write.__name__}: {error}")
sys.exit(f"{len(FAILED)} failed" if FAILED else 0)
