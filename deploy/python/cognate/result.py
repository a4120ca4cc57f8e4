"""Result: the answer of a solve, with its counts and open questions."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from .display import html_table, text_table, verdict
from .errors import CognateError, CognateWarning, NotKnown, UnsettledWarning, in_the_users_words, warn
from .solution import Solution, check_names

if TYPE_CHECKING:
    import numpy
    import pandas
    from numpy.typing import NDArray


@dataclass(frozen=True)
class PathCounts:
    """Counts of paths. Each path is in the first class that applies; the classes add up to `total`.

    `failed`; `at_infinity`; `removed`: a denominator of the given equations is 0 there; `excess`: a solution only after
    randomisation; `positive_dimensional`: on a positive-dimensional set;
    `undecided`: at a singular point that may or may not be isolated; `within_data_accuracy`:
    the verdict could change within the accuracy of the decimals; `singular`; `finite`. None: not decided.
    """

    total: int
    failed: int
    at_infinity: int
    excess: int | None
    positive_dimensional: int | None
    undecided: int
    within_data_accuracy: int
    singular: int
    finite: int
    retracked: int = 0
    crossings_found: int = 0
    crossings_resolved: int = 0
    decided_by_precision_limit: int = 0
    images: int = 0
    removed: int = 0
    highest_precision_bits: int = 53
    degenerate: Mapping[str, int] = field(default_factory=dict)
    by_precision: Mapping[str, int] = field(default_factory=dict)

    @property
    def classes(self) -> dict[str, int | None]:
        """The classes of paths, which add up to `total`."""
        names = (
            "failed",
            "at_infinity",
            "removed",
            "excess",
            "positive_dimensional",
            "undecided",
            "within_data_accuracy",
            "singular",
            "finite",
        )
        return {name: getattr(self, name) for name in names}

    @property
    def adds_up(self) -> bool:
        """True if every path is in exactly one class."""
        return sum(count or 0 for count in self.classes.values()) == self.total


@dataclass(frozen=True)
class SolutionCounts:
    """Isolated finite points after merging: `distinct` = `nonsingular` + `singular`, without `undecided` points.

    `complete`: `yes`, `no` or `not known`, with `complete_reason`. `removed`: points that do not solve the given
    equations, by reason; they are in no other count. None: not requested, or not decided.
    """

    distinct: int
    nonsingular: int
    singular: int
    real: int | None
    real_reason: str | None
    with_multiplicity: int
    undecided: int = 0
    doubtful_multiplicity: int = 0
    without_conjugate: int = 0
    certified: int | None = None
    certified_real: int | None = None
    positive_dimensional: bool | None = None
    complete: str = "not known"
    complete_reason: str | None = None
    degenerate: Mapping[str, int] = field(default_factory=dict)
    removed: Mapping[str, int] = field(default_factory=dict)
    doubtful_denominators: int = 0
    without_path: int = 0
    ill_conditioned: int = 0
    sharpened: Mapping[str, int] | None = None

    @property
    def adds_up(self) -> bool:
        """True if the kinds of solutions add up."""
        return self.nonsingular + self.singular == self.distinct


def counts_of(found: Mapping[str, Any]) -> SolutionCounts:
    """The counts of a summary's block `solutions`."""
    counts: SolutionCounts = _block(SolutionCounts, found)
    return counts


def _block(kind: type[Any], found: Mapping[str, Any]) -> Any:
    """A dataclass from the known fields of a JSON object. Newer programs may write more fields."""
    known = kind.__dataclass_fields__
    return kind(**{name: value for name, value in found.items() if name in known})


