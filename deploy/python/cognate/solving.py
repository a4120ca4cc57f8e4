"""Solve: a problem on this machine, by the program with its own workers."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from . import command_line, program, result
from . import kept as kept_open
from . import options as options_
from .errors import CognateError, Unsettled
from .options import Options
from .progress import Bar, Wanted
from .result import Result, Settling
from .system import System, problem_file

if TYPE_CHECKING:
    from typing_extensions import Unpack

Answer = TypeVar("Answer", bound=Settling)


def solve(
    problem: object = (),
    *,
    workers: int | None = None,
    threads: int | None = None,
    progress: Wanted = None,
    strict: bool = False,
    output: str | os.PathLike[str] | None = None,
    **options: Unpack[Options],
) -> Result:
    """All isolated solutions of a system of polynomial equations.

    For a small system a call starts no process, because the program stays open between calls; see `cognate.kept`.

    `problem`: a `System`; equations, as strings or from sympy, one or a list; our JSON as a mapping; a file
    (Bertini-classic input, PHCpack's format or our JSON) by its path; or the text of a file. Nothing, if the objective
    and `where` say all.
    `workers`: processes that track, with `threads` each; by default none for a very short solve, else two.
    `progress`: see `cognate.progress.Wanted`. `strict`: an answer that is not settled raises `Unsettled`
    instead of a warning. `output`: a folder for all files, also paths.parquet and Bertini's files. `options`: see
    `Options`.

    Warns with `UnsettledWarning` if paths failed, ends are undecided or counts do not add up. Raises
    `InputError` if the problem or an option is wrong, `ServiceError` if the program gives up.

    >>> import cognate as cg
    >>> found = cg.solve(["x^2 + y^2 - 4", "x*y - 1"])
    >>> found.counts.distinct, found.counts.real, found.settled, found.complete
    (4, 4, True, True)
    >>> all(abs(s["x"] * s["y"] - 1) < 1e-12 for s in found.solutions)
    True
    """
    if workers is None and threads is None and output is None and "targets" not in options:
        return _solve_in_kept(problem, options, progress, strict)
    with program.Folder() as folder, Bar(progress) as bar:
        arguments, own, kept = solve_arguments(problem, options, folder, workers, threads, output, bar)
        finished = program.run(arguments, own=own, watcher=bar.watcher)
        found = result.read(kept or folder.path / "answer", output=kept, own=own)
    return checked_as_finished(found, finished.exit_code, strict)


def _solve_in_kept(problem: object, options: Options, progress: Wanted, strict: bool) -> Result:
    """Solves by a program that stays open for the next call."""
    with program.Folder() as folder, Bar(progress) as bar:
        arguments, own = problem_arguments(problem, options, folder)
        answer = kept_open.solve([*_progress(bar), *arguments], own=own, watcher=bar.watcher)
        found = result.of(answer.summary, answer.solutions, output=None, own=own)
    return checked_as_finished(found, answer.exit_code, strict)


async def solve_async(
    problem: object = (),
    *,
    workers: int | None = None,
    threads: int | None = None,
    progress: Wanted = None,
    strict: bool = False,
    output: str | os.PathLike[str] | None = None,
    **options: Unpack[Options],
) -> Result:
    """The same as `solve`, for `await`. If the task is cancelled, the solve ends.

    >>> import asyncio, cognate as cg
    >>> asyncio.run(cg.solve_async(["x^2 - 2"])).counts.real
    2
    """
    with program.Folder() as folder, Bar(progress) as bar:
        arguments, own, kept = solve_arguments(problem, options, folder, workers, threads, output, bar)
        finished = await program.run_async(arguments, own=own, watcher=bar.watcher)
        found = result.read(kept or folder.path / "answer", output=kept, own=own)
    return checked_as_finished(found, finished.exit_code, strict)


def problem_arguments(
    problem: object, options: Options, folder: program.Folder
) -> tuple[list[str], dict[str, str | None]]:
    """The program's arguments for a problem and its options; and the files written for them."""
    is_nothing = problem is None or (isinstance(problem, (str, list, tuple)) and len(problem) == 0)
    if is_nothing and any(options.get(goal) is not None for goal in options_.OBJECTIVES):
        return options_.arguments(options, folder, lambda: ((), ()))
    file = problem_file(problem, folder)

    def names() -> tuple[tuple[str, ...], tuple[str, ...]]:
        system = file.system or System.read(file.path)
        return system.variables, system.parameters

    found, own = options_.arguments(options, folder, names)
    # After `--` a path that begins with a hyphen is not read as an option.
    return [*found, "--", str(file.path)], {**own, **file.own}


def solve_arguments(
    problem: object,
    options: Options,
    folder: program.Folder,
    workers: int | None,
    threads: int | None,
    output: str | os.PathLike[str] | None,
    bar: Bar,
) -> tuple[list[str], dict[str, str | None], Path | None]:
    """The program's arguments for a solve; the files written for them; and the user's output folder."""
    found, own = problem_arguments(problem, options, folder)
    kept = None if output is None else Path(output)
    place = command_line.option_words(
        format="json", output=kept or folder.path / "answer", workers=workers, threads=threads
    )
    return ["solve", *place, *_progress(bar), *found], own, kept


def _progress(bar: Bar) -> list[str]:
    """The option for progress lines, only if a bar reads them."""
    return command_line.option_words(progress=None if bar.watcher is None else "json")


def checked_as_finished(found: Answer, exit_code: int, strict: bool) -> Answer:
    """An answer of a program. The exit code shows whether the answer is settled."""
    if (exit_code == program.SOLVED) != bool(found.summary["settled"]):
        raise CognateError("the program's exit code and its summary do not agree on whether the answer is settled")
    return checked(found, strict)


def checked(found: Answer, strict: bool) -> Answer:
    """Returns an answer. An answer that is not settled gives a warning; `strict` raises `Unsettled`."""
    if strict and found.open_questions:
        raise Unsettled("not settled: " + "; ".join(found.open_questions), found)
    result.issue_warnings(found)
    return found
