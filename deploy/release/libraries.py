"""The libraries in the program: which they are, under what licences, and with what texts.

Crates are those that `cargo metadata` names for the target; what is in C comes with some of them, and the C library
with Rust's target.
"""

from __future__ import annotations

import hashlib
import json
import re
import uuid
from dataclasses import dataclass, field
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

LICENCE_FILES = re.compile(r"(?i)(licen[cs]e|copying|copyright|notice|unlicense)")
"""Names of files with a licence's text, from their beginning."""


@dataclass
class Library:
    """A library in the program; `uses` are keys of others, `texts` its licence's texts by file name."""

    key: str
    name: str
    version: str
    licence: str
    texts: dict[str, str]
    sha256: str | None = None
    uses: list[str] = field(default_factory=list)
    package_url: str | None = None
    folder: Path | None = None


def libraries(root: Path, metadata: dict[str, Any], target: Path, compiler: Path, rust: str) -> list[Library]:
    """All libraries of the program `cognate`, the program itself first.

    `target` is the folder with the libraries of Rust's target, `compiler` that of zig, `rust` the version of Rust.
    """
    packages = {package["id"]: package for package in metadata["packages"]}
    nodes = {node["id"]: node for node in metadata["resolve"]["nodes"]}
    (client,) = (key for key, package in packages.items() if package["name"] == "cognate-client")
    sums = _checksums(root / "Cargo.lock")

    def linked(key: str) -> list[str]:
        """The crates that this crate is linked with: not those of its build or its tests."""
        uses = nodes[key]["deps"]
        return sorted(use["pkg"] for use in uses if any(kind["kind"] is None for kind in use["dep_kinds"]))

    crates: dict[str, Library] = {}
    waiting = [client]
    while waiting:
        key = waiting.pop()
        if key in crates:
            continue
        package = packages[key]
        folder = Path(package["manifest_path"]).parent
        name, version = package["name"], package["version"]
        is_ours = package["source"] is None
        crates[key] = Library(
            key=f"{name}-{version}",
            name=name,
            version=version,
            licence=package["license"].replace("/", " OR "),
            texts=_texts(root if is_ours else folder),
            sha256=sums.get((name, version)),
            uses=[f"{packages[use]['name']}-{packages[use]['version']}" for use in linked(key)],
            package_url=None if is_ours else f"pkg:cargo/{name}@{version}",
            folder=folder,
        )
        waiting += linked(key)
    ordered = sorted((crates[key] for key in crates if key != client), key=lambda crate: (crate.name, crate.version))
    program = crates[client]
    program.uses.append("rust-std")
    in_c: list[Library] = []
    for crate in ordered:
        inside = _in_c(crate)
        crate.uses += [library.key for library in inside]
        in_c += inside
    return [program, *ordered, *in_c, *_of_rust(root, target, compiler, rust)]


def _in_c(crate: Library) -> list[Library]:
    """Libraries in C whose sources come with a crate."""
    assert crate.folder is not None, "crates have folders"
    if crate.name == "gmp-mpfr-sys":
        inside = []
        for name in ("gmp", "mpfr", "mpc"):
            (folder,) = crate.folder.glob(f"{name}-*-c")
            version = folder.name.removeprefix(f"{name}-").removesuffix("-c")
            licence = "LGPL-3.0-or-later OR GPL-2.0-or-later" if name == "gmp" else "LGPL-3.0-or-later"
            inside.append(Library(f"{name}-{version}", name, version, licence, _texts(folder)))
        return inside
    if crate.name == "libsqlite3-sys":
        header = (crate.folder / "sqlite3" / "sqlite3.h").read_text(encoding="utf-8")
        version = re.findall(r'#define SQLITE_VERSION +"([^"]+)"', header)[0]
        text = "SQLite is in the public domain: its authors have dedicated the code to it.\n"
        return [Library(f"sqlite-{version}", "sqlite", version, "blessing", {"sqlite3.h": text})]
    if crate.name == "zstd-sys":
        version = crate.version.split("+zstd.")[1]
        texts = _texts(crate.folder / "zstd")
        return [Library(f"zstd-{version}", "zstd", version, "BSD-3-Clause OR GPL-2.0-only", texts)]
    return []


