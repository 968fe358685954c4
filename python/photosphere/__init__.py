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

from . import _core

# An import takes a few milliseconds: each module is loaded when one of its names is used first.
# Type checkers read the same names in __init__.pyi.
_NAMES = {
    "_adapters": ("from_ase", "from_gsd", "from_mdanalysis", "from_ovito", "from_pyvista"),
    "_errors": ("Error",),
    "_objects": (
        "Background",
        "Camera",
        "Conductor",
        "Dielectric",
        "Diffuse",
        "EnvironmentMap",
        "Glass",
        "Gradient",
        "Light",
        "Metal",
        "Mirror",
        "Orthographic",
        "Panoramic",
        "Phong",
        "Plastic",
        "Principled",
        "Sky",
        "Sphere",
        "Spheres",
        "Sun",
        "ThinLens",
    ),
    "_particles": ("By", "Cell", "Particles", "by", "read", "spheres"),
    "_picture": ("Legend", "Pick", "Picture"),
    "_render": ("Part", "Render", "merge", "resume"),
    "_scene": ("Plan", "Scene", "scene"),
}
_MODULE_OF = {name: module for module, names in _NAMES.items() for name in names}

__all__ = ["NONE", *_MODULE_OF]

#: The id of no sphere, in the layers `sphere_id` and `material_id`.
NONE = 4_294_967_295

__version__ = _core.VERSION


def __getattr__(name: str) -> object:
    if name not in _MODULE_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    import importlib

    one = getattr(importlib.import_module(f".{_MODULE_OF[name]}", __name__), name)
    globals()[name] = one
    return one


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
