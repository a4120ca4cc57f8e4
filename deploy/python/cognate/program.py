"""The `cognate` program: its place, and its runs.

The program does all work of this package. It gets arguments and files, and answers with JSON. It writes progress
as lines to its standard error.
"""

from __future__ import annotations

import asyncio
import json
import os
import shutil
import signal
import subprocess
import tempfile
import weakref
from collections import deque
from collections.abc import AsyncIterator, Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType

from .errors import CognateWarning, ProgramNotFound, error_of, warn

SOLVED, UNSETTLED = 0, 1
"""Exit codes of an answer; other exit codes are errors."""

INTERRUPTED = 130
"""The exit code after Ctrl-C."""

Own = dict[str, str | None]
"""Files written for the user's objects (see `errors.input_error`)."""

STOP_SECONDS = 10.0
"""Seconds that the program has for its end after an interrupt."""

LONGEST_LINE = 1 << 24
"""Most bytes of a line of standard error; a line may contain a whole system."""

LINES_KEPT = 200
"""Most lines of standard error that are kept for a message."""


@dataclass(frozen=True)
class Progress:
    """Progress of a job. `done` and `total` count `unit`s, usually paths. `seconds`: time since the request."""

    phase: str
    done: int
    total: int
    failed: int
    unit: str
    seconds: float


Watcher = Callable[[Progress], None]
"""A function that receives progress."""


@dataclass
class Finished:
    """A run of the program that gave an answer."""

    exit_code: int
    output: str
    warnings: list[str] = field(default_factory=list)


class Folder:
    """A temporary folder that is removed at the end of the block."""

    def __init__(self) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="cognate-", ignore_cleanup_errors=True)
        self.path = Path(self._folder.name)

    def __enter__(self) -> Folder:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._folder.cleanup()

    def write(self, name: str, text: str) -> Path:
        """Writes a file of this name, and returns its path."""
        path = self.path / name
        path.write_text(text, encoding="utf-8")
        return path


class KeptFolder:
    """A temporary folder that is removed with the last object that holds it, or with the interpreter."""

    def __init__(self) -> None:
        self.path = Path(tempfile.mkdtemp(prefix="cognate-"))
        weakref.finalize(self, shutil.rmtree, self.path, ignore_errors=True)


def find(*, search_path: bool = True) -> str:
    """The program's path: COGNATE_PROGRAM, in this package, or on the PATH."""
    given = os.environ.get("COGNATE_PROGRAM")
    if given:
        if not os.access(given, os.X_OK):
            raise ProgramNotFound(f"COGNATE_PROGRAM={given}: no program is there")
        return given
    inside = Path(__file__).with_name("bin") / "cognate"
    if os.access(inside, os.X_OK):
        return str(inside)
    found = shutil.which("cognate") if search_path else None
    if found is None:
        raise ProgramNotFound(
            "the program `cognate` is not in this package and not on the PATH; "
            "install the package by `pip install ./deploy/python`, or set COGNATE_PROGRAM"
        )
    return found


class Listener:
    """Separates the program's standard error into progress, warnings and other messages."""

    def __init__(self) -> None:
        self.warnings: list[str] = []
        self.rest: deque[str] = deque(maxlen=LINES_KEPT)

    def line(self, line: str) -> Progress | None:
        """Reads one line; returns its progress if it contains progress."""
        if line.startswith("{"):
            return self._standing(line)
        if line.startswith("warning: "):
            self.warnings.append(line[len("warning: ") :].rstrip("\n"))
        else:
            self.rest.append(line)
        return None

    def _standing(self, line: str) -> Progress | None:
        try:
            now = json.loads(line)
        except json.JSONDecodeError:
            self.rest.append(line)
            return None
        if "message" in now:
            message = str(now["message"])
            if message.startswith("warning: "):
                self.warnings.append(message[len("warning: ") :])
            return None
        return Progress(
            phase=str(now["phase"]),
            done=int(now["done"]),
            total=int(now["total"]),
            failed=int(now["failed"]),
            unit=str(now["unit"]),
            seconds=float(now["seconds"]),
        )

    def message(self) -> str:
        """The program's error message."""
        text = "".join(self.rest)
        _, mark, after = text.rpartition("error: ")
        # Hints for the command line are left out.
        message, _, _ = (after if mark else text).partition("\n  try: ")
        return message.strip("\n")


