"""Approximate synthesis: four-bar linkages with the least error for many points, poses or pairs of angles."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from . import program
from .command_line import option_words
from .errors import InputError, not_settled
from .motions import counted
from .synthesis import Numbers

TASKS = {
    "path": ("points", "x,y", 2),
    "body-guidance": ("poses", "x,y,angle", 3),
    "function-generation": ("pairs", "crank,rocker", 2),
}
"""For each kind of task: the option of the program, the columns of the rows, and the number of columns."""

# The program reads only the type of the linkage from this file; it ignores the numbers.
_FOUR_BAR = {
    "space": "planar",
    "links": ["ground", "crank", "coupler", "rocker"],
    "joints": [
        {"name": "A0", "type": "R", "links": ["ground", "crank"], "point": [0, 0]},
        {"name": "A", "type": "R", "links": ["crank", "coupler"], "point": [0, 1]},
        {"name": "B", "type": "R", "links": ["coupler", "rocker"], "point": [3, 2]},
        {"name": "B0", "type": "R", "links": ["rocker", "ground"], "point": [4, 0]},
    ],
}


@dataclass(frozen=True)
class PathLinkage:
    """A four-bar linkage whose coupler curve passes near points.

    `pivots`: the two points on the ground; `joints` and `coupler_point`: the moving points, in one position.
    `error`: sum of squared distances from the points to the curve. `kind`: "minimum".
    """

    pivots: tuple[complex, complex]
    joints: tuple[complex, complex]
    coupler_point: complex
    error: float
    kind: str


@dataclass(frozen=True)
class Dyad:
    """A link between the ground and a body that passes near poses.

    `pivot`: its point on the ground. `moving`: its point on the body, in the body's coordinates. `length`: its length.
    `error`: sum of (distance^2 - length^2)^2 over the poses. `kind`: "minimum", "maximum",
    "saddle" or "degenerate".
    """

    pivot: complex
    moving: complex
    length: float
    error: float
    kind: str


@dataclass(frozen=True)
class FunctionGenerator:
    """A four-bar linkage with a ground of length 1 that nearly meets the given pairs of angles.

    `crank`, `coupler`, `rocker`: lengths; a negative link is turned by half a turn. `crank_offset`, `rocker_offset`:
    degrees to add to the given angles. `error`: sum of squared residuals of Freudenstein's equation. `kind`:
    "minimum", "maximum", "saddle" or "degenerate".
    """

    crank: float
    coupler: float
    rocker: float
    crank_offset: float
    rocker_offset: float
    error: float
    kind: str


@dataclass(frozen=True, repr=False)
class Approximation(Sequence[Any]):
    """Linkages with small error, minima first, then by their error: a sequence.

    The items are `PathLinkage`, `Dyad` or `FunctionGenerator`. `objective`: the error, `distance`, `dyad` or
    `freudenstein`. `method`: `stationary` (all stationary points of the error were found, none is missing) or `refined`
    (local minima from random linkages; a better one may exist). `stationary`: number of stationary points, complex and
    real, else None. `settled`: nothing is in doubt. `summary`: the program's own answer.
    """

    linkages: tuple[Any, ...]
    objective: str
    method: str
    stationary: tuple[int, int] | None
    settled: bool
    open_questions: tuple[str, ...]
    summary: Mapping[str, Any]

    def __repr__(self) -> str:
        """The number of linkages, and the least error."""
        best = f", least error {self[0].error:.6g}" if self.linkages else ""
        noun = "dyad" if self.objective == "dyad" else "linkage"
        doubt = "" if self.settled else ", not settled"
        return f"<Approximation: {counted(len(self), noun)}{best}, {self.method}{doubt}>"

    def __len__(self) -> int:
        """Number of linkages."""
        return len(self.linkages)

    def __getitem__(self, index: Any) -> Any:
        """One linkage, or a slice."""
        return self.linkages[index]

    @property
    def minima(self) -> list[Any]:
        """The linkages that are minima of the error."""
        return [linkage for linkage in self.linkages if linkage.kind == "minimum"]


def synthesize_approximately(
    kind: str,
    rows: Numbers,
    *,
    starts: int | None = None,
    seed: int | None = None,
    threads: int | None = None,
    strict: bool = False,
) -> Approximation:
    """Four-bar linkages for more points, poses or pairs than a linkage can meet exactly. Angles are in degrees.

    `kind` and `rows`: `path` with ten or more points x, y of the coupler curve; `body-guidance` with six or more poses
    x, y, angle: dyads, and any two dyads make a linkage; `function-generation` with six or more pairs of angles of
    crank and rocker. For poses and pairs, all stationary points of the error are found. For points, local minima are
    found from `starts` random linkages. For fewer rows see `synthesize`.

    >>> import cognate as cg
    >>> poses = [(0, 0, 0), (1, 0.5, 20), (2, 0.6, 40), (3, 0.2, 65), (3.5, -0.5, 90), (3.8, -1.1, 105)]
    >>> found = cg.synthesize_approximately("body-guidance", poses)
    >>> found.method, found.settled, found[0].kind, found[0].error <= found.minima[-1].error
    ('stationary', True, 'minimum', True)
    """
    if kind not in TASKS:
        raise InputError(f"expected one of {', '.join(TASKS)}, found {kind!r}", field="kind")
    option, header, width = TASKS[kind]
    lines = [header]
    for i, row in enumerate(rows):
        if len(row) != width:
            raise InputError(f"expected {width} numbers ({header}), found {len(row)}", field=f"rows[{i}]")
        lines.append(",".join(repr(float(cell)) for cell in row))
    arguments = ["mechanism", "synthesize", *option_words(approximate=True, format="json", angles="deg")]
    arguments += option_words(starts=starts, seed=seed, threads=threads)
    with program.Folder() as folder:
        file = folder.write("four_bar.json", json.dumps(_FOUR_BAR))
        table = folder.write("rows.csv", "\n".join(lines) + "\n")
        written: program.Own = {str(file): None, str(table): "rows"}
        finished = program.run([*arguments, *option_words(**{option: table}), "--", str(file)], own=written)
    approximation = _read(json.loads(finished.output))
    if not approximation.settled:
        not_settled("not settled: " + "; ".join(approximation.open_questions), approximation, strict)
    return approximation


def _read(fields: Mapping[str, Any]) -> Approximation:
    read = {"distance": _path_linkage, "dyad": _dyad, "freudenstein": _function_generator}[fields["objective"]]
    listed = fields["dyads"] if fields["objective"] == "dyad" else fields["linkages"]
    stationary = fields["stationary"]
    return Approximation(
        linkages=tuple(read(each) for each in listed),
        objective=str(fields["objective"]),
        method=str(fields["method"]),
        stationary=None if stationary is None else (int(stationary["complex"]), int(stationary["real"])),
        settled=bool(fields["settled"]),
        open_questions=tuple(str(doubt) for doubt in fields["warnings"]),
        summary=fields,
    )


def _path_linkage(fields: Mapping[str, Any]) -> PathLinkage:
    point = {name: complex(*fields[name]) for name in ("A0", "A", "B", "B0", "P")}
    return PathLinkage(
        pivots=(point["A0"], point["B0"]),
        joints=(point["A"], point["B"]),
        coupler_point=point["P"],
        error=float(fields["error"]),
        kind=str(fields["kind"]),
    )


def _dyad(fields: Mapping[str, Any]) -> Dyad:
    return Dyad(
        pivot=complex(*fields["pivot"]),
        moving=complex(*fields["moving"]),
        length=float(fields["length"]),
        error=float(fields["error"]),
        kind=str(fields["kind"]),
    )


def _function_generator(fields: Mapping[str, Any]) -> FunctionGenerator:
    return FunctionGenerator(
        crank=float(fields["crank"]),
        coupler=float(fields["coupler"]),
        rocker=float(fields["rocker"]),
        crank_offset=math.degrees(fields["crank_offset"]),
        rocker_offset=math.degrees(fields["rocker_offset"]),
        error=float(fields["error"]),
        kind=str(fields["kind"]),
    )
