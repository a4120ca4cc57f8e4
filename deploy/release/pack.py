"""Packs a built program for those who install it; deploy/release.sh calls it, with what it has found out.

usage: pack.py OUT --program FILE --target TRIPLE --metadata FILE --rust VERSION --target-libraries FOLDER --zig FOLDER
       [--pages FOLDER]

The folder OUT gets archives and lists; the same files give the same bytes. SOURCE_DATE_EPOCH is the time of everything.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from archives import (
    FILE,
    PROGRAM,
    SHARED_FOLDER,
    Entry,
    container_image,
    debian_package,
    files_below,
    tar,
    zipped,
)
from libraries import Library, bill_of_materials, libraries, licence_texts

ROOT = Path(__file__).resolve().parents[2]

LGPL_CRATES = ("gmp-mpfr-sys", "rug")
"""The crates under the LGPL: the sources of GMP, MPFR and MPC come with the first."""

LICENCES = "LICENSES-OF-LIBRARIES.txt"

WHEEL_PLATFORMS = {
    "x86_64": "manylinux_2_17_x86_64.manylinux2014_x86_64.musllinux_1_1_x86_64",
    "aarch64": "manylinux_2_17_aarch64.manylinux2014_aarch64.musllinux_1_1_aarch64",
}
"""Platforms of a wheel by processor: a static program needs no C library, so it suits both families."""

DEBIAN_NAMES = {"x86_64": "amd64", "aarch64": "arm64"}
"""What Debian and containers call processors."""

CONTAINER_USER = 10001
"""The user of container/Dockerfile and of the manifests for Kubernetes."""

DESCRIPTION = """\
Description: all solutions of systems of polynomial equations
 Cognate finds all isolated solutions of a system of polynomial equations by
 following paths (homotopy continuation), on one machine or on many: linkages,
 platforms, serial arms, families of systems, components of every dimension.
"""


def main() -> None:
    """Packs, and says what lies in OUT."""
    arguments = parsed()
    epoch = int(os.environ["SOURCE_DATE_EPOCH"])
    out = Path(arguments.out)
    program = Path(arguments.program).read_bytes()
    processor = arguments.target.split("-")[0]
    version = version_of_the_workspace()
    metadata = json.loads(Path(arguments.metadata).read_text(encoding="utf-8"))
    ordered = libraries(ROOT, metadata, Path(arguments.target_libraries), Path(arguments.zig), arguments.rust)

    licences = {name: (ROOT / name).read_bytes() for name in ("LICENSE-APACHE", "LICENSE-MIT")}
    licences[LICENCES] = licence_texts(ordered).encode()
    pages = Path(arguments.pages) if arguments.pages else None

    def write(name: str, data: bytes) -> None:
        (out / name).write_bytes(data)

    write(f"cognate-{version}-{processor}.cdx.json", sbom(ordered, epoch, program))
    write(f"cognate-{version}-{processor}.licences.txt", licences[LICENCES])
    write(f"cognate-{version}-{processor}-linux.tar.gz", tarball(version, processor, program, licences, pages, epoch))
    debian = DEBIAN_NAMES[processor]
    write(f"cognate_{version}_{debian}.deb", package(version, debian, program, licences, pages, epoch))
    write(f"cognate-{version}-{debian}.container.tar", image(version, debian, program, licences, epoch))
    wheel(out, Path(arguments.program), processor, licences)
    write(f"cognate-{version}-source.tar.gz", zipped(sources(version)))
    write(f"cognate-{version}-lgpl-sources.tar.gz", zipped(lgpl_sources(version, metadata, epoch)))
    write("SHA256SUMS", sums(out))


def parsed() -> argparse.Namespace:
    """The arguments."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out")
    for name in ("--program", "--target", "--metadata", "--rust", "--target-libraries", "--zig"):
        parser.add_argument(name, required=True)
    parser.add_argument("--pages", help="folder of manual pages and completions, if there is one")
    return parser.parse_args()


def version_of_the_workspace() -> str:
    """The version of all crates, which the Python package must share."""
    manifest = (ROOT / "Cargo.toml").read_text(encoding="utf-8")
    project = (ROOT / "deploy" / "python" / "pyproject.toml").read_text(encoding="utf-8")
    (version,) = re.findall(r'^version = "([^"]+)"$', manifest, re.MULTILINE)
    if f'\nversion = "{version}"\n' not in project:
        raise SystemExit(f"Cargo.toml says version {version}, deploy/python/pyproject.toml another")
    return str(version)


def sbom(ordered: list[Library], epoch: int, program: bytes) -> bytes:
    """The list of libraries for machines."""
    return bill_of_materials(ordered, epoch, hashlib.sha256(program).hexdigest()).encode()


def examples(to: str) -> list[Entry]:
    """The systems of deploy/examples."""
    return files_below(ROOT / "deploy" / "examples", to)


def tarball(
    version: str, processor: str, program: bytes, licences: dict[str, bytes], pages: Path | None, epoch: int
) -> bytes:
    """One folder with the program, to be unpacked anywhere."""
    top = f"cognate-{version}-{processor}-linux"
    entries = [Entry(f"{top}/cognate", program, PROGRAM), Entry(f"{top}/README.md", readme())]
    entries += [Entry(f"{top}/{name}", text) for name, text in licences.items()]
    entries += examples(f"{top}/examples")
    if pages:
        entries += files_below(pages, f"{top}/share")
    return zipped(tar(entries, epoch))


