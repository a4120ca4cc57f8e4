"""Workspaces: at which points the output of a mechanism can be, and in how many postures."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .errors import InputError
from .positions import _depth, _plain

if TYPE_CHECKING:
    import numpy
    from numpy.typing import NDArray


@dataclass(frozen=True)
class ReachedPoint:
    """What is said of a point.

    `position`: the point. `reachable`: the output can be there, within limits where that was asked; None in doubt.
    `postures`: number of real positions with the output there, whatever the limits; None where they are infinitely
    many, or in doubt. `within_limits`: those within all limits. `reason`: of a doubt.
    """

    position: tuple[float, ...]
    reachable: bool | None
    postures: int | None
    within_limits: int | None
    reason: str | None

    @property
    def infinitely_many(self) -> bool:
        """The postures form a set that moves while the output rests."""
        return self.postures is None and self.reason is None


@dataclass(frozen=True, repr=False)
class Workspace(Sequence[ReachedPoint]):
    """What is said of points: a sequence of `ReachedPoint`, in the order in which points were given.

    `within_limits`: a point counts as reachable only where a posture is within all limits. `settled`: nothing is in
    doubt. `summary`: the program's own answer.
    """

    reached: tuple[ReachedPoint, ...]
    within_limits: bool
    settled: bool
    summary: Mapping[str, Any]

    @classmethod
    def from_json(cls, fields: Mapping[str, Any], points: Sequence[Sequence[float]], within_limits: bool) -> Workspace:
        """An answer as the program writes it, for these points."""
        reached = [
            ReachedPoint(
                position=tuple(position),
                reachable=point["reachable"],
                postures=point["postures"],
                within_limits=point["within_limits"],
                reason=point["reason"],
            )
            for position, point in zip(points, fields["points"], strict=True)
        ]
        return cls(tuple(reached), within_limits, bool(fields["settled"]), fields)

    def __repr__(self) -> str:
        """How many points can be reached."""
        number = sum(1 for point in self.reached if point.reachable)
        return f"<Workspace: {number} of {len(self)} points are reachable{'' if self.settled else ', not settled'}>"

    def __len__(self) -> int:
        """Number of points."""
        return len(self.reached)

    def __getitem__(self, index: Any) -> Any:
        """One point, or some."""
        return self.reached[index]

    def points(self) -> NDArray[numpy.float64]:
        """The points as an array of shape (points, 2) in the plane, (points, 3) in space."""
        import numpy

        return numpy.array([point.position for point in self.reached], dtype=numpy.float64)

    def reachable(self) -> NDArray[numpy.bool_]:
        """Which points can be reached, as an array of shape (points,); False also where that is in doubt."""
        import numpy

        return numpy.array([point.reachable is True for point in self.reached], dtype=numpy.bool_)

    def postures(self) -> NDArray[numpy.float64]:
        """Numbers of postures as an array of shape (points,); inf where they are infinitely many, nan in doubt."""
        import numpy

        def number(point: ReachedPoint) -> float:
            if point.postures is not None:
                return float(point.postures)
            return math.inf if point.infinitely_many else math.nan

        return numpy.array([number(point) for point in self.reached], dtype=numpy.float64)

    def plot(self, axes: Any = None) -> Any:
        """Draws points in the plane, coloured by the number of postures, by matplotlib; gives the axes."""
        from .drawing import plane_axes

        points = self.points()
        if points.shape[1] != 2:
            raise ValueError("expected points in the plane; points in space have no plot")
        axes = plane_axes(axes)
        drawn = axes.scatter(points[:, 0], points[:, 1], c=self.postures(), s=12)
        axes.figure.colorbar(drawn, ax=axes, label="postures")
        return axes


def as_points(points: Any) -> list[list[float]]:
    """Points as the program reads them: rows of two or three numbers; one point alone is a list of one."""
    rows = list(points)
    if rows and _depth(points) == 1 and not isinstance(rows[0], Mapping):
        rows = [rows]
    listed = []
    for i, row in enumerate(rows):
        place = row["position"] if isinstance(row, Mapping) and "position" in row else row
        values = _plain(place)
        if not isinstance(values, list) or not all(isinstance(x, (int, float)) for x in values):
            raise InputError(f"expected the numbers of a point, found {row!r}", field=f"points[{i}]")
        listed.append([float(x) for x in values])
    if not listed:
        raise InputError("expected at least one point", field="points")
    return listed
