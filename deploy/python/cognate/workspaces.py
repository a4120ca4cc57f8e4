"""Workspaces: points that the output can reach, their numbers of postures, and the boundary."""

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
    """The answer for one point.

    `position`: the point. `reachable`: the output can be there, within limits if requested; None in doubt.
    `postures`: number of real positions with the output there, regardless of limits; None if infinitely many
    or in doubt. `within_limits`: number of postures within all limits. `reason`: reason of a doubt.
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


@dataclass(frozen=True)
class BoundaryCurve:
    """A circle that can bound the reachable points.

    `cause`: "singularity" or "limit". `of`: names of the joints or legs at their limits; None for a singularity.
    `center`, `radius`: center and radius of the circle. `on_boundary`: an arc of it is on the boundary; None in doubt.
    `samples`: points of the arcs on the boundary; points of the whole circle if no arc is.
    """

    cause: str
    of: str | None
    center: tuple[float, float]
    radius: float
    on_boundary: bool | None
    samples: tuple[tuple[float, float], ...]

    @classmethod
    def from_json(cls, fields: Mapping[str, Any]) -> BoundaryCurve:
        """A curve as the program writes it."""
        x, y = fields["circle"]["center"]
        return cls(
            cause=fields["from"],
            of=fields["of"],
            center=(x, y),
            radius=fields["circle"]["radius"],
            on_boundary=fields["on_boundary"],
            samples=tuple((x, y) for x, y in fields["samples"]),
        )

    def array(self) -> NDArray[numpy.float64]:
        """The samples as an array of shape (samples, 2)."""
        import numpy

        return numpy.array(self.samples, dtype=numpy.float64)


@dataclass(frozen=True, repr=False)
class Workspace(Sequence[ReachedPoint]):
    """Answers for points: a sequence of `ReachedPoint`, in the order of the given points.

    `within_limits`: a point counts as reachable only if a posture is within all limits. `settled`: nothing is in
    doubt. `boundary`: all circles that can bound the reachable points; None with a `boundary_reason` if the boundary
    does not consist of circles. `area`: area of the reachable points; None with an `area_reason`. `max_postures`: the
    largest number of postures of a point, regardless of limits; None with a `max_postures_reason`. `summary`: the
    program's own answer.
    """

    reached: tuple[ReachedPoint, ...]
    within_limits: bool
    settled: bool
    boundary: tuple[BoundaryCurve, ...] | None
    boundary_reason: str | None
    area: float | None
    area_reason: str | None
    max_postures: int | None
    max_postures_reason: str | None
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
        curves = fields["boundary"]
        return cls(
            reached=tuple(reached),
            within_limits=within_limits,
            settled=bool(fields["settled"]),
            boundary=None if curves is None else tuple(BoundaryCurve.from_json(curve) for curve in curves),
            boundary_reason=fields["boundary_reason"],
            area=fields["area"],
            area_reason=fields["area_reason"],
            max_postures=fields["max_postures"],
            max_postures_reason=fields["max_postures_reason"],
            summary=fields,
        )

    def __repr__(self) -> str:
        """Number of reachable points; the area if no points were given."""
        number = sum(1 for point in self.reached if point.reachable)
        area = "no area" if self.area is None else f"area {self.area:.6g}"
        answer = f"{number} of {len(self)} points are reachable" if self.reached else area
        return f"<Workspace: {answer}{'' if self.settled else ', not settled'}>"

    def __len__(self) -> int:
        """Number of points."""
        return len(self.reached)

    def __getitem__(self, index: Any) -> Any:
        """One point, or a slice."""
        return self.reached[index]

    def points(self) -> NDArray[numpy.float64]:
        """The points as an array of shape (points, 2) in the plane, (points, 3) in space."""
        import numpy

        return numpy.array([point.position for point in self.reached], dtype=numpy.float64)

    def reachable(self) -> NDArray[numpy.bool_]:
        """An array of shape (points,): True for reachable points, False for others and in doubt."""
        import numpy

        return numpy.array([point.reachable is True for point in self.reached], dtype=numpy.bool_)

    def postures(self) -> NDArray[numpy.float64]:
        """Numbers of postures as an array of shape (points,); inf for infinitely many, nan in doubt."""
        import numpy

        def number(point: ReachedPoint) -> float:
            if point.postures is not None:
                return float(point.postures)
            return math.inf if point.infinitely_many else math.nan

        return numpy.array([number(point) for point in self.reached], dtype=numpy.float64)

    def plot(self, axes: Any = None) -> Any:
        """Draws points in the plane, coloured by the number of postures, and their boundary, by matplotlib."""
        from .drawing import plane_axes

        points = self.points()
        if self.reached and points.shape[1] != 2:
            raise ValueError("expected points in the plane; points in space have no plot")
        axes = plane_axes(axes)
        for curve in self.boundary or ():
            if curve.on_boundary:
                samples = curve.array()
                axes.plot(samples[:, 0], samples[:, 1], ".", markersize=2, color="0.3")
        if not self.reached:
            return axes
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
