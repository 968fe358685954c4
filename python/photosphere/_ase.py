"""The entry points of ASE, which imports this module itself."""

from __future__ import annotations

from ase.utils.plugins import ExternalIOFormat, ExternalViewer

__all__ = ["FORMAT", "VIEWER"]

#: `atoms.write("a.png", format="photosphere")`
FORMAT = ExternalIOFormat(
    desc="Path-traced picture", code="+S", module="photosphere._plugins"
)

#: `view(atoms, viewer="photosphere")`
VIEWER = ExternalViewer(desc="Path-traced pictures", module="photosphere._plugins")
