"""Puts the `cognate` program into the wheel.

The program is built by `cargo build --release` in the repository that this folder belongs to, with what is
already built there; or, where the environment variable COGNATE_PROGRAM names a built program, that one is
taken as it is. A wheel is for one platform and any Python 3; deploy/release.sh, whose program is static, names
the platforms by COGNATE_WHEEL_PLATFORMS.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_py import build_py
from setuptools.dist import Distribution

REPOSITORY = Path(__file__).resolve().parents[2]


def program() -> Path:
    """The program that goes into the wheel."""
    given = os.environ.get("COGNATE_PROGRAM")
    if given:
        path = Path(given)
        if not path.is_file():
            raise SystemExit(f"COGNATE_PROGRAM={given}: no such file")
        return path
    if shutil.which("cargo") is None:
        raise SystemExit(
            "cargo is needed to build the program of this package (Rust 1.94 or newer); "
            "or name a built one: COGNATE_PROGRAM=/path/to/cognate pip install ..."
        )
    if not (REPOSITORY / "coordinator" / "Cargo.toml").is_file():
        raise SystemExit(f"{REPOSITORY}: the sources of the program are not here")
    command = ["cargo", "build", "--release", "--locked", "-p", "cognate-client", "--bin", "cognate"]
    print(f"building the program by `{' '.join(command)}`; this takes minutes", file=sys.stderr, flush=True)
    subprocess.run(command, cwd=REPOSITORY, check=True)
    target = Path(os.environ.get("CARGO_TARGET_DIR", "target"))
    return REPOSITORY / target / "release" / "cognate"


class BuildWithProgram(build_py):
    """Copies the package, and the program beside it."""

    def run(self) -> None:
        # A module of an earlier build that is no more must not come along.
        shutil.rmtree(Path(self.build_lib) / "cognate", ignore_errors=True)
        super().run()
        # An editable install uses COGNATE_PROGRAM, or the program on the PATH.
        if self.editable_mode:
            return
        to = Path(self.build_lib) / "cognate" / "bin" / "cognate"
        to.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(program(), to)
        # Line tables are for those who build the program; in a wheel they are most of its size.
        if shutil.which("strip") and not os.environ.get("COGNATE_PROGRAM"):
            subprocess.run(["strip", "--strip-debug", str(to)], check=False)
        to.chmod(0o755)


class WheelOfOnePlatform(bdist_wheel):
    """A wheel for this platform and any Python 3: the program needs no Python."""

    def get_tag(self) -> tuple[str, str, str]:
        return ("py3", "none", os.environ.get("COGNATE_WHEEL_PLATFORMS") or super().get_tag()[2])


class WithProgram(Distribution):
    """Tells setuptools that the wheel belongs to a platform."""

    def has_ext_modules(self) -> bool:
        return True


setup(
    distclass=WithProgram,
    cmdclass={"build_py": BuildWithProgram, "bdist_wheel": WheelOfOnePlatform},
)