class Run:
    """One run of the program: iterate over its progress, then call `finished` for the answer.

    If the block ends before the program, the program is interrupted.
    """

    def __init__(self, arguments: Sequence[str]) -> None:
        self._listener = Listener()
        # The answer goes to a file, so neither stream waits for the other.
        self._output = tempfile.TemporaryFile(mode="w+", encoding="utf-8")
        try:
            self._process = subprocess.Popen(
                [find(), *arguments],
                stdin=subprocess.DEVNULL,
                stdout=self._output,
                stderr=subprocess.PIPE,
                encoding="utf-8",
                errors="replace",
            )
        except BaseException:
            self._output.close()
            raise

    def __enter__(self) -> Run:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        _stop(self._process)
        assert self._process.stderr is not None, "a pipe was asked for"
        self._process.stderr.close()
        self._output.close()

    def __iter__(self) -> Iterator[Progress]:
        assert self._process.stderr is not None, "a pipe was asked for"
        for line in self._process.stderr:
            now = self._listener.line(line)
            if now is not None:
                yield now

    def finished(self, answers: Sequence[int] = (SOLVED, UNSETTLED), own: Own | None = None) -> Finished:
        """Waits for the end, and returns the answer. Any other exit code raises its error."""
        for _ in self:
            pass
        exit_code = self._process.wait()
        self._output.seek(0)
        return _finished(exit_code, self._output.read(), self._listener, answers, own)


class AsyncRun:
    """The same as `Run`, for `async with` and `async for`."""

    def __init__(self, arguments: Sequence[str]) -> None:
        self._arguments = arguments
        self._listener = Listener()
        self._output = tempfile.TemporaryFile(mode="w+", encoding="utf-8")

    async def __aenter__(self) -> AsyncRun:
        try:
            self._process = await asyncio.create_subprocess_exec(
                find(),
                *self._arguments,
                stdin=asyncio.subprocess.DEVNULL,
                stdout=self._output,
                stderr=asyncio.subprocess.PIPE,
                limit=LONGEST_LINE,
            )
        except BaseException:
            self._output.close()
            raise
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        process = self._process
        if process.returncode is None:
            process.send_signal(signal.SIGINT)
            try:
                await asyncio.wait_for(process.wait(), STOP_SECONDS)
            except asyncio.TimeoutError:
                process.kill()
                await process.wait()
        self._output.close()

    async def __aiter__(self) -> AsyncIterator[Progress]:
        assert self._process.stderr is not None, "a pipe was asked for"
        async for line in self._process.stderr:
            now = self._listener.line(line.decode("utf-8", errors="replace"))
            if now is not None:
                yield now

    async def finished(self, answers: Sequence[int] = (SOLVED, UNSETTLED), own: Own | None = None) -> Finished:
        """The same as `Run.finished`."""
        async for _ in self:
            pass
        exit_code = await self._process.wait()
        self._output.seek(0)
        return _finished(exit_code, self._output.read(), self._listener, answers, own)


def run(arguments: Sequence[str], *, own: Own | None = None, watcher: Watcher | None = None) -> Finished:
    """Runs the program to its end. An exit code of an error raises the error."""
    with Run(arguments) as running:
        for now in running:
            if watcher is not None:
                watcher(now)
        return running.finished(own=own)


async def run_async(arguments: Sequence[str], *, own: Own | None = None, watcher: Watcher | None = None) -> Finished:
    """The same as `run`, for `await`. If the task is cancelled, the run is cancelled."""
    async with AsyncRun(arguments) as running:
        async for now in running:
            if watcher is not None:
                watcher(now)
        return await running.finished(own=own)


def _finished(exit_code: int, output: str, listener: Listener, answers: Sequence[int], own: Own | None) -> Finished:
    # The exit code promises an answer, but there is none: this is an error.
    if exit_code not in answers or (exit_code not in (SOLVED, UNSETTLED) and not output):
        raise ended(exit_code, listener.message(), own)
    return Finished(exit_code, output, listener.warnings)


def ended(exit_code: int, message: str, own: Own | None) -> BaseException:
    """The error for a program that ended without an answer."""
    return KeyboardInterrupt() if exit_code == INTERRUPTED else error_of(exit_code, message, own=own)


def issue_warnings(finished: Finished) -> Finished:
    """Issues the program's warnings as Python warnings."""
    for warning in finished.warnings:
        warn(warning, CognateWarning)
    return finished


def _stop(process: subprocess.Popen[str]) -> None:
    """Interrupts the program, and waits until it has stopped its workers."""
    if process.poll() is not None:
        return
    process.send_signal(signal.SIGINT)
    try:
        process.wait(STOP_SECONDS)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
