"""What ASE and PyVista call by their entry points."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from typing import Any

from ._adapters import from_ase, from_pyvista
from ._particles import _part

__all__ = ["pyvista_backend", "view_photosphere", "write_photosphere"]

def write_photosphere(path: str | os.PathLike[str], images: Any, **options: Any) -> None:
    """Writes ASE's `Atoms` as a picture: `atoms.write("a.png", format="photosphere")`."""
    atoms = images[-1] if isinstance(images, (list, tuple)) else images
    look, rest = _part(options)
    from_ase(atoms, **look).render(**rest).save(path)


def view_photosphere(
    atoms: Any, data: Any = None, repeat: Any = None, **options: Any
) -> Any:
    """Shows ASE's `Atoms`: a render in a notebook, else a picture in the desktop's viewer.

    ASE passes `data`, a field over the cell, which is not drawn, and `repeat`, the copies along
    each edge of the cell.
    """
    atoms = atoms[-1] if isinstance(atoms, list) else atoms
    if repeat is not None:
        atoms = atoms.repeat(repeat)
    render = from_ase(atoms, **options).start()
    if _in_notebook():
        return render
    handle, path = tempfile.mkstemp(suffix=".png", prefix="photosphere-")
    os.close(handle)
    render.wait().save(path)
    opener = {"darwin": "open", "win32": "explorer"}.get(sys.platform, "xdg-open")
    try:
        subprocess.Popen([opener, path], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    except OSError:
        print(path)
    return render


def pyvista_backend(plotter: Any, screenshot: Any = None, **options: Any) -> Any:
    """Shows a PyVista plotter in a notebook: the points of its meshes, from its camera."""
    from ._objects import Camera

    meshes = [one for one in plotter.meshes if hasattr(one, "points")]
    if not meshes:
        raise ValueError("plotter: there is no mesh with points")
    given = plotter.camera
    camera = Camera(
        tuple(given.position),
        tuple(given.focal_point),
        up=tuple(given.up),
        vertical_fov_degrees=float(given.view_angle),
    )
    allowed = {name: one for name, one in options.items() if name in ("style", "material")}
    scene = from_pyvista(meshes[0], camera=camera, **allowed)
    width, height = (int(one) for one in plotter.window_size)
    return scene.start(width, height)


def _in_notebook() -> bool:
    return "ipykernel" in sys.modules
