"""The command `cognate` of this package: replaces this process by the program."""

from __future__ import annotations

import os
import sys

from . import program
from .errors import ProgramNotFound


def main() -> int:
    """Runs the program with this process's arguments."""
    try:
        # The PATH is not searched, because it contains this command itself.
        path = program.find(search_path=False)
    except ProgramNotFound as e:
        print(f"error: {e}", file=sys.stderr)
        return 3
    os.execv(path, [path, *sys.argv[1:]])
