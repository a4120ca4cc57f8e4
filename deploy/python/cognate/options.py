"""Options of a solve, and the program's arguments for them."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict, TypeGuard, Union

from . import command_line, exact, expressions
from .errors import InputError
from .program import Folder
from .result import Result
from .solution import Solution

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    Array = ArrayLike
else:
    Array = Any

Parameters = Union[Mapping[Any, Any], Sequence[Any], "Array"]
"""Values of parameters: by name, or in the order of the system's parameters."""


class Options(TypedDict, total=False):
    """The options of `solve` and `submit`. The options of the command line have the same names.

    `start`: `auto`, `total-degree`, `multihomogeneous`, `linear-product`, `polyhedral`, `regeneration`,
    `monodromy` or `given`; or a `Result`: paths then begin at its solutions and parameters.
    `start_solutions`: start points: solutions, arrays of shape (n, variables) in the order of the variables,
    mappings by name, or a file. `start_parameters`: the parameters of the start points.
    `targets`: the target parameters, by name or in order; a list or an array of shape (n, parameters) for many;
    a mapping from names to arrays of length n; or a file.
    `groups`: lists of variables for this solve. `sets`: sets of variables for `linear-product`.
    `conjugates`, `degenerate`, `symmetry`: as for a `System`.
    `seed`: the same seed gives the same bits. `preset`: `careful`, `default`, `fast`, `reckless`.
    `precision`: `adaptive`, `double` or a number of bits.
    `idle_loops`, `confidence`, `expect`, `trace_test`: stop criteria for the loops of `monodromy`.
    `certify`: prove the solutions. `digits`: decimal digits of the solutions. `deflate`: also of singular solutions.
    `where`: a condition in unknowns and parameters, such as `"x > 0 and y < 2*x"` or a relation of sympy, or several
    that hold together;
    `real`, `positive`: only solutions that are real, or real with all unknowns greater than 0. These options select
    the listed solutions; the counts are still of all solutions. `sort`: an expression whose values order the solutions.
    `minimize`, `maximize`, `critical`: an expression for one of these. The solutions are then its critical points on
    the solutions of the equations at which the conditions hold, each with `objective` and `kind`. `Result.critical` has
    the least or the largest value, and the reason. These are options of `solve`.
    `exact`: long decimals are exact, not rounded. `no_exact_count`: only the paths decide, without the count of the
    solutions by elimination over a prime field. `approximate`: the real points of least residual where more equations
    than unknowns have no common solution, in `Result.summary`.
    """

    start: str | Result
    start_solutions: object
    start_parameters: Parameters | str | os.PathLike[str]
    targets: object
    groups: Iterable[Any] | str
    sets: Any
    conjugates: Iterable[Sequence[Any]] | str
    degenerate: Any
    symmetry: Any
    seed: int
    preset: str
    precision: str | int
    idle_loops: int
    confidence: float
    expect: int
    trace_test: bool
    where: object
    real: bool
    positive: bool
    sort: str
    minimize: str
    maximize: str
    critical: str
    certify: bool
    digits: int
    deflate: bool
    exact: bool
    no_exact_count: bool
    approximate: bool


OBJECTIVES = ("minimize", "maximize", "critical")
"""The options for an objective, which needs no equations."""

ELSEWHERE = {
    "target_parameters": "the parameters wanted are targets=",
    "start_system": 'expected start=, such as start="polyhedral"',
    "variable_groups": "expected groups=",
    "vars": 'the variables are named by cognate.System(equations, "x y")',
    "variables": 'the variables are named by cognate.System(equations, "x y")',
    "unknowns": 'the variables are named by cognate.System(equations, "x y")',
    "parameters": 'cognate.System(equations, "x y", parameters="p q") names parameters; their values are targets=',
    "tasks": "expected workers= and threads=",
    "threading": "expected workers= and threads=",
    "show_progress": "expected progress=True or False",
    "verbose": "expected progress=True or False",
    "x0": "no starting point is needed, since all solutions are found; near one of them: sort=",
    "tol": "solutions have the accuracy of doubles; expected digits= for more, certify=True for proofs",
    "certificates": "expected certify=True",
}
"""Option names of phcpy, HomotopyContinuation.jl and scipy, with a hint to our name."""


class _Names:
    """Names of variables and parameters. They are read only if values are given without names."""

    def __init__(self, names: Callable[[], tuple[tuple[str, ...], tuple[str, ...]]]) -> None:
        self._names = names

    @property
    def variables(self) -> tuple[str, ...]:
        return self._names()[0]

    @property
    def parameters(self) -> tuple[str, ...]:
        return self._names()[1]


