"""Archives with the same bytes whenever they are made of the same files: sorted, owned by root, with one time."""

from __future__ import annotations

import gzip
import hashlib
import io
import json
import lzma
import tarfile
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path, PurePosixPath

PROGRAM, FILE, SHARED_FOLDER = 0o755, 0o644, 0o1777
"""Modes: of programs and folders, of other files, of a folder in which everybody may write."""


@dataclass(frozen=True)
class Entry:
    """A file of an archive, or an empty folder where there are no bytes; `path` has no leading slash."""

    path: str
    data: bytes | None
    mode: int = FILE
    owner: int = 0


def files_below(folder: Path, to: str) -> list[Entry]:
    """All files of a folder, to stand below `to` in an archive; what may be run may be run there."""
    entries = []
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            mode = PROGRAM if path.stat().st_mode & 0o100 else FILE
            entries.append(Entry(f"{to}/{path.relative_to(folder).as_posix()}", path.read_bytes(), mode))
    return entries


def tar(entries: Iterable[Entry], epoch: int, prefix: str = "") -> bytes:
    """A tar archive with the folders that the entries need; `prefix` (`./` in Debian packages) precedes every path."""
    by_path = {entry.path: entry for entry in entries}
    for path in list(by_path):
        for folder in PurePosixPath(path).parents:
            if str(folder) != ".":
                by_path.setdefault(str(folder), Entry(str(folder), None, PROGRAM))
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w", format=tarfile.GNU_FORMAT) as archive:
        for path in sorted(by_path):
            entry = by_path[path]
            info = tarfile.TarInfo(prefix + path)
            info.mtime, info.mode = epoch, entry.mode
            info.uid = info.gid = entry.owner
            if not entry.owner:
                info.uname = info.gname = "root"
            if entry.data is None:
                info.type = tarfile.DIRTYPE
                archive.addfile(info)
            else:
                info.size = len(entry.data)
                archive.addfile(info, io.BytesIO(entry.data))
    return buffer.getvalue()


def zipped(data: bytes) -> bytes:
    """Compressed by gzip, without name and time; level 9 takes twice as long for half a percent."""
    return gzip.compress(data, compresslevel=6, mtime=0)


def debian_package(control: str, entries: list[Entry], epoch: int) -> bytes:
    """A Debian package: an `ar` archive of three members; `control` lacks only the installed size."""
    sums = "".join(
        f"{hashlib.md5(entry.data, usedforsecurity=False).hexdigest()}  {entry.path}\n"
        for entry in sorted(entries, key=lambda entry: entry.path)
        if entry.data is not None
    )
    kibibytes = sum(-(-len(entry.data) // 1024) for entry in entries if entry.data is not None)
    control += f"Installed-Size: {kibibytes}\n"
    description = [Entry("control", control.encode()), Entry("md5sums", sums.encode())]
    members = {
        "debian-binary": b"2.0\n",
        "control.tar.xz": lzma.compress(tar(description, epoch, "./")),
        "data.tar.xz": lzma.compress(tar(entries, epoch, "./")),
    }
    package = b"!<arch>\n"
    for name, data in members.items():
        package += f"{name:<16}{epoch:<12}{0:<6}{0:<6}{'100644':<8}{len(data):<10}`\n".encode() + data
        package += b"\n" * (len(data) % 2)
    return package


def container_image(
    entries: list[Entry], epoch: int, architecture: str, name: str, settings: dict[str, object]
) -> bytes:
    """An image of one layer as a tar archive: an OCI layout, with the manifest that older loaders read beside it."""
    created = _time(epoch)
    layer = tar(entries, epoch)
    packed = zipped(layer)
    blobs: dict[str, bytes] = {}

    def blob(kind: str, data: bytes) -> dict[str, object]:
        digest = hashlib.sha256(data).hexdigest()
        blobs[digest] = data
        return {"mediaType": f"application/vnd.oci.image.{kind}", "digest": f"sha256:{digest}", "size": len(data)}

    described_layer = blob("layer.v1.tar+gzip", packed)
    configuration = {
        "architecture": architecture,
        "os": "linux",
        "created": created,
        "config": settings,
        "rootfs": {"type": "layers", "diff_ids": [f"sha256:{hashlib.sha256(layer).hexdigest()}"]},
        "history": [{"created": created, "created_by": "deploy/release.sh"}],
    }
    described_configuration = blob("config.v1+json", _json(configuration))
    manifest = {
        "schemaVersion": 2,
        "mediaType": "application/vnd.oci.image.manifest.v1+json",
        "config": described_configuration,
        "layers": [described_layer],
    }
    described_manifest = blob("manifest.v1+json", _json(manifest))
    described_manifest["annotations"] = {"org.opencontainers.image.ref.name": name}
    index = {"schemaVersion": 2, "manifests": [described_manifest]}

    def place(described: dict[str, object]) -> str:
        return "blobs/" + str(described["digest"]).replace(":", "/")

    loaders = [{"Config": place(described_configuration), "RepoTags": [name], "Layers": [place(described_layer)]}]
    members = [Entry(f"blobs/sha256/{digest}", data) for digest, data in blobs.items()]
    members += [
        Entry("oci-layout", _json({"imageLayoutVersion": "1.0.0"})),
        Entry("index.json", _json(index)),
        Entry("manifest.json", _json(loaders)),
    ]
    return tar(members, epoch)


def _json(value: object) -> bytes:
    return (json.dumps(value, indent=1, sort_keys=True) + "\n").encode()


def _time(epoch: int) -> str:
    return datetime.fromtimestamp(epoch, timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
