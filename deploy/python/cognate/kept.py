"""Programs that stay open: `cognate serve` processes that answer one solve after another, for any thread.

The start of a process costs more than a small system. So a program that has answered is kept for the next call with the
same folder and environment. One call at a time uses a program; calls of several threads get one program each. A child
of `fork` has its own programs. The programs end with the interpreter, because their standard input ends with it.
"""

from __future__ import annotations

import atexit
import contextlib
import json
import os
import signal
import subprocess
import tempfile
import threading
import weakref
from collections.abc import Sequence
from typing import Any, NamedTuple

from . import program
from .program import Listener, Own, Watcher

MOST_IDLE = 8
"""Most programs that are kept; each takes some ten megabytes."""

READ_BYTES = 1 << 16
"""Bytes that a pipe holds."""

Key = tuple[object, ...]
"""Inputs of an answer besides the arguments: the program, the folder and the environment."""


class Answered(NamedTuple):
    """An answer: the exit code of `cognate solve`, the summary, the listed solutions."""

    exit_code: int
    summary: dict[str, Any]
    solutions: list[dict[str, Any]]


class _Died(Exception):
    """The program has ended without an answer."""


class _Program:
    """One open program. Its pipes are used without Python's buffers, because a fork would duplicate them."""

    def __init__(self, key: Key) -> None:
        self.key = key
        self.has_answered = False
        self._rest = b""
        self._errors = tempfile.TemporaryFile()
        try:
            self._process = subprocess.Popen(
                [program.find(), "serve"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._errors,
                bufsize=0,
                # Ctrl-C on a terminal goes to Python. Python then interrupts the program.
                start_new_session=True,
            )
        except BaseException:
            self._errors.close()
            raise

    @property
    def pid(self) -> int:
        return self._process.pid

    def lives(self) -> bool:
        return self._process.poll() is None

    def ask(self, arguments: Sequence[str], watcher: Watcher | None) -> dict[str, Any]:
        """Sends one request, and returns its answer."""
        assert self._process.stdin is not None, "a pipe was asked for"
        rest = memoryview(json.dumps({"arguments": list(arguments)}).encode() + b"\n")
        try:
            while rest:
                rest = rest[os.write(self._process.stdin.fileno(), rest) :]
        except BrokenPipeError:
            raise _Died from None
        listener = Listener()
        while True:
            answer: dict[str, Any] = json.loads(self._line())
            if "progress" not in answer:
                self.has_answered = True
                return answer
            now = listener.line(json.dumps(answer["progress"]))
            if now is not None and watcher is not None:
                watcher(now)

    def _line(self) -> bytes:
        assert self._process.stdout is not None, "a pipe was asked for"
        parts = [self._rest]
        while b"\n" not in parts[-1]:
            part = os.read(self._process.stdout.fileno(), READ_BYTES)
            if not part:
                raise _Died
            parts.append(part)
        line, _, self._rest = b"".join(parts).partition(b"\n")
        return line

    def stop(self) -> None:
        """Interrupts the program, and waits until it has stopped its workers."""
        self.drop_pipes()
        if self.lives():
            with contextlib.suppress(ProcessLookupError):
                self._process.send_signal(signal.SIGINT)
            try:
                self._process.wait(program.STOP_SECONDS)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        self._errors.close()

    def why(self) -> tuple[int, str]:
        """Exit code and messages of a program that has ended."""
        exit_code = self._process.wait()
        listener = Listener()
        self._errors.seek(0)
        for line in self._errors:
            listener.line(line.decode("utf-8", errors="replace"))
        return exit_code, listener.message()

    def drop_pipes(self) -> None:
        """Closes this process's ends of the pipes. The program ends if no other process holds them."""
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                pipe.close()

    def forget(self) -> None:
        """Drops the program in a child of `fork`: it belongs to the parent."""
        self.drop_pipes()
        self._errors.close()
        # A process that is not a child of this process cannot be waited for.
        self._process.returncode = 0


class _Kept:
    """The programs of this process."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self._idle: list[_Program] = []
        # All programs, also those in use by a call.
        self._open: weakref.WeakSet[_Program] = weakref.WeakSet()

    def take(self, key: Key, *, fresh: bool = False) -> _Program:
        """A program for one call: the last returned program, or a new one."""
        useless: list[_Program] = []
        chosen = None
        with self.lock:
            if fresh or any(one.key != key for one in self._idle):
                useless, self._idle = self._idle, []
            while self._idle and chosen is None:
                last = self._idle.pop()
                if last.lives():
                    chosen = last
                else:
                    useless.append(last)
        for one in useless:
            one.stop()
        if chosen is None:
            chosen = _Program(key)
            with self.lock:
                self._open.add(chosen)
        return chosen

    def give(self, one: _Program) -> None:
        """Keeps a program that has answered."""
        with self.lock:
            is_kept = len(self._idle) < MOST_IDLE
            if is_kept:
                self._idle.append(one)
        if not is_kept:
            one.stop()

    def close(self) -> None:
        """Ends the programs that no call uses."""
        with self.lock:
            idle, self._idle = self._idle, []
        # All programs get the end of input before the first wait.
        for one in idle:
            one.drop_pipes()
        for one in idle:
            one.stop()

    def processes(self) -> tuple[int, ...]:
        """Process ids of the programs that live."""
        with self.lock:
            return tuple(sorted(one.pid for one in self._open if one.lives()))

    def forget(self) -> None:
        """Drops all programs in a child of `fork`: they belong to the parent."""
        for one in self._open:
            one.forget()
        self._idle = []
        self._open = weakref.WeakSet()
        # The lock was taken before the fork.
        self.lock.release()


_kept = _Kept()
atexit.register(_kept.close)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(
        before=_kept.lock.acquire,
        after_in_parent=_kept.lock.release,
        after_in_child=_kept.forget,
    )


def solve(arguments: Sequence[str], *, own: Own | None = None, watcher: Watcher | None = None) -> Answered:
    """The answer of `cognate solve` with these arguments, by an open program. Exit codes of errors raise exceptions.

    After any exception, for example Ctrl-C, the program stops its work and is not kept.
    """
    key = (program.find(), os.getcwd(), tuple(os.environ.items()))
    fresh = False
    while True:
        one = _kept.take(key, fresh=fresh)
        try:
            answer = one.ask(arguments, watcher)
        except _Died:
            exit_code, said = one.why()
            one.stop()
            # A kept program was ended from outside: try a new one. A new program ended because of this request.
            if one.has_answered:
                fresh = True
                continue
            raise program.ended(exit_code, said, own) from None
        except BaseException:
            one.stop()
            raise
        _kept.give(one)
        exit_code = int(answer["exit_code"])
        if exit_code not in (program.SOLVED, program.UNSETTLED):
            raise program.ended(exit_code, str(answer["error"]), own)
        return Answered(exit_code, answer["summary"], answer["solutions"])


def close() -> None:
    """Ends the programs that are kept open. The next solve starts a new one."""
    _kept.close()


def open_processes() -> tuple[int, ...]:
    """Process ids of the programs that this process keeps open."""
    return _kept.processes()