def arguments(
    options: Options, folder: Folder, names: Callable[[], tuple[tuple[str, ...], tuple[str, ...]]]
) -> tuple[list[str], dict[str, str | None]]:
    """The program's arguments, and the files written for them, each with the user's name for it.

    `names`: returns the variables and the parameters of the problem.
    """
    for name in options:
        if name in ELSEWHERE:
            raise TypeError(f"unknown option {name!r}; {ELSEWHERE[name]}")
        if name not in Options.__annotations__:
            raise TypeError(f"unknown option {name!r}; expected one of {', '.join(Options.__annotations__)}")
    found: list[str] = []
    own: dict[str, str | None] = {}

    def file(option: str, content: str, called: str) -> None:
        path = folder.write(called, content)
        own[str(path)] = called
        found.extend(command_line.option_words(**{option: path}))

    known = _Names(names)
    start = options.get("start")
    solutions, begin = options.get("start_solutions"), options.get("start_parameters")
    if isinstance(start, Result):
        if solutions is not None or begin is not None:
            raise InputError("a result to start from has its own solutions and parameters", field="start")
        solutions, begin, start = start.solutions, start.parameters, None
        if not begin:
            raise InputError(
                "expected a result of monodromy, which has parameters; with start_solutions give start_parameters",
                field="start",
            )
    if start is not None:
        found += command_line.option_words(start=str(start))
    if solutions is not None:
        given = _path(solutions)
        if given is not None:
            found += command_line.option_words(start_solutions=given)
        else:
            file("start-solutions", _points(solutions, known), "start_solutions")
    for option, values in (("start-parameters", begin), ("target-parameters", options.get("targets"))):
        if values is None:
            continue
        given = _path(values)
        called = "targets" if option == "target-parameters" else "start_parameters"
        if given is not None:
            found += command_line.option_words(**{option: given})
        elif called == "targets":
            file(option, json.dumps(_targets(values, known)), called)
        else:
            file(option, json.dumps(_values(values, known, called)), called)
    groups = options.get("groups")
    if groups is not None:
        if not isinstance(groups, str):
            lists = (expressions.name_list(g, f"groups[{i}]") for i, g in enumerate(groups))
            groups = ";".join(",".join(g) for g in lists)
        found += command_line.option_words(groups=groups)
    conjugates = options.get("conjugates")
    if conjugates is not None:
        if not isinstance(conjugates, str):
            pairs = (expressions.name_list(p, f"conjugates[{i}]") for i, p in enumerate(conjugates))
            conjugates = ",".join("~".join(p) for p in pairs)
        found += command_line.option_words(conjugates=conjugates)
    for name, content in (
        ("sets", options.get("sets")),
        ("degenerate", options.get("degenerate")),
        ("symmetry", options.get("symmetry")),
    ):
        if content is None:
            continue
        given = _path(content)
        if given is not None:
            found += command_line.option_words(**{name: given})
        else:
            file(name, json.dumps(content), name)
    where = options.get("where")
    conditions = [] if where is None else expressions.listed(where, "where")
    values = (
        *("seed", "preset", "precision", "idle_loops", "confidence", "expect", "digits"),
        *("sort", *OBJECTIVES),
    )
    flags = ("certify", "deflate", "exact", "no_exact_count", "approximate", "trace_test", "real", "positive")
    found += command_line.option_words(
        where=[expressions.condition(each, "where") for each in conditions],
        **{name: options.get(name) for name in values},
        **{name: bool(options.get(name)) for name in flags},
    )
    return found, own


def _path(value: object) -> str | None:
    """The path of a file, or None for other values."""
    return os.fspath(value) if isinstance(value, (str, Path, os.PathLike)) else None


def _pair(value: object, field: str) -> list[float]:
    number = exact.double(value, field)
    return [number.real, number.imag]


def _values(values: object, names: _Names, field: str) -> dict[str, list[float]]:
    """One set of parameters, by name."""
    if isinstance(values, Mapping):
        return {expressions.name(key, field): _pair(value, f"{field}.{key}") for key, value in values.items()}
    return _in_order(values, names.parameters, field)


def _in_order(values: object, names: tuple[str, ...], field: str) -> dict[str, list[float]]:
    listed = list(values) if isinstance(values, Iterable) and not isinstance(values, str) else [values]
    if len(listed) != len(names):
        raise InputError(f"expected {len(names)} values ({', '.join(names)}), found {len(listed)}", field=field)
    return {name: _pair(value, f"{field}.{name}") for name, value in zip(names, listed, strict=True)}


def _is_list(value: object) -> TypeGuard[Iterable[Any]]:
    return isinstance(value, Iterable) and not isinstance(value, (str, Mapping)) and getattr(value, "ndim", 1) > 0


def _targets(values: object, names: _Names) -> list[dict[str, list[float]]]:
    """One or many sets of parameters."""
    if isinstance(values, Mapping):
        columns = {key: list(column) for key, column in values.items() if _is_list(column)}
        if not columns:
            return [_values(values, names, "targets")]
        lengths = {len(column) for column in columns.values()}
        if len(lengths) > 1:
            raise InputError(f"expected arrays of one length, found {sorted(lengths)}", field="targets")
        return [
            _values(
                {key: columns[key][i] if key in columns else value for key, value in values.items()},
                names,
                f"targets[{i}]",
            )
            for i in range(lengths.pop())
        ]
    if not _is_list(values):
        return [_in_order(values, names.parameters, "targets")]
    rows = list(values)
    if rows and not any(isinstance(row, Mapping) or _is_list(row) for row in rows):
        return [_in_order(rows, names.parameters, "targets")]
    found = [_values(row, names, f"targets[{i}]") for i, row in enumerate(rows)]
    if not found:
        raise InputError("expected at least one set of parameters", field="targets")
    return found


def _points(solutions: object, names: _Names) -> str:
    """Start points as lines of our solutions.jsonl, without singular and undecided points."""
    if not _is_list(solutions):
        raise InputError(f"expected a list or an array of points, found {solutions!r}", field="start_solutions")
    lines = []
    for i, point in enumerate(solutions):
        field = f"start_solutions[{i}]"
        if isinstance(point, Solution):
            if point.singular or point.undecided:
                raise InputError("a singular solution is no start of a path", field=field)
            values = {name: [z.real, z.imag] for name, z in zip(point.names, point.coordinates, strict=True)}
        elif isinstance(point, Mapping):
            values = {expressions.name(key, field): _pair(value, f"{field}.{key}") for key, value in point.items()}
        else:
            values = _in_order(point, names.variables, field)
        lines.append(json.dumps({"variables": values}))
    if not lines:
        raise InputError("expected at least one point", field="start_solutions")
    return "\n".join(lines) + "\n"