class Points:
    """Solutions with their counts, as lists and arrays."""

    solutions: tuple[Solution, ...]
    undecided: tuple[Solution, ...]
    counts: SolutionCounts

    def __iter__(self) -> Iterator[Solution]:
        """The solutions."""
        return iter(self.solutions)

    def __len__(self) -> int:
        """Number of solutions."""
        return len(self.solutions)

    def __getitem__(self, index: Any) -> Any:
        """One solution, or a slice."""
        return self.solutions[index]

    @property
    def variables(self) -> tuple[str, ...]:
        """Names of the variables, in the order of arrays' columns; empty if there is no solution."""
        return check_names(self.solutions + self.undecided)

    @property
    def real(self) -> list[Solution]:
        """The real solutions. Raises `NotKnown` if it is not decided which solutions are real."""
        if self.counts.real is None or any(s.real is None for s in self.solutions):
            raise NotKnown(self.counts.real_reason or "which solutions are real is not decided")
        return [s for s in self.solutions if s.real]

    @property
    def nonsingular(self) -> list[Solution]:
        """The solutions with a regular Jacobian."""
        return [s for s in self.solutions if not s.singular]

    @property
    def singular(self) -> list[Solution]:
        """The isolated singular solutions."""
        return [s for s in self.solutions if s.singular]

    @property
    def certified(self) -> list[Solution]:
        """The proved solutions. Raises `NotKnown` if no proofs were requested."""
        if self.counts.certified is None:
            raise NotKnown("no certificates were asked for; solve(..., certify=True) has them")
        return [s for s in self.solutions if s.certificate is not None and s.certificate.certified]

    @property
    def complete(self) -> bool | None:
        """True if these are all isolated solutions; None if not known (see `counts.complete_reason`)."""
        return {"yes": True, "no": False}.get(self.counts.complete)

    def array(self) -> NDArray[numpy.complex128]:
        """The solutions as an array of shape (solutions, variables), in doubles."""
        import numpy

        shape = (len(self.solutions), len(self.variables))
        return numpy.array([s.coordinates for s in self.solutions], dtype=numpy.complex128).reshape(shape)

    def real_array(self) -> NDArray[numpy.float64]:
        """The real solutions as an array of shape (real solutions, variables), without imaginary parts.

        With pairs of conjugate variables a real solution has complex coordinates. This call is then refused.
        """
        import numpy

        real = self.real
        if any(s[name].imag != 0 and _is_complex(s, name) for s in real for name in s):
            raise NotKnown("real solutions of conjugate variables have complex coordinates; array() has them")
        rows = [[z.real for z in s.coordinates] for s in real]
        return numpy.array(rows, dtype=numpy.float64).reshape(len(real), len(self.variables))

    def plot(self, *names: str, axes: Any = None) -> Any:
        """Draws the solutions by matplotlib, into `axes` or a new figure; returns the axes.

        One name: its values in the complex plane. Two names: the real solutions in the plane of both.
        No names: the same for the first two variables, or for the only variable.
        """
        from .drawing import plane_axes

        chosen = names or self.variables[:2]
        strange = [name for name in chosen if self.solutions and name not in self.variables]
        if len(chosen) not in (0, 1, 2) or strange:
            raise ValueError(f"expected one or two of {', '.join(self.variables)}, found {', '.join(chosen)}")
        axes = plane_axes(axes)
        if len(chosen) == 1:
            points = [solution[chosen[0]] for solution in self.solutions]
            axes.plot([z.real for z in points], [z.imag for z in points], "o")
            axes.set_xlabel(f"real part of {chosen[0]}")
            axes.set_ylabel("imaginary part")
        elif chosen:
            columns = [[solution[name].real for solution in self.real] for name in chosen]
            axes.plot(*columns, "o")
            axes.set_xlabel(chosen[0])
            axes.set_ylabel(chosen[1])
        return axes

    def frame(self) -> pandas.DataFrame:
        """The solutions as a table of pandas: a column for each variable, then columns of their properties."""
        import pandas

        columns: dict[str, list[Any]] = {name: [s[name] for s in self.solutions] for name in self.variables}
        for name in ("real", "singular", "multiplicity", "residual", "condition", "accuracy", "precision_bits"):
            # A variable may have the same name.
            columns[name if name not in columns else f"{name}_"] = [getattr(s, name) for s in self.solutions]
        return pandas.DataFrame(columns)


class _Answer(Points):
    """Base class of a result and of its targets."""

    paths: PathCounts

    if TYPE_CHECKING:

        @property
        def settled(self) -> bool:
            """True if every path is accounted for and every count is settled."""

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {verdict(self)}{'' if self.settled else ', not settled'}>"


def _is_complex(solution: Solution, name: str) -> bool:
    """True if a coordinate is further from the real axis than its rounding error."""
    z = solution[name]
    size = max(1.0, *(abs(w) for w in solution.coordinates))
    accuracy = max(solution.accuracy or 0.0, 1e-12)
    return abs(z.imag) > 1e3 * accuracy * size


@dataclass(frozen=True, repr=False)
class TargetResult(_Answer):
    """The answer at one of several targets."""

    index: int
    paths: PathCounts
    counts: SolutionCounts
    solutions: tuple[Solution, ...]
    undecided: tuple[Solution, ...]
    classes: Mapping[str, Any] = field(default_factory=dict)

    @property
    def open_questions(self) -> list[str]:
        """The open questions at this target."""
        return _open_questions(self.paths, self.counts) + _symmetry_doubts(self.classes)

    @property
    def settled(self) -> bool:
        """True if every path is accounted for and every count is settled."""
        return not self.open_questions


