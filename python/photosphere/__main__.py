"""The command line: `python -m photosphere`, and the script `photosphere`."""

from __future__ import annotations

import sys

from . import _core


def main() -> None:
    """Runs the command of `sys.argv` and ends the process with its exit code."""
    sys.stdout.flush()
    _core.main(["photosphere", *sys.argv[1:]])


if __name__ == "__main__":
    main()