def readme() -> bytes:
    """The front page; its links lead into the sources."""
    return (ROOT / "README.md").read_bytes()


def package(
    version: str, debian: str, program: bytes, licences: dict[str, bytes], pages: Path | None, epoch: int
) -> bytes:
    """The Debian package: program, manual, completions, examples."""
    documents = "usr/share/doc/cognate"
    copyright_page = (
        "Cognate is under the MIT licence (LICENSE-MIT) or the Apache licence 2.0 (LICENSE-APACHE), at your choice.\n"
        f"The libraries in the program and their licences are in {LICENCES}.\n"
    )
    entries = [
        Entry("usr/bin/cognate", program, PROGRAM),
        Entry(f"{documents}/copyright", copyright_page.encode()),
        Entry(f"{documents}/README.md.gz", zipped(readme())),
        Entry(f"{documents}/changelog.gz", zipped((ROOT / "CHANGELOG.md").read_bytes())),
        *(Entry(f"{documents}/{name}", text) for name, text in licences.items()),
        *examples(f"{documents}/examples"),
    ]
    if pages:
        for entry in files_below(pages, "usr/share"):
            is_manual = entry.path.startswith("usr/share/man/") and entry.data is not None
            entries.append(Entry(f"{entry.path}.gz", zipped(entry.data or b"")) if is_manual else entry)
    control = (
        f"Package: cognate\nVersion: {version}\nArchitecture: {debian}\nSection: math\nPriority: optional\n"
        "Maintainer: The Cognate developers <cognate@localhost>\n" + DESCRIPTION
    )
    return debian_package(control, entries, epoch)


def image(version: str, debian: str, program: bytes, licences: dict[str, bytes], epoch: int) -> bytes:
    """The container image: the program and a user, nothing else."""
    user = f"cognate:x:{CONTAINER_USER}:{CONTAINER_USER}::/home/cognate:/sbin/nologin\n"
    entries = [
        Entry("usr/local/bin/cognate", program, PROGRAM),
        Entry("etc/passwd", ("root:x:0:0::/root:/sbin/nologin\n" + user).encode()),
        Entry("etc/group", f"root:x:0:\ncognate:x:{CONTAINER_USER}:\n".encode()),
        Entry("home/cognate", None, PROGRAM, owner=CONTAINER_USER),
        Entry("tmp", None, SHARED_FOLDER),
        *(Entry(f"usr/share/doc/cognate/{name}", text, FILE) for name, text in licences.items()),
    ]
    settings: dict[str, object] = {
        "User": str(CONTAINER_USER),
        "Env": ["PATH=/usr/local/bin"],
        "Entrypoint": ["cognate"],
        "WorkingDir": "/home/cognate",
        "Labels": {"org.opencontainers.image.licenses": "MIT OR Apache-2.0"},
    }
    return container_image(entries, epoch, debian, f"cognate:{version}", settings)


def wheel(out: Path, program: Path, processor: str, licences: dict[str, bytes]) -> None:
    """The wheel, made of a copy of deploy/python by setuptools of this environment."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "python"
        unwanted = shutil.ignore_patterns("__pycache__", "build", "*.egg-info", "bin")
        shutil.copytree(ROOT / "deploy" / "python", copy, ignore=unwanted)
        for name, text in licences.items():
            (copy / name).write_bytes(text)
        environment = {
            **os.environ,
            "COGNATE_PROGRAM": str(program.resolve()),
            "COGNATE_WHEEL_PLATFORMS": WHEEL_PLATFORMS[processor],
        }
        command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation"]
        command += ["--disable-pip-version-check", "--no-cache-dir", "--wheel-dir", str(out), str(copy)]
        subprocess.run(command, check=True, env=environment)


def sources(version: str) -> bytes:
    """The sources of the revision that is checked out, with which the program can be linked anew."""
    command = ["git", "-C", str(ROOT), "archive", "--format=tar", f"--prefix=cognate-{version}/", "HEAD"]
    return subprocess.run(command, check=True, capture_output=True).stdout


def lgpl_sources(version: str, metadata: dict[str, Any], epoch: int) -> bytes:
    """The sources of what is under the LGPL: GMP, MPFR, MPC and the crates that bind them."""
    top = f"cognate-{version}-lgpl-sources"
    note = (
        "The sources of the libraries in the program `cognate` that are under the LGPL, as they were built: GMP, MPFR\n"
        "and MPC in gmp-mpfr-sys, and the crate rug. To link the program with changed ones, unpack its own sources\n"
        f"(cognate-{version}-source.tar.gz), name the changed crates in its Cargo.toml by [patch.crates-io] with\n"
        "their folders as paths, and call deploy/release.sh.\n"
    )
    entries = [Entry(f"{top}/README", note.encode())]
    for crate in metadata["packages"]:
        if crate["name"] in LGPL_CRATES:
            folder = Path(crate["manifest_path"]).parent
            entries += files_below(folder, f"{top}/{crate['name']}-{crate['version']}")
    return tar(entries, epoch)


def sums(out: Path) -> bytes:
    """Checksums of all files, as `sha256sum --check` reads them."""
    lines = []
    for path in sorted(out.iterdir()):
        if path.is_file() and path.name != "SHA256SUMS":
            lines.append(f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}\n")
    return "".join(lines).encode()


if __name__ == "__main__":
    main()
