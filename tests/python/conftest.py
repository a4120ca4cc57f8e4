"""Shared by the tests: the examples of the repository, and a service."""

from __future__ import annotations

import subprocess
import sys
import time
import warnings
from collections.abc import Iterator
from pathlib import Path

import pytest

import cognate as cg

REPOSITORY = Path(__file__).resolve().parents[2]
EXAMPLES = REPOSITORY / "deploy" / "examples"


@pytest.fixture(autouse=True)
def no_warnings() -> Iterator[None]:
    """Makes an unexpected warning a failure."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield


@pytest.fixture(scope="session")
def service() -> Iterator[cg.Service]:
    """One embedded service for all tests that leave it intact."""
    with cg.Service(workers=2, threads=1) as running:
        yield running


def katsura(n: int) -> cg.System:
    """Katsura's system: n + 1 equations, 2^n solutions. n = 12 takes some seconds."""
    u = [f"u{abs(i)}" for i in range(-n, n + 1)]

    def at(i: int) -> str | None:
        return u[i + n] if -n <= i <= n else None

    linear = "u0 + " + " + ".join(f"2*u{i}" for i in range(1, n + 1)) + " - 1"
    quadrics = []
    for m in range(n):
        terms = (f"{at(i)}*{at(m - i)}" for i in range(-n, n + 1) if at(m - i) is not None)
        quadrics.append(" + ".join(terms) + f" - u{m}")
    return cg.System([linear, *quadrics], [f"u{i}" for i in range(n + 1)])


def processes_with(word: str) -> list[str]:
    """Processes with a word among their arguments, without the test's own process."""
    listed = subprocess.run(["ps", "-ww", "-eo", "pid,stat,args"], capture_output=True, text=True, check=True)
    lines = (line for line in listed.stdout.splitlines() if word in line)
    return [
        line
        for line in lines
        if " Z" not in line and not line.split(None, 2)[2].startswith(sys.executable + " -m pytest")
    ]


def until(condition, seconds: float = 300.0) -> bool:  # type: ignore[no-untyped-def]
    """True if a condition holds before `seconds` have passed."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.05)
    return bool(condition())
