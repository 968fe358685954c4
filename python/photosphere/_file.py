"""Particle files, of which nothing is read before it is needed."""

from __future__ import annotations

import functools
import json
import os
from dataclasses import dataclass, replace
from typing import Any

from . import _core

__all__ = ["ParticleFile"]


@dataclass(frozen=True)
class ParticleFile:
    """A particle file, which is read when something of it is asked for."""

    path: str
    format: str | None
    frame: int
    columns: tuple[str, ...] | None
    topology: str | None
    #: Names of the columns of a file that names none.
    names: tuple[str, ...] = ()

    def survey(self, count: bool = False) -> dict[str, Any]:
        names = list(self.names)
        return json.loads(
            _core.survey(self.path, self.format, self.frame, names, self.topology, count)
        )

    def frames(self) -> int:
        return int(self.survey(count=True)["frames"])

    def count(self) -> int:
        known = self.survey()["count"]
        return int(known) if known is not None else self.read().count()

    def column_names(self) -> list[str]:
        if self.columns is not None:
            return list(self.columns)
        return [column["name"] for column in self.survey()["columns"]]

    def read(self) -> _core.Columns:
        return _read(self, os.stat(self.path).st_mtime_ns)

    def read_for(self, condition: str) -> _core.Columns:
        """The columns that a condition names, and those that are read anyway."""
        text = condition.lower()
        found = [column["name"] for column in self.survey()["columns"]]
        needed = tuple(name for name in found if name.lower() in text)
        if self.columns is None or set(needed) <= set(self.columns):
            return self.read()
        return replace(self, columns=needed).read()


@functools.lru_cache(maxsize=1)
def _read(file: ParticleFile, _changed: int) -> _core.Columns:
    columns = None if file.columns is None else list(file.columns)
    return _core.Columns.read(
        file.path, file.format, file.frame, columns, list(file.names), file.topology
    )
