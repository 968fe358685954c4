"""The exception of the package."""

from __future__ import annotations

import re
from collections.abc import Mapping

__all__ = ["Error"]


class Error(Exception):
    """What is wrong with a scene, a file or an option, in the words of the command line.

    Attributes:
        help: How to fix it, or None.
        file: The scene file that is wrong, or None.
        line: The line in that file, from 1, or None.
        column: The column in that line, from 1, or None.
        category: "input", "file", "backend", "cancelled", or "usage" for an option.
    """

    def __init__(
        self,
        message: str,
        *,
        help: str | None = None,
        file: str | None = None,
        line: int | None = None,
        column: int | None = None,
        category: str = "input",
    ) -> None:
        self.message = _in_python(message)
        self.help = _in_python(help) if help else None
        self.file = file
        self.line = line
        self.column = column
        self.category = category
        super().__init__(self.message)

    def __str__(self) -> str:
        return f"{self.message}\n  help: {self.help}" if self.help else self.message

    def _renamed(self, names: Mapping[str, str]) -> Error:
        """The error with other names for files."""

        def renamed(text: str | None) -> str | None:
            for old, new in names.items():
                text = text and text.replace(f"`{old}`", new).replace(old, new)
            return text

        return Error(
            renamed(self.message) or "",
            help=renamed(self.help),
            file=self.file,
            line=self.line,
            column=self.column,
            category=self.category,
        )

    def __reduce__(self) -> tuple[object, ...]:
        return _restore, (self.message, self.help, self.file, self.line, self.column, self.category)


def _restore(
    message: str,
    help: str | None,
    file: str | None,
    line: int | None,
    column: int | None,
    category: str,
) -> Error:
    return Error(message, help=help, file=file, line=line, column=column, category=category)


def _in_python(text: str) -> str:
    """Names options as keywords: `--max-spp` is `max_spp`."""
    text = re.sub(r"--([a-z]+(?:-[a-z]+)*) <[A-Z:.,-]+>", r"--\1", text)
    return re.sub(r"(?<![\w-])--([a-z]+(?:-[a-z]+)*)", lambda m: m[1].replace("-", "_"), text)
