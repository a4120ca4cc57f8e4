"""PHCpack's lists of solutions, as `phc -b` writes them below a system, and as it reads them."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field

from ..errors import InputError
from ..solution import Solution

LINE = "=" * 75
"""Above and below the solutions of a list."""


@dataclass(frozen=True)
class PhcSolution:
    """A solution as PHCpack has it: `t` of the homotopy, multiplicity, and three numbers of its last step.

    `err`: length of the last correction; `rco`: inverse of the condition number; `res`: residual.
    """

    names: tuple[str, ...]
    coordinates: tuple[complex, ...]
    t: complex = 0j
    multiplicity: int = 1
    err: float = 0.0
    rco: float = 1.0
    res: float = 0.0
    # Of the banner of its list: `regular` and the like, which nothing is computed from.
    remark: str = field(default="", compare=False)

    @classmethod
    def of(cls, solution: Solution) -> PhcSolution:
        """One of our solutions; what is not known has PHCpack's values for it."""
        return cls(
            names=solution.names,
            coordinates=solution.coordinates,
            t=1 + 0j,
            multiplicity=solution.multiplicity or 1,
            err=solution.accuracy or 0.0,
            rco=1 / solution.condition if solution.condition else 0.0,
            res=solution.residual or 0.0,
        )


_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_T = re.compile(rf"t :\s+({_NUMBER})\s+({_NUMBER})")
_M = re.compile(r"m :\s+(\d{1,12})(?!\d)")
_VALUE = re.compile(rf"(\S+) :\s+({_NUMBER})\s+({_NUMBER})")
_END = re.compile(rf"== err :\s+({_NUMBER}) = rco :\s+({_NUMBER}) = res :\s+({_NUMBER}) =(.*)")


def read_solutions(text: str, *, file: str | None = None) -> list[PhcSolution]:
    """The solutions of a text: those below its last `THE SOLUTIONS`, or all where there is no such line.

    Raises `InputError` where there are fewer than the list says.
    """
    lines = text.splitlines()
    titles = [i for i, line in enumerate(lines) if line.strip().startswith("THE SOLUTIONS")]
    begin = titles[-1] + 1 if titles else 0
    expected = _expected(lines, begin) if titles else None
    found: list[PhcSolution] = []
    number = begin
    while number < len(lines):
        if _T.match(lines[number].strip()):
            solution, number = _one(lines, number, file)
            found.append(solution)
        else:
            number += 1
    if expected is not None and expected != len(found):
        raise InputError(f"expected {expected} solutions, found {len(found)}", file=file, line=begin + 1)
    return found


def read_solution(text: str) -> PhcSolution:
    """One solution, as phcpy has it in a string."""
    lines = text.splitlines()
    begin = next((i for i, line in enumerate(lines) if _T.match(line.strip())), None)
    if begin is None:
        raise InputError(f"expected a line `t : RE IM`, found {text[:40]!r}")
    return _one(lines, begin, None)[0]


def write_solution(solution: PhcSolution) -> str:
    """One solution, as phcpy has it in a string."""
    lines = [
        f"t :  {_double(solution.t)}",
        f"m : {solution.multiplicity}",
        "the solution for t :",
        *(f" {name} :  {_double(z)}" for name, z in zip(solution.names, solution.coordinates, strict=True)),
        f"== err :  {solution.err:.3E} = rco :  {solution.rco:.3E} = res :  {solution.res:.3E} =",
    ]
    return "\n".join(lines)


def write_solutions(solutions: Iterable[PhcSolution | Solution]) -> str:
    """A list of solutions below `THE SOLUTIONS`, which is also what `cognate solve --start-solutions` reads."""
    listed = [PhcSolution.of(s) if isinstance(s, Solution) else s for s in solutions]
    size = len(listed[0].names) if listed else 0
    parts = ["THE SOLUTIONS :", f"{len(listed)} {size}", LINE]
    for number, solution in enumerate(listed, 1):
        parts += [f"solution {number} :", f"{write_solution(solution)}="]
    return "\n".join([*parts, LINE]) + "\n"


def _expected(lines: list[str], begin: int) -> int | None:
    """The number of solutions, which stands below the title."""
    words = next((line.split() for line in lines[begin:] if line.strip()), [])
    return int(words[0]) if words and re.fullmatch(r"\d{1,12}", words[0]) else None


def _one(lines: list[str], begin: int, file: str | None) -> tuple[PhcSolution, int]:
    """The solution that begins at a line, and the line after it."""

    def wrong(expected: str, at: int) -> InputError:
        found = lines[at].strip() if at < len(lines) else "the end"
        return InputError(f"expected {expected}, found {found[:60]!r}", file=file, line=at + 1)

    t = _T.match(lines[begin].strip())
    assert t is not None, "the caller has seen it"
    m = _M.match(lines[begin + 1].strip()) if begin + 1 < len(lines) else None
    if m is None:
        raise wrong("a line `m : NUMBER`", begin + 1)
    at = begin + 2
    if at >= len(lines) or not lines[at].strip().startswith("the solution for t"):
        raise wrong("the line `the solution for t :`", at)
    at += 1
    names: list[str] = []
    values: list[complex] = []
    while at < len(lines) and (value := _VALUE.fullmatch(lines[at].strip())):
        names.append(value[1])
        values.append(complex(float(value[2]), float(value[3])))
        at += 1
    end = _END.match(lines[at].strip()) if at < len(lines) else None
    if end is None or not names:
        raise wrong("a line `NAME : RE IM` or `== err : ...`", at)
    solution = PhcSolution(
        names=tuple(names),
        coordinates=tuple(values),
        t=complex(float(t[1]), float(t[2])),
        multiplicity=int(m[1]),
        err=float(end[1]),
        rco=float(end[2]),
        res=float(end[3]),
        remark=end[4].strip("= "),
    )
    return solution, at + 1


def _double(z: complex) -> str:
    # 17 digits: every bit of a double.
    return f"{z.real: .16E}  {z.imag: .16E}"
