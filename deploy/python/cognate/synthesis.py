"""Synthesis: every four-bar linkage for a given task."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import program
from .command_line import option_words
from .components import _place
from .errors import CognateWarning, InputError, in_the_users_words, not_settled, warn
from .progress import Bar, Wanted

if TYPE_CHECKING:
    from .service import Service

Numbers = Sequence[Sequence[float]]
"""Rows of numbers: lists, or an array."""


@dataclass(frozen=True)
class Linkage:
    """One four-bar linkage.

    `pivots`: the two points on the ground; `joints`: the two moving joints at the first position; `coupler_point`.
    `grade`: how well it fits the task, such as `one-circuit`. `kind`: its type by Grashof. `data`: all fields
    that the program writes for it.
    """

    name: str
    pivots: tuple[complex, complex]
    joints: tuple[complex, complex]
    coupler_point: complex
    grade: str
    kind: str
    data: Mapping[str, Any]


@dataclass(frozen=True, repr=False)
class Synthesis(Sequence[Linkage]):
    """All real linkages, the best first: a sequence of `Linkage`.

    `settled`: all paths are accounted for. `summary`: the program's own answer.
    """

    linkages: tuple[Linkage, ...]
    settled: bool
    summary: Mapping[str, Any]

    def __repr__(self) -> str:
        """The number of linkages."""
        return f"<Synthesis: {len(self.linkages)} linkages{'' if self.settled else ', not settled'}>"

    def __len__(self) -> int:
        """Number of linkages."""
        return len(self.linkages)

    def __getitem__(self, index: Any) -> Any:
        """One linkage, or a slice."""
        return self.linkages[index]


KINDS = {
    "nine-point": ("x,y", 2),
    "body-guidance": ("x,y,angle", 3),
    "body-guidance-timing": ("x,y,angle,crank", 4),
    "path-timing": ("x,y,angle", 3),
    "function-generation": ("input,output", 2),
    "poses-and-points": ("x,y,angle", 3),
}
"""Each kind of task, with the columns of its rows."""


def synthesize(
    kind: str,
    rows: Numbers | str | os.PathLike[str],
    *,
    pivots: Numbers = (),
    certify: bool = False,
    seed: int | None = None,
    preset: str | None = None,
    precision: str | int | None = None,
    service: Service | None = None,
    workers: int | None = None,
    threads: int | None = None,
    progress: Wanted = None,
    strict: bool = False,
    output: str | os.PathLike[str] | None = None,
) -> Synthesis:
    """Every four-bar linkage for a task. Angles are in degrees.

    `kind` and `rows`: `nine-point` with nine points x, y of its coupler curve; `body-guidance` with five poses x, y,
    angle; `body-guidance-timing` with three poses x, y, angle and the crank's angle at each, and `pivots` of driven
    links; `path-timing` with five points and the crank's angle at each; `function-generation` with five pairs of
    angles of crank and follower; `poses-and-points` with 2, 3 or 4 poses and 6, 4 or 2 points; a point has angle None.
    `rows` may be a file, as for the command. `output`: a folder for drawings, tables and a page.

    >>> import cognate as cg
    >>> poses = [(0, 0, 0), (1, 0.5, 20), (2, 0.6, 40), (3, 0.2, 65), (3.5, -0.5, 90)]
    >>> found = cg.synthesize("body-guidance", poses, workers=1)
    >>> found.settled, found.summary["solutions"]["distinct"]
    (True, 4)
    """
    if kind not in KINDS:
        raise InputError(f"expected one of {', '.join(KINDS)}, found {kind!r}", field="kind")
    arguments = ["synthesize", kind, *option_words(format="json"), *_place(service, workers, threads)]
    arguments += option_words(seed=seed, preset=preset, precision=precision, certify=bool(certify), output=output)
    arguments += [f"--pivot={float(x)!r},{float(y)!r}" for x, y in pivots]
    with program.Folder() as folder, Bar(progress) as bar:
        own: program.Own = {}
        if isinstance(rows, (str, os.PathLike)):
            file = Path(rows)
        else:
            file = folder.write("rows.csv", _table(kind, rows))
            own[str(file)] = "rows"
        if bar.watcher is not None:
            arguments += option_words(progress="json")
        finished = program.run([*arguments, "--", str(file)], own=own, watcher=bar.watcher)
    summary = json.loads(finished.output)
    warnings = [in_the_users_words(w, own) for w in summary.get("warnings") or []]
    listed = summary.get("linkages")
    if listed is None:
        # Nine points: three cognate linkages draw each curve.
        listed = [linkage for curve in summary.get("curves") or [] for linkage in curve["linkages"]]
    found = Synthesis(tuple(_linkage(linkage) for linkage in listed), bool(summary["settled"]), summary)
    for warning in warnings:
        warn(warning, CognateWarning)
    if not found.settled:
        not_settled("not settled: some linkages may be missing", found, strict)
    return found


@dataclass(frozen=True)
class SpatialDyad:
    """One chain of two or three joints in space.

    `fixed`: the joint on the ground, its vectors by name: `point`, and `direction` or `normal` for an axis or a plane.
    `moving`: the joint on the body, where it is in the first pose. `distance` and `angle_degrees` of both, None where
    the chain has none. `certified`: proved to be there, alone, and to be real.
    """

    fixed: Mapping[str, tuple[float, ...]]
    moving: Mapping[str, tuple[float, ...]]
    distance: float | None
    angle_degrees: float | None
    certified: bool


@dataclass(frozen=True, repr=False)
class SpatialSynthesis(Sequence[SpatialDyad]):
    """All real chains of one kind: a sequence of `SpatialDyad`.

    `linkages`: spherical four-bar linkages of two chains of hinges, as the program writes them. `settled`: all paths
    are accounted for. `summary`: the program's own answer.
    """

    dyads: tuple[SpatialDyad, ...]
    linkages: tuple[Mapping[str, Any], ...]
    settled: bool
    summary: Mapping[str, Any]

    def __repr__(self) -> str:
        """The number of chains."""
        return f"<SpatialSynthesis: {len(self.dyads)} chains{'' if self.settled else ', not settled'}>"

    def __len__(self) -> int:
        """Number of chains."""
        return len(self.dyads)

    def __getitem__(self, index: Any) -> Any:
        """One chain, or a slice."""
        return self.dyads[index]


def synthesize_spatial(
    chain: str,
    poses: Any,
    *,
    certify: bool = False,
    seed: int | None = None,
    preset: str | None = None,
    precision: str | int | None = None,
    service: Service | None = None,
    workers: int | None = None,
    threads: int | None = None,
    strict: bool = False,
    output: str | os.PathLike[str] | None = None,
) -> SpatialSynthesis:
    """Every chain of two or three joints that takes a body in space through given poses.

    `chain`: `SS` with seven poses, `PPS` with six, `CC` or `spherical-RR` with five, `CS` with eight, `RPS` with ten;
    the first joint is on the ground.
    `poses`: rows x, y, z, qw, qx, qy, qz, or x, y, z, roll, pitch, yaw in degrees, or matrices of shape (4, 4); or a
    file, as for the command.

    >>> import cognate as cg
    >>> turns = [(0, 0, 0), (20, 0, 5), (40, 10, 0), (60, -10, 15), (80, 0, 40)]
    >>> found = cg.synthesize_spatial("spherical-RR", [(0, 0, 0, *turn) for turn in turns])
    >>> found.settled, found.summary["paths"]["finite"]
    (True, 6)
    """
    arguments = ["synthesize", "spatial-dyads", *option_words(chain=chain, format="json")]
    arguments += _place(service, workers, threads)
    arguments += option_words(seed=seed, preset=preset, precision=precision, certify=bool(certify), output=output)
    with program.Folder() as folder:
        own: program.Own = {}
        if isinstance(poses, (str, os.PathLike)):
            file = Path(poses)
        else:
            file = folder.write("poses.csv", "".join(_numbers(pose) + "\n" for pose in poses))
            own[str(file)] = "poses"
        finished = program.run([*arguments, "--", str(file)], own=own)
    summary = json.loads(finished.output)
    dyads = tuple(
        SpatialDyad(
            fixed={name: tuple(vector) for name, vector in dyad["fixed"].items()},
            moving={name: tuple(vector) for name, vector in dyad["moving"].items()},
            distance=dyad["distance"],
            angle_degrees=dyad["angle_degrees"],
            certified=bool(dyad["certified"]),
        )
        for dyad in summary["dyads"]
    )
    found = SpatialSynthesis(dyads, tuple(summary["linkages"]), bool(summary["settled"]), summary)
    for warning in summary.get("warnings") or []:
        warn(in_the_users_words(warning, own), CognateWarning)
    if not found.settled:
        not_settled("not settled: some chains may be missing", found, strict)
    return found


def _numbers(pose: Any) -> str:
    """A pose on one line: its numbers, a matrix by rows."""
    flat = [x for row in pose for x in (row if hasattr(row, "__iter__") else (row,))]
    return " ".join(repr(float(x)) for x in flat)


def _table(kind: str, rows: Numbers) -> str:
    """Rows as a table."""
    header, width = KINDS[kind]
    lines = [header]
    for i, row in enumerate(rows):
        cells = list(row)
        if kind == "poses-and-points" and len(cells) == 2:
            cells.append(None)  # type: ignore[arg-type]
        if len(cells) != width:
            raise InputError(f"expected {width} numbers ({header}), found {len(cells)}", field=f"rows[{i}]")
        lines.append(",".join("" if cell is None else repr(float(cell)) for cell in cells))
    return "\n".join(lines) + "\n"


def _linkage(found: Mapping[str, Any]) -> Linkage:
    def points(name: str) -> tuple[complex, complex]:
        first, second = (complex(x, y) for x, y in found[name])
        return first, second

    return Linkage(
        name=str(found["name"]),
        pivots=points("pivots"),
        joints=points("joints"),
        coupler_point=complex(*found["coupler_point"]),
        grade=str(found.get("grade")),
        kind=str(found.get("type")),
        data=found,
    )
