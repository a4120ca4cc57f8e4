"""Sweep: a family at many values of its parameters, by one solve at general values."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import program
from .errors import CognateError, InputError, in_the_users_words
from .options import Options
from .progress import Bar, Wanted
from .result import Points, SolutionCounts, counts_of, split
from .solution import Solution
from .solving import checked_as_finished, solve_arguments

if TYPE_CHECKING:
    import pandas
    from typing_extensions import Unpack

OTHER_STARTS = ("start", "start_solutions", "start_parameters")
"""Options of a solve from known solutions."""


@dataclass(frozen=True, repr=False)
class SweepTarget(Points):
    """The answer at one target.

    `parameters`: their values by name. `counts`: counts of all solutions there. `solutions`: the listed solutions,
    selected and in the requested order. `selected`: with conditions, `count`, `on_border` and `undecided`, else None.
    `changes`: the number of real solutions (with conditions: of selected ones) differs from the target before.
    `by_itself`: the target was solved separately, because its solutions are singular or paths left a doubt.
    """

    index: int
    parameters: Mapping[str, complex]
    counts: SolutionCounts
    solutions: tuple[Solution, ...]
    undecided: tuple[Solution, ...]
    selected: Mapping[str, Any] | None
    changes: bool
    settled: bool
    by_itself: bool

    def __repr__(self) -> str:
        values = ", ".join(f"{name}={z.real if z.imag == 0 else z}" for name, z in self.parameters.items())
        number = f"{self.counts.distinct} solutions"
        return f"<SweepTarget {self.index}: {values}: {number}{'' if self.settled else ', not settled'}>"


@dataclass(frozen=True, repr=False)
class Sweep:
    """The answers at all targets, in their order.

    `family`: number of `solutions` at general values, and their `source`. `settled`: every target is settled.
    `seconds`: wall time. `summary`: the program's own summary. `output`: the folder with all files, if requested.
    """

    family: Mapping[str, Any]
    targets: tuple[SweepTarget, ...]
    settled: bool
    warnings: tuple[str, ...]
    seconds: float
    summary: Mapping[str, Any]
    output: Path | None

    @property
    def open_questions(self) -> list[str]:
        """A phrase for each target that is not settled."""
        return [f"target {target.index} is not settled" for target in self.targets if not target.settled]

    def frame(self) -> pandas.DataFrame:
        """A table of pandas with a row for each target: its parameters, then its counts."""
        import pandas

        first = self.targets[0].parameters if self.targets else {}
        columns: dict[str, list[Any]] = {name: [t.parameters[name] for t in self.targets] for name in first}
        for name, values in columns.items():
            if all(z.imag == 0 for z in values):
                columns[name] = [z.real for z in values]
        for name in ("distinct", "nonsingular", "singular", "real"):
            columns[name if name not in columns else f"{name}_"] = [getattr(t.counts, name) for t in self.targets]
        if any(t.selected is not None for t in self.targets):
            columns["selected"] = [None if t.selected is None else t.selected["count"] for t in self.targets]
        for name in ("changes", "settled"):
            columns[name if name not in columns else f"{name}_"] = [getattr(t, name) for t in self.targets]
        return pandas.DataFrame(columns)

    def __repr__(self) -> str:
        return f"<Sweep: {len(self.targets)} targets{'' if self.settled else ', not settled'}>"


def sweep(
    problem: object,
    *,
    workers: int | None = None,
    threads: int | None = None,
    progress: Wanted = None,
    strict: bool = False,
    output: str | os.PathLike[str] | None = None,
    **options: Unpack[Options],
) -> Sweep:
    """The solutions of a family at many values of its parameters: the option `targets` of `Options`.

    The family is solved once at general values. These solutions are stored for the next sweep; paths from them lead to
    the targets. The other arguments are those of `solve`.

    Warns with `UnsettledWarning` if a target is not settled. Raises `InputError` if the problem or an option is
    wrong, `ServiceError` if the program gives up.

    >>> import cognate as cg
    >>> family = cg.System(["x^3 + p*x + q"], parameters="p q")
    >>> found = cg.sweep(family, targets={"p": -3, "q": [-3, 0, 3]})
    >>> [target.counts.real for target in found.targets], found.settled
    ([1, 3, 1], True)
    """
    if options.get("targets") is None:
        raise InputError("expected values of the parameters, two sets of them at least", field="targets")
    for name in OTHER_STARTS:
        if options.get(name) is not None:
            raise InputError("a sweep finds its own start; solve(..., targets=...) follows from one", field=name)
    with program.Folder() as folder, Bar(progress) as bar:
        arguments, own, kept = solve_arguments(problem, options, folder, workers, threads, output, bar)
        finished = program.run(arguments, own=own, watcher=bar.watcher)
        found = _read(kept or folder.path / "answer", output=kept, own=own)
    return checked_as_finished(found, finished.exit_code, strict)


def _read(folder: Path, *, output: Path | None, own: dict[str, str | None]) -> Sweep:
    """The answer in a folder that the program has written."""
    summary: dict[str, Any] = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    if "paths" in summary:
        raise InputError("expected two sets of parameters at least; solve(..., targets=...) takes one", field="targets")
    listed: dict[int, list[Solution]] = {}
    with (folder / "solutions.jsonl").open(encoding="utf-8") as lines:
        for line in lines:
            fields = json.loads(line)
            listed.setdefault(int(fields["target"]), []).append(Solution.from_json(fields))
    targets = [_target(index, block, listed.pop(index, [])) for index, block in enumerate(summary["targets"])]
    if listed:
        raise CognateError(f"the answer does not add up: solutions of target {min(listed)}, which it has not")
    return Sweep(
        family=summary["family"],
        targets=tuple(targets),
        settled=bool(summary["settled"]),
        warnings=tuple(in_the_users_words(w, own) for w in summary.get("warnings") or ()),
        seconds=float(summary["time"]["wall_seconds"]),
        summary=summary,
        output=output,
    )


def _target(index: int, block: Mapping[str, Any], listed: list[Solution]) -> SweepTarget:
    counts = counts_of(block["solutions"])
    selected = block.get("selected")
    expected = counts.distinct + counts.undecided
    if selected is not None:
        expected = selected["count"] + selected["on_border"] + selected["undecided"]
    if expected != len(listed):
        raise CognateError(
            f"the answer does not add up: {expected} solutions of target {index} are counted, {len(listed)} are listed"
        )
    solutions, undecided = split(listed, selected)
    return SweepTarget(
        index=index,
        parameters={name: complex(re, im) for name, (re, im) in block["parameters"].items()},
        counts=counts,
        solutions=solutions,
        undecided=undecided,
        selected=selected,
        changes=bool(block["changes"]),
        settled=bool(block["settled"]),
        by_itself=bool(block["by_itself"]),
    )
