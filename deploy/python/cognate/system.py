"""System: equations in variables and parameters, with their known structure."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from . import expressions, program
from .command_line import option_words
from .errors import TEXT, InputError

FIELDS = (
    "variables",
    "groups",
    "homogeneous",
    "parameters",
    "path_variable",
    "definitions",
    "equations",
    "conjugates",
    "degenerate",
    "symmetry",
)
"""The fields of a problem in our JSON."""


_KINDS: dict[str, Any] = {
    "groups": (list, tuple),
    "homogeneous": (bool, list, tuple),
    "definitions": Mapping,
    "conjugates": (list, tuple),
    "degenerate": Mapping,
    "symmetry": (list, tuple),
}
"""Types of the fields of a problem that are neither names nor expressions."""


@dataclass(frozen=True, init=False)
class System:
    """A system of polynomial equations.

    `equations`: strings in the notation of Bertini or Python (`x^2` or `x**2`, `x = y` for x - y), expressions or
    equations of sympy, polynomials, or numbers. Exact numbers stay exact; a decimal of up to seven significant
    digits is exact too, a longer one counts as rounded.
    `variables`: names or symbols, in the order of the answer; by default those of the equations, in the order of
    their first occurrence.
    `parameters`: names or symbols for numbers that are given later.
    `groups`: lists of variables for a multihomogeneous start; each may be `homogeneous`.
    `definitions`: names for subexpressions.
    `conjugates`: pairs of variables that are each other's complex conjugates at a real solution.
    `degenerate`, `symmetry`: as in our JSON (see the README of the coordinator).

    >>> import cognate as cg
    >>> circle = cg.System(["x^2 + y^2 - 4", "x*y = 1/3"])
    >>> circle.variables, circle.equations
    (('x', 'y'), ('x^2 + y^2 - 4', '(x*y)-(1/3)'))
    """

    equations: tuple[str, ...]
    variables: tuple[str, ...]
    parameters: tuple[str, ...] = ()
    groups: tuple[tuple[str, ...], ...] | None = None
    homogeneous: bool | tuple[bool, ...] = False
    definitions: Mapping[str, str] = field(default_factory=dict)
    conjugates: tuple[tuple[str, str], ...] = ()
    degenerate: Mapping[str, Any] = field(default_factory=dict)
    symmetry: tuple[Any, ...] = ()
    path_variable: str | None = None

    def __init__(
        self,
        equations: object,
        variables: object = None,
        *,
        parameters: object = (),
        groups: Iterable[object] | None = None,
        homogeneous: bool | Sequence[bool] = False,
        definitions: Mapping[Any, Any] | None = None,
        conjugates: Iterable[Sequence[object]] = (),
        degenerate: Mapping[str, Any] | None = None,
        symmetry: Iterable[Any] = (),
        path_variable: object = None,
    ) -> None:
        given = expressions.equation_list(equations, "equations")
        texts = tuple(expressions.equation(e, f"equations[{i}]") for i, e in enumerate(given))
        # A generator can be read only once. "x, y" is split later.
        if variables is not None and not isinstance(variables, str):
            variables = expressions.listed(variables, "variables")
        if not isinstance(parameters, str):
            parameters = expressions.listed(parameters, "parameters")
        defined = [part for pair in (definitions or {}).items() for part in pair]
        expressions.check_symbols([*given, *defined, *(variables or ()), *parameters])
        if not texts:
            raise InputError("expected at least one equation", field="equations")
        named = {
            expressions.name(key, "definitions"): expressions.expression(value, f"definitions.{key}")
            for key, value in (definitions or {}).items()
        }
        known = expressions.name_list(parameters, "parameters")
        put = object.__setattr__
        put(self, "equations", texts)
        put(self, "definitions", named)
        put(self, "parameters", known)
        put(
            self,
            "variables",
            _occurring(texts, named, known) if variables is None else expressions.name_list(variables, "variables"),
        )
        put(
            self,
            "groups",
            None if groups is None else tuple(expressions.name_list(g, f"groups[{i}]") for i, g in enumerate(groups)),
        )
        put(self, "homogeneous", homogeneous if isinstance(homogeneous, bool) else tuple(homogeneous))
        put(self, "conjugates", tuple(_pair(p, i) for i, p in enumerate(conjugates)))
        put(self, "degenerate", dict(degenerate or {}))
        put(self, "symmetry", tuple(symmetry))
        put(
            self,
            "path_variable",
            None if path_variable is None else expressions.name(path_variable, "path_variable"),
        )

    @classmethod
    def from_json(cls, problem: str | Mapping[str, Any]) -> System:
        """A system from our JSON: its text, or the object that `json.loads` returns."""
        if isinstance(problem, str):
            try:
                problem = json.loads(problem)
            except json.JSONDecodeError as e:
                raise InputError(e.msg, line=e.lineno, column=e.colno) from e
            except (ValueError, RecursionError) as e:
                raise InputError(f"expected a JSON object with a problem: {e}") from e
        if not isinstance(problem, Mapping):
            raise InputError(f"expected a JSON object with a problem, found {problem!r}")
        for name in problem:
            if name not in FIELDS:
                raise InputError(f"expected one of the fields {', '.join(FIELDS)}", field=str(name))
        for name, kind in _KINDS.items():
            if name in problem and not isinstance(problem[name], kind):
                what = "an object" if kind is Mapping else "a list"
                raise InputError(f"expected {what}, found {problem[name]!r}", field=name)
        if "equations" not in problem:
            raise InputError("expected the field equations")
        return cls(**problem)

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> System:
        """A system from a file: Bertini-classic input, PHCpack's format or our JSON. The content shows the format."""
        found = program.run(["convert", *option_words(to="json"), "--", os.fspath(path)])
        return cls.from_json(program.issue_warnings(found).output)

    @classmethod
    def from_text(cls, text: str) -> System:
        """A system from the text of a file that `read` accepts."""
        with program.Folder() as folder:
            path = folder.write("problem", text)
            command = ["convert", *option_words(to="json"), "--", str(path)]
            found = program.run(command, own={str(path): TEXT})
        return cls.from_json(program.issue_warnings(found).output)

    def to_json(self) -> str:
        """The system as our JSON."""
        groups = self.groups
        homogeneous = self.homogeneous
        problem: dict[str, Any] = {"variables": self.variables, "equations": self.equations}
        optional = {
            "groups": groups,
            "homogeneous": homogeneous,
            "parameters": self.parameters,
            "path_variable": self.path_variable,
            "definitions": dict(self.definitions),
            "conjugates": self.conjugates,
            "degenerate": dict(self.degenerate),
            "symmetry": self.symmetry,
        }
        problem.update({name: value for name, value in optional.items() if value})
        return json.dumps(problem, indent=1, ensure_ascii=False) + "\n"

    def to_bertini(self) -> str:
        """The system as Bertini input."""
        return self._converted("bertini")

    def to_phcpack(self) -> str:
        """The system in PHCpack's format, which has no parameters."""
        return self._converted("phcpack")

    def to_sympy(self) -> list[Any]:
        """The equations as exact expressions of sympy that must be 0, with the definitions inserted.

        >>> import cognate as cg
        >>> cg.System(["0.1*x^2 = r", "x*y - 1/3"], "x y", definitions={"r": "y + 1"}).to_sympy()
        [x**2/10 - y - 1, x*y - 1/3]
        """
        import sympy

        names = [*self.variables, *self.parameters, *([self.path_variable] if self.path_variable else [])]
        symbols: dict[str, Any] = {name: sympy.Symbol(name) for name in names}
        rest = dict(self.definitions)
        while rest:
            ready = [name for name, text in rest.items() if not set(expressions.names(text)) & set(rest)]
            if not ready:
                raise InputError("expected definitions that do not need each other", field=f"definitions.{min(rest)}")
            for name in ready:
                symbols[name] = expressions.to_sympy(rest.pop(name), symbols, f"definitions.{name}")
        return [expressions.to_sympy(text, symbols, f"equations[{i}]") for i, text in enumerate(self.equations)]

    def to_phcpy(self) -> list[str]:
        """The polynomials in phcpy's form: strings that end with a semicolon.

        >>> import cognate as cg
        >>> cg.System(["x^2 - 1/3*y", "y - 1"]).to_phcpy()
        ['x - x + y - y + x^2 - (1/3)*y;', 'y - 1;']
        """
        from .formats import phcpy

        return phcpy.polynomials(self.to_phcpack())

    def to_homotopy_continuation(self) -> str:
        """The system as Julia text for HomotopyContinuation.jl."""
        from .formats import homotopy_continuation

        return homotopy_continuation.write(self)

    @classmethod
    def from_homotopy_continuation(cls, text: str) -> System:
        """A system from Julia text for HomotopyContinuation.jl: `@var` lines and one `System`."""
        from .formats import homotopy_continuation

        return homotopy_continuation.read(text)

    @classmethod
    def from_phcpy(cls, polynomials: Iterable[str]) -> System:
        """A system from phcpy's list of polynomials."""
        from .formats import phcpy

        return cls.from_text(phcpy.file_text(polynomials))

    def write(self, path: str | os.PathLike[str], notation: str = "json") -> None:
        """Writes a file: `notation` is json, bertini, phcpack or homotopy-continuation."""
        texts = {
            "json": self.to_json,
            "bertini": self.to_bertini,
            "phcpack": self.to_phcpack,
            "homotopy-continuation": self.to_homotopy_continuation,
        }
        if notation not in texts:
            raise InputError(f"expected one of {', '.join(texts)}, found {notation}", field="notation")
        Path(path).write_text(texts[notation](), encoding="utf-8")

    def at(self, values: Mapping[Any, Any] | None = None, **named: object) -> System:
        """The system with parameters replaced by exact values; other parameters stay.

        >>> from fractions import Fraction
        >>> import cognate as cg
        >>> family = cg.System(["x^2 - p"], parameters="p")
        >>> one = family.at(p=Fraction(1, 3))
        >>> one.parameters, dict(one.definitions)
        ((), {'p': '1/3'})
        """
        given: dict[Any, Any] = {**(values or {}), **named}
        exact = {
            expressions.name(key, "values"): expressions.expression(value, f"values.{key}")
            for key, value in given.items()
        }
        for name in exact:
            if name not in self.parameters:
                raise InputError(f"expected one of the parameters {', '.join(self.parameters)}", field=name)
        rest = tuple(p for p in self.parameters if p not in exact)
        found = replace_fields(self, parameters=rest, definitions={**exact, **self.definitions})
        return found

    def info(self) -> dict[str, Any]:
        """Properties of the system and the cost of each start, as `cognate info` prints them. Does not solve."""
        with program.Folder() as folder:
            path = folder.write("problem.json", self.to_json())
            command = ["info", str(path), *option_words(format="json")]
            found = json.loads(program.run(command, own={str(path): None}).output)
        assert isinstance(found, dict), "the program answers with an object"
        return found

    def _converted(self, notation: str) -> str:
        with program.Folder() as folder:
            path = folder.write("problem.json", self.to_json())
            command = ["convert", str(path), *option_words(to=notation)]
            found = program.run(command, own={str(path): None, path.name: "the system"})
        return program.issue_warnings(found).output


