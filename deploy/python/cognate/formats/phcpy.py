"""phcpy's objects: polynomials as strings, solutions as strings or dictionaries."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from ..errors import InputError
from ..solution import Solution
from .phcpack import PhcSolution, read_solution, write_solution

OTHER_KEYS = ("t", "m", "err", "rco", "res")
"""Keys of a dictionary that are no variables."""


def polynomials(text: str) -> list[str]:
    """The list of polynomials from the text of a file of PHCpack."""
    _, _, body = text.partition("\n")
    return [part.strip() + ";" for part in body.split(";") if part.strip()]


def file_text(polynomials: Iterable[str]) -> str:
    """A file of PHCpack from a list of polynomials, in as many unknowns as it has polynomials or otherwise.

    >>> print(file_text(["x^2 + y^2 - 1;", "x*y - 1/3;"]), end="")
    2 2
    x^2 + y^2 - 1;
    x*y - 1/3;
    """
    from .. import expressions

    listed = [p.strip() for p in polynomials]
    for i, polynomial in enumerate(listed):
        if not polynomial.endswith(";") or polynomial.count(";") != 1:
            raise InputError(f"expected one polynomial that ends with ;, found {polynomial[:60]!r}", field=f"[{i}]")
    names = {name for p in listed for name in expressions.names(p) if name != "i"}
    return f"{len(listed)} {len(names)}\n" + "".join(f"{p}\n" for p in listed)


def dictionary(solution: Solution | PhcSolution | str) -> dict[str, Any]:
    """A solution as `phcpy.solutions.strsol2dict` gives it: variables, and `t`, `m`, `err`, `rco`, `res`."""
    if isinstance(solution, str):
        solution = read_solution(solution)
    elif isinstance(solution, Solution):
        solution = PhcSolution.of(solution)
    for name in solution.names:
        if name in OTHER_KEYS:
            raise InputError(f"the variable {name} has the name of another entry of the dictionary", field=name)
    found: dict[str, Any] = dict(zip(solution.names, solution.coordinates, strict=True))
    found.update(t=solution.t, m=solution.multiplicity, err=solution.err, rco=solution.rco, res=solution.res)
    return found


def from_dictionary(found: Mapping[str, Any]) -> PhcSolution:
    """A solution from such a dictionary.

    >>> from_dictionary({"x": 1 + 2j, "m": 1, "t": 0j, "err": 0.0, "rco": 1.0, "res": 0.0}).coordinates
    ((1+2j),)
    """
    names = tuple(name for name in found if name not in OTHER_KEYS)
    if not names:
        raise InputError("expected at least one variable")
    return PhcSolution(
        names=names,
        coordinates=tuple(complex(found[name]) for name in names),
        t=complex(found.get("t", 0)),
        multiplicity=int(found.get("m", 1)),
        err=float(found.get("err", 0.0)),
        rco=float(found.get("rco", 1.0)),
        res=float(found.get("res", 0.0)),
    )


def string(solution: Solution | PhcSolution) -> str:
    """A solution as a string of phcpy."""
    return write_solution(PhcSolution.of(solution) if isinstance(solution, Solution) else solution)


def from_string(text: str) -> PhcSolution:
    """A solution from a string of phcpy."""
    return read_solution(text)