@dataclass(frozen=True, repr=False)
class Result(_Answer):
    """The answer of a solve.

    `solutions`: the isolated solutions; `undecided`: finite singular points that may or may not be isolated; they
    are in no count, with conditions also points that may or may not meet them. `paths`, `counts`: numbers of paths
    and of solutions. `settled`: every path is accounted for and every count is settled. `complete`: these are all
    isolated solutions.
    `targets`: the answer at each of several targets; the fields of the result then hold all of them.
    `parameters`: the parameter values of the solutions, for a monodromy solve. `failures`: reasons of failed paths
    with their numbers. `warnings`: remarks for the user. `seconds`: wall time. `summary`: the program's own
    summary, with everything. `output`: the folder with all files, if requested.
    """

    job: str
    start: str
    seed: int
    settled: bool
    paths: PathCounts
    counts: SolutionCounts
    solutions: tuple[Solution, ...]
    undecided: tuple[Solution, ...]
    targets: tuple[TargetResult, ...]
    parameters: Mapping[str, complex]
    failures: Mapping[str, int]
    warnings: tuple[str, ...]
    seconds: float
    summary: Mapping[str, Any]
    output: Path | None

    @property
    def open_questions(self) -> list[str]:
        """A phrase for each reason why the answer is not settled; empty if it is settled."""
        found = _open_questions(self.paths, self.counts) + _symmetry_doubts(self.classes)
        undecided = (self.summary.get("selected") or {}).get("undecided", 0)
        if undecided:
            found.append(f"{undecided} points of which it is not known whether they meet the condition")
        for target in self.targets:
            found.extend(f"target {target.index}: {q}" for q in target.open_questions)
        if not self.settled and not found:
            found.append("a count is not settled")
        return found

    @property
    def critical(self) -> Mapping[str, Any]:
        """With `minimize`, `maximize` or `critical`: the numbers of critical points of each kind, and the `reason`.

        `minimum` or `maximum` has `value` and `points`; it is None if not known.
        """
        found: Mapping[str, Any] | None = self.summary.get("critical")
        if found is None:
            raise NotKnown("no objective was asked for; solve(..., minimize='x^2 + y^2') has one")
        return found

    @property
    def classes(self) -> Mapping[str, Any]:
        """With a symmetry: `count` and completeness of the classes of solutions, from the summary."""
        found: Mapping[str, Any] = self.summary["classes"]
        return found

    def report(self) -> str:
        """The counts and the first solutions as a table of text."""
        return text_table(self)

    def __str__(self) -> str:
        return self.report()

    def _repr_html_(self) -> str:
        """The same table for notebooks."""
        return html_table(self)


def _symmetry_doubts(classes: Mapping[str, Any]) -> list[str]:
    """The reason why a declared symmetry is none, if there is one."""
    doubt = classes.get("doubt")
    return [doubt] if doubt else []


def _open_questions(paths: PathCounts, counts: SolutionCounts) -> list[str]:
    found = []

    def unless_zero(number: int, what: str) -> None:
        if number:
            found.append(f"{number} {what}")

    unless_zero(paths.failed, "paths failed")
    unless_zero(paths.crossings_found - paths.crossings_resolved, "path crossings are not resolved")
    unless_zero(paths.decided_by_precision_limit, "paths are finite or at infinity only by the limit of the precision")
    unless_zero(
        max(paths.undecided, counts.undecided),
        "ends at singular points of which it is not known whether they are isolated",
    )
    unless_zero(paths.within_data_accuracy, "ends have another verdict within the accuracy of the decimals")
    unless_zero(counts.doubtful_multiplicity, "singular points have another multiplicity than paths that end there")
    unless_zero(counts.without_conjugate, "solutions have no conjugate among the solutions, which is one, too")
    unless_zero(
        counts.doubtful_denominators,
        "points at which a denominator may be 0, or a root on a false branch: digits do not tell",
    )
    if counts.complete == "no":
        found.append(f"solutions are missing: {counts.complete_reason}")
    if not paths.adds_up:
        listed = sum(count or 0 for count in paths.classes.values())
        found.append(f"the classes of paths add up to {listed} of {paths.total}")
    if not counts.adds_up:
        found.append(f"{counts.nonsingular} + {counts.singular} solutions are not {counts.distinct}")
    return found


def read(folder: Path, *, output: Path | None, own: dict[str, str | None]) -> Result:
    """The answer in a folder that the program has written: `summary.json` and `solutions.jsonl`.

    `own`: files written for the user's objects; warnings may name them.
    """
    summary: dict[str, Any] = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    with (folder / "solutions.jsonl").open(encoding="utf-8") as lines:
        listed = [json.loads(line) for line in lines]
    return of(summary, listed, output=output, own=own)


