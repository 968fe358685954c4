"""photosphere: path-traced pictures of spheres, from arrays, particle files and scenes.

>>> import numpy as np, photosphere as ps
>>> xyz = np.random.default_rng(0).uniform(-5, 5, (1000, 3))
>>> scene = ps.spheres(xyz, radius=0.4)
>>> scene.render(80, 60, spp=4)
<picture of 80 x 60 pixels, 4 samples per pixel>

Four nouns: `Particles` are columns, a `Scene` is immutable, a `Render` progresses, stops, goes on
and merges, a `Picture` is arrays. The options of the command line are keywords of the same names.
"""

from __future__ import annotations

from typing import TYPE_CHECKING as _TYPE_CHECKING
from typing import Any as _Any

from . import _core
from ._adapters import from_ase, from_gsd, from_mdanalysis, from_ovito, from_pyvista
from ._errors import Error
from ._particles import By, Cell, Particles, by, read, spheres
from ._picture import Legend, Pick, Picture
from ._render import Part, Render, merge, resume
from ._scene import Plan, Scene, scene

if _TYPE_CHECKING:
    from ._objects import (
        Background,
        Camera,
        Conductor,
        Dielectric,
        Diffuse,
        EnvironmentMap,
        Glass,
        Gradient,
        Light,
        Metal,
        Mirror,
        Orthographic,
        Panoramic,
        Phong,
        Plastic,
        Principled,
        Sky,
        Sphere,
        Spheres,
        Sun,
        ThinLens,
    )

__all__ = [
    "NONE",
    "Background",
    "By",
    "Camera",
    "Cell",
    "Conductor",
    "Dielectric",
    "Diffuse",
    "EnvironmentMap",
    "Error",
    "Glass",
    "Gradient",
    "Legend",
    "Light",
    "Metal",
    "Mirror",
    "Orthographic",
    "Panoramic",
    "Part",
    "Particles",
    "Phong",
    "Pick",
    "Picture",
    "Plan",
    "Plastic",
    "Principled",
    "Render",
    "Scene",
    "Sky",
    "Sphere",
    "Spheres",
    "Sun",
    "ThinLens",
    "by",
    "from_ase",
    "from_gsd",
    "from_mdanalysis",
    "from_ovito",
    "from_pyvista",
    "merge",
    "read",
    "resume",
    "scene",
    "spheres",
]

#: The id of no sphere, in the layers `sphere_id` and `material_id`.
NONE = 4_294_967_295

__version__: str = _core.VERSION



def __getattr__(name: str) -> _Any:
    """Materials, cameras and the like, whose module is imported when one of them is used."""
    if name in __all__:
        from . import _objects

        return getattr(_objects, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """Names for completion, those of materials and the like included."""
    return sorted({*globals(), *__all__})
