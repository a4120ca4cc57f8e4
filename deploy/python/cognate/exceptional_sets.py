"""Exceptional members of families: mechanisms with more freedoms than in general, solutions of a higher dimension."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from . import program
from .command_line import option_words
from .components import _place
from .errors import not_settled
from .motions import counted
from .progress import Bar, Wanted
from .system import problem_file

if TYPE_CHECKING:
    from .service import Service


@dataclass(frozen=True)
class MovingValues:
    """Values of a mechanism's open numbers for which it has more freedoms than in general.

    `dimension`: dimension of the set of values. `mobility`: freedoms at a general point of the set. `values`: the
    values by name, for dimension 0; `exact`: their short fractions or roots, None for others. `degree`: degree of a set
    of higher dimension, None if not known. `equations`: expressions that are 0 on a line.
    """

    dimension: int
    mobility: int
    values: tuple[Mapping[str, float], ...]
    exact: tuple[Mapping[str, str | None], ...]
    degree: int | None
    equations: tuple[str, ...]


@dataclass(frozen=True, repr=False)
class ExceptionalMechanisms(Sequence[MovingValues]):
    """Values of its open numbers for which a mechanism moves more than in general: a sequence of `MovingValues`.

    `free`: names of the numbers that the file leaves open. `generic`: freedoms for general values, -1 if the mechanism
    cannot be assembled for them. `sets`: the largest dimension first. `not_real`: single values that are not real; they
    are in no set. `settled`: nothing is in doubt; `open_questions`: a sentence for each doubt. `summary`: the program's
    own answer.
    """

    free: tuple[str, ...]
    generic: int
    sets: tuple[MovingValues, ...]
    not_real: int
    settled: bool
    open_questions: tuple[str, ...]
    summary: Mapping[str, Any]

    @classmethod
    def from_json(cls, fields: Mapping[str, Any]) -> ExceptionalMechanisms:
        """An answer as the program writes it."""
        sets = [
            MovingValues(
                dimension=int(each["dimension"]),
                mobility=int(each["mobility"]),
                values=tuple({name: float(x) for name, x in point.items()} for point in each.get("values") or ()),
                exact=tuple(dict(point) for point in each.get("exact") or ()),
                degree=each.get("degree"),
                equations=tuple(str(text) for text in each.get("equations") or ()),
            )
            for each in fields["sets"]
        ]
        return cls(
            free=tuple(fields["free"]),
            generic=int(fields["generic"]["mobility"]),
            sets=tuple(sets),
            not_real=int(fields["not_real"]),
            settled=bool(fields["settled"]),
            open_questions=tuple(str(doubt) for doubt in fields["warnings"]),
            summary=fields,
        )

    def __repr__(self) -> str:
        """The numbers of freedoms."""
        shown = ", ".join(f"mobility {each.mobility} over dimension {each.dimension}" for each in self.sets)
        doubt = "" if self.settled else ", not settled"
        return f"<ExceptionalMechanisms: {shown or 'none'}; {self.generic} in general{doubt}>"

    def __len__(self) -> int:
        """Number of sets."""
        return len(self.sets)

    def __getitem__(self, index: Any) -> Any:
        """One set, or some."""
        return self.sets[index]


@dataclass(frozen=True)
class ExceptionalSet:
    """Parameters over which the solutions have a higher dimension.

    `dimension`, `codimension`, `degree`: numbers of the closure of the set of parameters; `degree` None if not known.
    `fibre_dimension`: dimension of the solutions over a general point of the set. `components`: components of the last
    product whose image is the set. `point`: a general point of the set, by the parameters' names.
    """

    dimension: int
    codimension: int
    degree: int | None
    fibre_dimension: int
    components: tuple[str, ...]
    point: Mapping[str, complex]


@dataclass(frozen=True, repr=False)
class ExceptionalSets(Sequence[ExceptionalSet]):
    """Sets of parameters whose solutions have at least the requested dimension: a sequence of `ExceptionalSet`.

    `fibre_dimension`: the requested dimension. `parameters`: their names. `products`: the decomposed fibre products,
    with one or more copies of the variables. `settled`: nothing is in doubt; `open_questions`: a sentence for each
    doubt. `summary`: the program's own answer.
    """

    fibre_dimension: int
    parameters: tuple[str, ...]
    sets: tuple[ExceptionalSet, ...]
    products: tuple[Mapping[str, Any], ...]
    settled: bool
    open_questions: tuple[str, ...]
    summary: Mapping[str, Any]

    @classmethod
    def from_json(cls, fields: Mapping[str, Any]) -> ExceptionalSets:
        """An answer as the program writes it."""
        answer = fields["exceptional"]
        sets = [
            ExceptionalSet(
                dimension=int(each["dimension"]),
                codimension=int(each["codimension"]),
                degree=each["degree"],
                fibre_dimension=int(each["fibre_dimension"]),
                components=tuple(each["components"]),
                point={name: complex(re, im) for name, (re, im) in each["point"].items()},
            )
            for each in answer["sets"]
        ]
        return cls(
            fibre_dimension=int(answer["fibre_dimension"]),
            parameters=tuple(answer["parameters"]),
            sets=tuple(sets),
            products=tuple(answer["products"]),
            settled=bool(fields["settled"]),
            open_questions=tuple(str(doubt) for doubt in fields["unsettled"]),
            summary=fields,
        )

    def __repr__(self) -> str:
        """The number of sets."""
        doubt = "" if self.settled else ", not settled"
        return f"<ExceptionalSets: {counted(len(self), 'set')} for dimension {self.fibre_dimension}{doubt}>"

    def __len__(self) -> int:
        """Number of sets."""
        return len(self.sets)

    def __getitem__(self, index: Any) -> Any:
        """One set, or some."""
        return self.sets[index]


def exceptional(
    family: object,
    fibre_dimension: int,
    *,
    copies: int = 1,
    seed: int | None = None,
    preset: str | None = None,
    service: Service | None = None,
    workers: int | None = None,
    threads: int | None = None,
    progress: Wanted = None,
    strict: bool = False,
    output: str | os.PathLike[str] | None = None,
) -> ExceptionalSets:
    """Values of a family's parameters over which its solutions have a higher dimension, by fibre products.

    `family`: a system with parameters, as for `solve`. `fibre_dimension`: least dimension of the wanted solutions.
    `copies`: copies of the variables in the first product; more are taken until no set can be missing. `output`: a
    folder for the components of each product. For mechanisms see `Mechanism.exceptional`.

    Warns with `UnsettledWarning` if a claim is not settled; `strict` raises `Unsettled` instead.

    >>> import cognate as cg
    >>> lines = cg.System(["a*x + b*y", "c*x + d*y"], "x y", parameters="a b c d")
    >>> found = cg.exceptional(lines, 1, workers=1)
    >>> found[0].dimension, found[0].degree, found.settled          # the determinant: a*d = b*c
    (3, 2, True)
    >>> [(each.dimension, each.degree) for each in cg.exceptional(lines, 2, workers=1)]
    [(0, 1)]
    """
    arguments = ["exceptional", *option_words(format="json", fibre_dimension=fibre_dimension, copies=copies)]
    arguments += _place(service, workers, threads)
    arguments += option_words(seed=seed, preset=preset, output=output)
    with program.Folder() as folder, Bar(progress) as bar:
        file = problem_file(family, folder)
        if bar.watcher is not None:
            arguments += option_words(progress="json")
        finished = program.run([*arguments, "--", str(file.path)], own=file.own, watcher=bar.watcher)
    exceptional_sets = ExceptionalSets.from_json(json.loads(finished.output))
    if not exceptional_sets.settled:
        not_settled("not settled: " + "; ".join(exceptional_sets.open_questions), exceptional_sets, strict)
    return exceptional_sets