def of(
    summary: dict[str, Any], listed: Iterable[Mapping[str, Any]], *, output: Path | None, own: dict[str, str | None]
) -> Result:
    """The answer from a summary and the solutions as the program writes them; `own` as for `read`."""
    summary["warnings"] = [in_the_users_words(w, own) for w in summary.get("warnings") or []]
    return from_summary(summary, [Solution.from_json(one) for one in listed], output=output)


def from_summary(summary: Mapping[str, Any], listed: list[Solution], *, output: Path | None) -> Result:
    """The answer from a summary and all points, also undecided points, target after target."""
    if "paths" not in summary:
        raise CognateError("several targets without a result to start from are for cognate.sweep(problem, targets=...)")
    paths: PathCounts = _block(PathCounts, summary["paths"])
    counts: SolutionCounts = _block(SolutionCounts, summary["solutions"])
    selected = summary.get("selected")
    if selected is not None:
        if selected["count"] + selected["on_border"] + selected["undecided"] != len(listed):
            raise CognateError(
                f"the answer does not add up: {selected['count']} solutions are selected, {selected['on_border']} "
                f"on the border and {selected['undecided']} not decided, {len(listed)} are listed"
            )
    elif counts.distinct + counts.undecided != len(listed):
        raise CognateError(
            f"the answer does not add up: {counts.distinct} solutions and {counts.undecided} undecided points "
            f"are counted, {len(listed)} are listed"
        )
    parameters = (summary.get("monodromy") or {}).get("parameters") or {}
    solutions, undecided = split(listed, selected)
    return Result(
        job=str(summary["job"]),
        start=str(summary["problem"]["start"]),
        seed=int(summary["problem"]["seed"]),
        settled=bool(summary["settled"]) and paths.adds_up and counts.adds_up,
        paths=paths,
        counts=counts,
        solutions=solutions,
        undecided=undecided,
        targets=_targets(summary.get("targets") or [], listed),
        parameters={name: complex(re, im) for name, (re, im) in parameters.items()},
        failures=dict(summary.get("failures") or {}),
        warnings=tuple(summary.get("warnings") or ()),
        seconds=float(summary["time"]["wall_seconds"]),
        summary=summary,
        output=output,
    )


def split(
    listed: list[Solution], selected: Mapping[str, Any] | None
) -> tuple[tuple[Solution, ...], tuple[Solution, ...]]:
    """The solutions that are listed, and apart from them the points that may be none, or may not be `selected`."""

    def is_open(point: Solution) -> bool:
        return point.undecided or (selected is not None and point.on_border is None)

    return tuple(s for s in listed if not is_open(s)), tuple(s for s in listed if is_open(s))


def _targets(blocks: list[Mapping[str, Any]], listed: list[Solution]) -> tuple[TargetResult, ...]:
    """The points of each target. They are listed target after target; the counts give their numbers."""
    found = []
    begin = 0
    first_path = 0
    for index, block in enumerate(blocks):
        paths: PathCounts = _block(PathCounts, block["paths"])
        counts: SolutionCounts = _block(SolutionCounts, block["solutions"])
        end = begin + counts.distinct + counts.undecided
        own = listed[begin:end]
        # A path's number counts its start and the targets before it, so a point at the wrong target is found.
        if any(not first_path <= p < first_path + paths.total for s in own for p in s.paths) or len(own) != end - begin:
            raise CognateError(f"the answer does not add up: solutions of target {index} are of paths to another one")
        found.append(
            TargetResult(
                index=index,
                paths=paths,
                counts=counts,
                solutions=tuple(s for s in own if not s.undecided),
                undecided=tuple(s for s in own if s.undecided),
                classes=block.get("classes") or {},
            )
        )
        begin, first_path = end, first_path + paths.total
    return tuple(found)


class Settling(Protocol):
    """An answer with open questions."""

    @property
    def summary(self) -> Mapping[str, Any]:
        """The program's own summary."""

    @property
    def warnings(self) -> tuple[str, ...]:
        """Remarks for the user."""

    @property
    def open_questions(self) -> list[str]:
        """A phrase for each open question."""


def issue_warnings(result: Settling) -> None:
    """Issues the remarks and open questions of an answer as Python warnings."""
    for warning in result.warnings:
        warn(warning, CognateWarning)
    questions = result.open_questions
    if questions:
        warn("not settled: " + "; ".join(questions), UnsettledWarning)
