"""Exceptions for errors, and warnings about answers.

The program's messages contain file, line, column and field. `error_of` turns them into
attributes.
"""

from __future__ import annotations

import os
import re
import sys
import warnings
from typing import Any


class CognateError(Exception):
    """Base class of all errors that this package raises."""


class InputError(CognateError, ValueError):
    """A system, a file or an option is wrong.

    Attributes: `file` (None for input as Python objects), `line` and `column` (from 1), `field` (such
    as `equations[1]`, or the name of an option) and `reason` (the expected and the found input). Each is
    None if it is not known. `column` counts in the field if there is one, else in the line.
    """

    def __init__(
        self,
        reason: str,
        *,
        file: str | None = None,
        line: int | None = None,
        column: int | None = None,
        field: str | None = None,
    ) -> None:
        self.reason = reason
        self.file = file
        self.line = line
        self.column = column
        self.field = field
        place = [file] if file is not None else []
        if field is not None:
            place.append(field)
        if line is not None and field is None:
            place.append(f"line {line}")
        if column is not None:
            place.append(f"column {column}")
        super().__init__(f"{', '.join(place)}: {reason}" if place else reason)


class ProgramNotFound(CognateError):
    """The `cognate` program was not found."""


class ServiceError(CognateError):
    """The service gave up, or a part of it did not start."""


class Unreachable(ServiceError):
    """No coordinator answers."""


class Cancelled(CognateError):
    """The job was cancelled."""


class NotKnown(CognateError):
    """The service has not decided a question, for example which solutions are real. The message says why."""


class Unsettled(CognateError):
    """Raised with `strict=True` if an answer is not settled. `result` is the answer so far.

    `result` has the type that the function returns: `Result` for `solve`, `Decomposition` for `decompose`.
    """

    def __init__(self, message: str, result: Any) -> None:
        super().__init__(message)
        self.result = result

    def __reduce__(self) -> tuple[type[Unsettled], tuple[str, Any]]:
        return type(self), (str(self), self.result)


class CognateWarning(UserWarning):
    """A remark about an answer that the user should read."""


class UnsettledWarning(CognateWarning):
    """An answer is not settled: paths failed, ends are undecided, or counts do not add up."""


class RoundedWarning(CognateWarning):
    """An exact number had to be rounded to a double."""


TEXT = "text"
"""Name of a file that holds the user's own text. Messages give its line numbers."""

_PACKAGE = os.path.dirname(os.path.abspath(__file__)) + os.sep


def warn(message: str, category: type[CognateWarning]) -> None:
    """Issues a warning at the user's line that called this package."""
    # Level 1 is this function itself.
    level = 2
    frame = sys._getframe(1)
    while frame.f_back is not None and frame.f_code.co_filename.startswith(_PACKAGE):
        frame = frame.f_back
        level += 1
    warnings.warn(message, category, stacklevel=level)


def not_settled(message: str, found: object, strict: bool) -> None:
    """Reports an answer in doubt: raises `Unsettled` with the answer if `strict`, else warns."""
    if strict:
        raise Unsettled(message, found)
    warn(message, UnsettledWarning)


# FILE:LINE:COLUMN: [FIELD[, column COLUMN]: ]REASON
_PLACED = re.compile(
    r"(?P<file>[^\n]*?):(?P<line>\d+):(?P<column>\d+): "
    r"(?:(?P<field>(?:[A-Za-z_]+|\[\d+\])(?:\.[^:,.\[\]\n]+|\[\d+\])*)(?:, column (?P<within>\d+))?: )?"
    r"(?P<reason>.*)",
    re.DOTALL,
)
# cannot read FILE: REASON
_UNREADABLE = re.compile(r"cannot (?:read|write) (?P<file>[^\n]*): ")
# An option in a message of the command line's parser.
_OPTION = re.compile(r"'--(?P<option>[a-z-]+)[ =]?[^']*'")


def input_error(message: str, *, own: dict[str, str | None] | None = None) -> InputError:
    """An input error from the program's message.

    `own`: files written for the user's objects, each with the option that it belongs to, `TEXT`, or None.
    """
    own = own or {}
    placed = _PLACED.match(message)
    if placed is None:
        unreadable = _UNREADABLE.match(message)
        if unreadable is not None:
            return InputError(message[unreadable.end() :], file=unreadable["file"])
        option = _OPTION.search(message.splitlines()[0]) if message else None
        return InputError(
            in_the_users_words(message, own), field=option["option"].replace("-", "_") if option else None
        )
    file: str | None = placed["file"]
    line: int | None = int(placed["line"])
    column = int(placed["within"] or placed["column"])
    if file in own:
        reason = placed["reason"].splitlines()[0]
        if own[file] == TEXT:
            return InputError(reason, line=line, column=column, field=placed["field"])
        # The user has not seen this file, so its line numbers are left out.
        field = (own[file] or "") + (placed["field"] or "")
        return InputError(reason, column=column if placed["within"] else None, field=field or None)
    return InputError(placed["reason"], file=file, line=line, column=column, field=placed["field"])


def in_the_users_words(message: str, own: dict[str, str | None]) -> str:
    """The message, with the user's names in place of temporary file names."""
    for file, name in own.items():
        message = message.replace(file, name or "input")
    return message


def error_of(exit_code: int, message: str, *, own: dict[str, str | None] | None = None) -> CognateError:
    """The error for a command's exit code and message."""
    if exit_code == 2:
        return input_error(message, own=own)
    if exit_code == 4:
        return Cancelled(message)
    if message.startswith("no coordinator answers"):
        return Unreachable(message)
    return ServiceError(message or f"the program ended with exit code {exit_code} and without a word")
