"""Installing: one wheel with the package and the program, for this platform; the README's lines in a new folder."""

from __future__ import annotations

import os
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

import pytest

from cognate import program
from conftest import REPOSITORY

SOURCE = REPOSITORY / "deploy" / "python"

FIVE_LINES = """
import cognate as cg
found = cg.solve(["x^2 + y^2 - 4", "x*y - 1"])
print(found.counts.distinct, found.counts.real, found.settled, found.complete)
print(cg.__file__)
"""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, with the program from an earlier build."""
    folder = tmp_path_factory.mktemp("wheel")
    environment = {**os.environ, "COGNATE_PROGRAM": program.find()}
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation"]
    command += ["--disable-pip-version-check", "--wheel-dir", str(folder), str(SOURCE)]
    subprocess.run(command, check=True, env=environment)
    (found,) = folder.glob("*.whl")
    return found


def test_the_wheel_is_for_this_platform(wheel: Path) -> None:
    name, version, python, abi, platform = wheel.stem.split("-")
    assert (name, version, python, abi) == ("cognate_solver", "0.1.0", "py3", "none") and platform != "any"
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
        inside = archive.getinfo("cognate/bin/cognate")
    assert inside.external_attr >> 16 & 0o111, "the program may be run"
    assert {"cognate/py.typed", "cognate/_keeper.py", "cognate/formats/bertini.py"} <= names


def test_five_lines_in_a_new_environment(wheel: Path, tmp_path: Path) -> None:
    home = tmp_path / "venv"
    venv.create(home, with_pip=True)
    python = home / "bin" / "python"
    install = [python, "-m", "pip", "install", "--quiet", "--no-deps", "--disable-pip-version-check", wheel]
    environment = {k: v for k, v in os.environ.items() if k not in ("COGNATE_PROGRAM", "PYTHONPATH")}
    subprocess.run(install, check=True, env=environment)
    # The wheel contains the program, so none is needed on the PATH.
    environment["PATH"] = "/usr/bin:/bin"
    run = subprocess.run(
        [python, "-c", FIVE_LINES], env=environment, cwd=tmp_path, capture_output=True, text=True, check=True
    )
    first, second = run.stdout.splitlines()
    assert first == "4 4 True True" and second.startswith(str(home))
    assert run.stderr == ""
    version = subprocess.run([home / "bin" / "cognate", "--version"], capture_output=True, text=True, env=environment)
    assert version.returncode == 0 and version.stdout.startswith("cognate ")


def test_without_program_or_cargo_it_is_said(tmp_path: Path) -> None:
    environment = {k: v for k, v in os.environ.items() if k != "COGNATE_PROGRAM"}
    environment["PATH"] = str(tmp_path)
    command = [sys.executable, "setup.py", "--quiet", "build_py", "--build-lib", str(tmp_path / "lib")]
    run = subprocess.run(command, cwd=SOURCE, env=environment, capture_output=True, text=True)
    assert run.returncode != 0 and "cargo is needed" in run.stderr and "COGNATE_PROGRAM=" in run.stderr
