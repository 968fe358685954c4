"""Writes TOML: the format of scene files. Python itself only reads it."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Mapping, Sequence
from typing import Any

__all__ = ["document", "value"]

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def value(given: Any) -> str:
    """A value on one line."""
    if hasattr(given, "toml"):
        given = given.toml()
    if isinstance(given, bool):
        return "true" if given else "false"
    if isinstance(given, str):
        return _string(given)
    if isinstance(given, os.PathLike):
        return _string(os.fspath(given))
    if isinstance(given, Mapping):
        pairs = (f"{_key(name)} = {value(one)}" for name, one in given.items() if one is not None)
        return "{ " + ", ".join(pairs) + " }"
    if isinstance(given, Sequence):
        return "[" + ", ".join(value(one) for one in given) + "]"
    if hasattr(given, "tolist"):
        return value(given.tolist())
    if isinstance(given, int):
        return str(given)
    if isinstance(given, float):
        if math.isfinite(given):
            return repr(given)
        return "nan" if math.isnan(given) else ("inf" if given > 0 else "-inf")
    raise TypeError(f"{given!r} is no value of a scene file")


def document(tables: Mapping[str, Any]) -> str:
    """A scene as the text of a file: tables of tables get headings, the rest stays on one line."""
    lines: list[str] = []
    _table(tables, (), lines)
    return "\n".join(lines).strip() + "\n"


def _table(table: Mapping[str, Any], path: tuple[str, ...], lines: list[str]) -> None:
    nested = {name: one for name, one in table.items() if _is_nested(one)}
    for name, one in table.items():
        if name not in nested and one is not None:
            lines.append(f"{_key(name)} = {value(one)}")
    for name, one in nested.items():
        here = (*path, name)
        heading = ".".join(_key(part) for part in here)
        if isinstance(one, Mapping):
            if any(not _is_nested(inner) for inner in one.values()) or not one:
                lines += ["", f"[{heading}]"]
            _table(one, here, lines)
        else:
            for entry in one:
                lines += ["", f"[[{heading}]]"]
                _table(entry, here, lines)


def _is_nested(given: Any) -> bool:
    if isinstance(given, Mapping):
        return True
    is_list = isinstance(given, list) and bool(given)
    return is_list and all(isinstance(entry, Mapping) for entry in given)


def _key(name: str) -> str:
    return name if _BARE.fullmatch(name) else _string(name)


def _string(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c.isprintable() else f"\\u{ord(c):04X}" for c in escaped) + '"'
