"""The command `cognate` of this package: the program itself, in the place of this process."""

from __future__ import annotations

import os
import sys

from . import program
from .errors import ProgramNotFound


def main() -> int:
    """Runs the program with this process's arguments."""
    try:
        # Not by the PATH, where this command itself would be found.
        path = program.find(search_path=False)
    except ProgramNotFound as e:
        print(f"error: {e}", file=sys.stderr)
        return 3
    os.execv(path, [path, *sys.argv[1:]])
