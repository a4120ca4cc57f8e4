"""Solution: one isolated point, its properties, and its certificate."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import Any

from . import exact
from .errors import CognateError


@dataclass(frozen=True)
class Box:
    """One exact coordinate of a certificate: a square around `re` + i `im` of half width `radius`.

    `error`: bound on the distance of the solution from the middle.
    """

    variable: str
    re: Fraction
    im: Fraction
    radius: Fraction
    error: Fraction


@dataclass(frozen=True)
class Certificate:
    """A proof that a box contains exactly one solution (Krawczyk's test), or the reason for no proof.

    `distinct`: the box meets no other box. `real`: the solution is proved to be real; None if this was not tested.
    `contraction`: the norm that the test proves to be below 1. `precision_bits`: bits of its interval arithmetic.
    """

    certified: bool
    reason: str | None
    distinct: bool | None
    real: bool | None
    precision_bits: int
    contraction: float | None
    coordinates: tuple[Box, ...]

    @classmethod
    def from_json(cls, found: Mapping[str, Any]) -> Certificate:
        """A certificate from a line of `solutions.jsonl`."""
        return cls(
            certified=bool(found["certified"]),
            reason=found.get("reason"),
            distinct=found.get("distinct"),
            real=found.get("real"),
            precision_bits=int(found["precision_bits"]),
            contraction=found.get("contraction"),
            coordinates=tuple(
                Box(
                    variable=str(c["variable"]),
                    re=exact.dyadic(c["re"]),
                    im=exact.dyadic(c["im"]),
                    radius=exact.dyadic(c["radius"]),
                    error=exact.dyadic(c["error"]),
                )
                for c in found.get("coordinates") or ()
            ),
        )


@dataclass(frozen=True)
class Solution(Mapping[str, complex]):
    """One isolated solution: a mapping from the names of the variables to complex numbers.

    `digits`: real and imaginary parts as decimal text if they have more digits than doubles, else None.
    `real`: None if not decided. `multiplicity` and `cycles` (winding numbers) describe singular points.
    `residual`, `condition` and `accuracy` are relative, for the point in doubles; `precision_bits` is of its path.
    `symmetry_class`: the number of its class under the symmetry group. `paths`: the paths that end here.
    `undecided`: a finite singular point that may or may not be isolated. `objective` and `kind`
    (`minimum`, `maximum`, `saddle`, `degenerate`) are for critical points. `on_border`: the conditions hold with
    equality within the accuracy; None without conditions, and where it is not known whether they hold.
    """

    names: tuple[str, ...]
    coordinates: tuple[complex, ...]
    digits: tuple[tuple[str, str], ...] | None
    real: bool | None
    singular: bool
    undecided: bool
    multiplicity: int | None
    cycles: tuple[int, ...]
    residual: float | None
    condition: float | None
    accuracy: float | None
    precision_bits: int
    symmetry_class: int | None
    paths: tuple[int, ...]
    certificate: Certificate | None
    deflations: int | None
    objective: float | None = None
    kind: str | None = None
    on_border: bool | None = None

    def __getitem__(self, name: str) -> complex:
        try:
            return self.coordinates[self.names.index(name)]
        except ValueError:
            raise KeyError(name) from None

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)

    def decimal(self, name: str) -> tuple[Decimal, Decimal]:
        """Real and imaginary part with every known digit; for a double, the digits that identify it."""
        if name not in self.names:
            raise KeyError(name)
        at = self.names.index(name)
        if self.digits is not None:
            re, im = self.digits[at]
            return Decimal(re), Decimal(im)
        z = self.coordinates[at]
        return Decimal(repr(z.real)), Decimal(repr(z.imag))

    @classmethod
    def from_json(cls, line: Mapping[str, Any]) -> Solution:
        """A solution from a line of `solutions.jsonl`."""
        variables: Mapping[str, Any] = line["variables"]
        long = any(isinstance(part, str) for pair in variables.values() for part in pair)
        certificate = line.get("certificate")
        return cls(
            names=tuple(variables),
            coordinates=tuple(complex(float(re), float(im)) for re, im in variables.values()),
            digits=tuple((str(re), str(im)) for re, im in variables.values()) if long else None,
            real=line["real"],
            singular=bool(line["singular"]),
            undecided=bool(line.get("undecided", False)),
            multiplicity=line["multiplicity"],
            cycles=tuple(line.get("cycles") or ()),
            residual=line["residual"],
            condition=line["condition"],
            accuracy=line["accuracy"],
            precision_bits=int(line["precision_bits"]),
            symmetry_class=line.get("class"),
            paths=tuple(line["paths"]),
            certificate=None if certificate is None else Certificate.from_json(certificate),
            deflations=line.get("deflations"),
            objective=line.get("objective"),
            kind=line.get("kind"),
            on_border=line.get("on_border"),
        )


def points(solutions: list[Solution] | tuple[Solution, ...]) -> list[tuple[complex, ...]]:
    """The coordinates of the solutions, without their properties."""
    return [solution.coordinates for solution in solutions]


def check_names(solutions: tuple[Solution, ...]) -> tuple[str, ...]:
    """The names of the variables, which all solutions of one answer share."""
    if not solutions:
        return ()
    names = solutions[0].names
    if any(solution.names != names for solution in solutions):
        raise CognateError("the solutions of one answer have other variables than one another")
    return names