def replace_fields(system: System, **fields: object) -> System:
    """A system with other values of some fields."""
    all_fields = {name: getattr(system, name) for name in FIELDS}
    all_fields.update(fields)
    return System(**all_fields)


def _occurring(
    equations: tuple[str, ...], definitions: Mapping[str, str], parameters: tuple[str, ...]
) -> tuple[str, ...]:
    """The names that are neither defined nor parameters, in the order of first appearance."""
    found: dict[str, None] = {}
    for text in (*equations, *definitions.values()):
        for name in expressions.names(text):
            if name not in definitions and name not in parameters:
                found.setdefault(name)
    return tuple(found)


def _pair(pair: Sequence[object], index: int) -> tuple[str, str]:
    found = f"conjugates[{index}]"
    if not isinstance(pair, (list, tuple)) or len(pair) != 2:
        raise InputError(f"expected two variables, found {pair!r}", field=found)
    return expressions.name(pair[0], found), expressions.name(pair[1], found)


@dataclass(frozen=True)
class ProblemFile:
    """A file for the program: the user's own file, or a file written for the user's object."""

    path: Path
    own: dict[str, str | None]
    system: System | None = None


def problem_file(problem: object, folder: program.Folder, variables: object = None) -> ProblemFile:
    """The file for a problem in any accepted form; `variables`: for equations without their own variables."""
    if isinstance(problem, os.PathLike):
        return ProblemFile(Path(problem), {})
    if isinstance(problem, str):
        kind = _kind(problem)
        if kind == "file":
            return ProblemFile(Path(problem), {})
        if kind == "text":
            path = folder.write("problem", problem)
            return ProblemFile(path, {str(path): TEXT})
    if isinstance(problem, Mapping):
        problem = System.from_json(problem)
    if not isinstance(problem, System):
        problem = System(problem, variables)
    path = folder.write("problem.json", problem.to_json())
    return ProblemFile(path, {str(path): None}, problem)


def _kind(text: str) -> str:
    """Kind of a string: the name of a file, the text of a file, or an equation."""
    if any(mark in text for mark in ("\n", ";", "{")):
        return "text"
    if os.path.exists(text):
        return "file"
    # Several equations between commas.
    if "," in text:
        return "text"
    # `three_rpr.bertini` is the name of a missing file, not an equation.
    stem, dot, suffix = text.rpartition(".")
    if (os.sep in stem and not any(mark in text for mark in "*+^= ")) or (
        dot and suffix.isalpha() and stem and not any(mark in text for mark in "*+^=( ")
    ):
        return "file"
    return "equation"
