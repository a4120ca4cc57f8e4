"""Types by mypy, and every example of docstrings and README."""

from __future__ import annotations

import doctest
import importlib
import os
import pkgutil
import subprocess
import sys
from pathlib import Path

import pytest

import cognate
from conftest import REPOSITORY

PACKAGE = Path(cognate.__file__).parent
MODULES = sorted(m.name for m in pkgutil.walk_packages([str(PACKAGE)], "cognate.") if not m.name.endswith("_keeper"))
SOURCE = REPOSITORY / "deploy" / "python"


def test_types() -> None:
    command = [
        sys.executable,
        "-m",
        "mypy",
        "--cache-dir",
        os.devnull,
        "--config-file",
        str(SOURCE / "pyproject.toml"),
        str(SOURCE / "cognate"),
    ]
    run = subprocess.run(command, capture_output=True, text=True, cwd=SOURCE)
    assert run.returncode == 0, run.stdout + run.stderr


@pytest.mark.parametrize("command", [["check"], ["format", "--check"]], ids=["lints", "format"])
def test_lints_and_format(command: list[str]) -> None:
    paths = [str(SOURCE), str(REPOSITORY / "deploy" / "release"), str(REPOSITORY / "tests" / "python")]
    ruff = [sys.executable, "-m", "ruff", *command, "--no-cache", "--config", str(SOURCE / "pyproject.toml")]
    run = subprocess.run([*ruff, *paths], capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr


def test_users_have_types(tmp_path: Path) -> None:
    user = tmp_path / "user.py"
    user.write_text(
        "import cognate as cg\n"
        "found: cg.Result = cg.solve(['x - 1'], certify=True, digits=30)\n"
        "n: int = found.counts.distinct\n"
        "z: complex = found.solutions[0]['x']\n"
        "cg.solve(['x - 1'], certfy=True)\n"
    )
    run = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", str(user)], capture_output=True, text=True, cwd=tmp_path
    )
    assert "user.py:5" in run.stdout and "Found 1 error" in run.stdout, run.stdout


@pytest.mark.parametrize("module", ["cognate", *MODULES])
def test_examples_of_docstrings(module: str) -> None:
    failed, _ = doctest.testmod(importlib.import_module(module), optionflags=doctest.NORMALIZE_WHITESPACE)
    assert failed == 0


def test_examples_are_there() -> None:
    finder = doctest.DocTestFinder(exclude_empty=True)
    modules = (importlib.import_module(m) for m in ("cognate", *MODULES))
    assert sum(len(t.examples) for m in modules for t in finder.find(m)) >= 25


def test_examples_of_the_readme(monkeypatch: pytest.MonkeyPatch) -> None:
    # Files are named from the root of the repository.
    monkeypatch.chdir(REPOSITORY)
    failed, attempted = doctest.testfile(
        str(SOURCE / "README.md"),
        module_relative=False,
        optionflags=doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS,
    )
    assert failed == 0 and attempted >= 15


def test_public_names_have_docs() -> None:
    for name in cognate.__all__:
        thing = getattr(cognate, name)
        assert thing.__doc__, name
        if isinstance(thing, type):
            for member, value in vars(thing).items():
                if not member.startswith("_") and (callable(value) or isinstance(value, property)):
                    assert value.__doc__, f"{name}.{member}"