def _of_rust(root: Path, target: Path, compiler: Path, rust: str) -> list[Library]:
    """The standard library, and the C library and the unwinder that come with it where a program is static."""
    standard = Library("rust-std", "rust-std", rust, "MIT OR Apache-2.0", _texts(root))
    archive = target / "self-contained" / "libc.a"
    if not archive.is_file():
        return [standard]
    version = re.findall(rb"\0(1\.2\.\d+)\0", archive.read_bytes())[0].decode()
    texts = _texts(compiler / "lib" / "libc" / "musl")
    unwinder = _texts(compiler / "lib" / "libunwind")
    standard.uses = ["musl", "libunwind"]
    return [
        standard,
        Library("musl", "musl", version, "MIT", texts),
        Library("libunwind", "libunwind", rust, "Apache-2.0 WITH LLVM-exception", unwinder),
    ]


def _texts(folder: Path) -> dict[str, str]:
    files = sorted(path for path in folder.iterdir() if path.is_file() and LICENCE_FILES.match(path.name))
    return {path.name: path.read_text(encoding="utf-8", errors="replace") for path in files}


def _checksums(lock: Path) -> dict[tuple[str, str], str]:
    """Checksums of crates by name and version."""
    sums = {}
    for block in lock.read_text(encoding="utf-8").split("[[package]]"):
        fields = dict(re.findall(r'^(name|version|checksum) = "([^"]+)"$', block, re.MULTILINE))
        if "checksum" in fields:
            sums[fields["name"], fields["version"]] = fields["checksum"]
    return sums


def licence_texts(ordered: list[Library]) -> str:
    """A page of all libraries and licences, each text once."""
    by_text: dict[str, list[str]] = {}
    others = [library for library in ordered if not library.name.startswith("cognate-")]
    for library in others:
        for name, text in library.texts.items():
            by_text.setdefault(text.strip("\n"), []).append(f"{library.name} {library.version} ({name})")
    lines = [
        "The libraries in the program `cognate`, with their licences; their texts are below, each once. Where a",
        "library brings no text of its own, that of its licence's name is meant. GMP, MPFR, MPC and their bindings are",
        "under the LGPL: their sources, and those of the program, from which it can be linked with other versions of",
        "them, lie beside the archives of the release.",
        "",
    ]
    lines += [f"  {library.name} {library.version}: {library.licence}" for library in others]
    for text, places in sorted(by_text.items(), key=lambda item: item[1]):
        lines += ["", "=" * 100, *places, "-" * 100, text]
    return "\n".join(lines) + "\n"


def bill_of_materials(ordered: list[Library], epoch: int, sha256_of_program: str) -> str:
    """The same as JSON of CycloneDX 1.5."""
    program = ordered[0]
    serial = uuid.UUID(bytes=hashlib.sha256(sha256_of_program.encode()).digest()[:16], version=4)

    def component(library: Library) -> dict[str, Any]:
        described: dict[str, Any] = {
            "type": "library",
            "bom-ref": library.key,
            "name": library.name,
            "version": library.version,
            "licenses": [{"expression": library.licence}],
        }
        if library.package_url:
            described["purl"] = library.package_url
        if library.sha256:
            described["hashes"] = [{"alg": "SHA-256", "content": library.sha256}]
        return described

    main = component(program) | {
        "type": "application",
        "name": "cognate",
        "hashes": [{"alg": "SHA-256", "content": sha256_of_program}],
    }
    bill = {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "serialNumber": f"urn:uuid:{serial}",
        "version": 1,
        "metadata": {
            "timestamp": datetime.fromtimestamp(epoch, timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ"),
            "component": main,
        },
        "components": [component(library) for library in ordered[1:]],
        "dependencies": [{"ref": library.key, "dependsOn": sorted(set(library.uses))} for library in ordered],
    }
    return json.dumps(bill, indent=1) + "\n"
