"""Answers about components: images, degrees by groups, freedoms at points, real points, proofs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Image:
    """The closure of a component's image in some of the variables.

    `id`: id of the component. `dimension`, `degree`: numbers of the image. `fiber_dimension`: dimension of the fiber
    over a general point of the image. `fiber_degree`: its degree, or its number of points. `same_image`: id of an
    earlier component with the same image. A number is None if it is not known; `doubts` give the reasons.
    """

    id: str
    dimension: int | None
    degree: int | None
    fiber_dimension: int | None
    fiber_degree: int | None
    same_image: str | None
    doubts: tuple[str, ...]

    @classmethod
    def from_json(cls, fields: Mapping[str, Any]) -> Image:
        """An image as the program writes it."""
        return cls(
            id=str(fields["id"]),
            dimension=fields["dimension"],
            degree=fields["degree"],
            fiber_dimension=fields["fiber_dimension"],
            fiber_degree=fields["fiber_degree"],
            same_image=fields["same_image"],
            doubts=tuple(fields["doubts"]),
        )


@dataclass(frozen=True)
class Multidegree:
    """Degrees of a component by groups of variables.

    `id`: id of the component. `groups`: the variables of each group. `degrees`: maps numbers of general hyperplanes
    in each group to the number of common points; None if it is not known.
    """

    id: str
    groups: tuple[tuple[str, ...], ...]
    degrees: Mapping[tuple[int, ...], int | None]
    doubts: tuple[str, ...]

    @classmethod
    def from_json(cls, fields: Mapping[str, Any], groups: Sequence[Sequence[str]]) -> Multidegree:
        """Degrees as the program writes them."""
        return cls(
            id=str(fields["id"]),
            groups=tuple(tuple(group) for group in groups),
            degrees={tuple(each["slices"]): each["degree"] for each in fields["multidegree"]},
            doubts=tuple(fields["doubts"]),
        )


@dataclass(frozen=True)
class PointMobility:
    """Number of directions in which a point can move along the solutions.

    `infinitesimal`: directions in which a motion can begin. `local`: dimension of the solutions around the point. None:
    in doubt. `dimensions_by_order`: lengths of the local ring modulo the powers of its maximal ideal. `on`: ids of
    the components that contain the point. `reason`: text. `index`: position of the point in the list.
    """

    index: int
    infinitesimal: int | None
    local: int | None
    dimensions_by_order: tuple[int, ...]
    on: tuple[str, ...]
    reason: str

    @classmethod
    def from_json(cls, fields: Mapping[str, Any]) -> PointMobility:
        """Freedoms as the program writes them."""
        return cls(
            index=int(fields["index"]),
            infinitesimal=fields["infinitesimal"],
            local=fields["local_dimension"],
            dimensions_by_order=tuple(int(length) for length in fields["dimensions_by_order"]),
            on=tuple(str(id) for id in fields["on"]),
            reason=str(fields["reason"]),
        )


@dataclass(frozen=True, repr=False)
class RealPoints:
    """At least one point on every connected part of the real points of components.

    `points`: points by component id, coordinates in the order of `variables`. `has_real_points`: by id; None in doubt.
    """

    variables: tuple[str, ...]
    points: Mapping[str, tuple[tuple[float, ...], ...]]
    has_real_points: Mapping[str, bool | None]
    settled: bool
    summary: Mapping[str, Any]

    @classmethod
    def from_json(cls, variables: tuple[str, ...], fields: Mapping[str, Any]) -> RealPoints:
        """Points as the program writes them."""
        points: dict[str, list[tuple[float, ...]]] = {str(each["id"]): [] for each in fields["components"]}
        for each in fields["points"]:
            points[str(each["component"])].append(tuple(float(re) for re, _ in each["point"]))
        return cls(
            variables=variables,
            points={id: tuple(listed) for id, listed in points.items()},
            has_real_points={str(each["id"]): each["has_real_points"] for each in fields["components"]},
            settled=bool(fields["settled"]),
            summary=fields,
        )

    def __repr__(self) -> str:
        """The number of points of each component."""
        shown = ", ".join(f"{len(listed)} of {id}" for id, listed in self.points.items())
        return f"<RealPoints: {shown}{'' if self.settled else ', not settled'}>"

    def array(self, component: str | None = None) -> NDArray[numpy.float64]:
        """The points of one component, or of all, as an array of shape (points, variables)."""
        import numpy

        chosen = self.points.values() if component is None else [self.points[component]]
        rows = [point for listed in chosen for point in listed]
        return numpy.array(rows, dtype=numpy.float64).reshape(len(rows), len(self.variables))


@dataclass(frozen=True)
class Proofs:
    """Numbers of witness points of a component, and of proved ones.

    `id`: id of the component. `points`: number of witness points. `certified`: number of witness points with a proof
    of existence. `distinct`: the proofs show that they are different.
    """

    id: str
    points: int
    certified: int
    distinct: bool

    @classmethod
    def from_json(cls, fields: Mapping[str, Any]) -> Proofs:
        """Numbers as the program writes them."""
        return cls(str(fields["id"]), int(fields["points"]), int(fields["certified"]), bool(fields["distinct"]))
