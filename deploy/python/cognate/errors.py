"""What can go wrong, as exceptions, and what a person should know, as warnings.

The program says what is wrong in words with file, line, column and field; `error_of` turns them into
attributes.
"""

from __future__ import annotations

import os
import re
import sys
import warnings
from typing import Any


class CognateError(Exception):
    """Everything that this package raises by itself."""


class InputError(CognateError, ValueError):
    """A system, a file or an option is not what it should be.

    Attributes: `file` (None for what was given as Python objects), `line` and `column` (from 1), `field` (such
    as `equations[1]`, or the name of an option) and `reason`, what was expected and what was found. Each is
    None where it is not known. `column` counts in the field where there is one, else in the line.
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
    """The `cognate` program is nowhere."""


class ServiceError(CognateError):
    """The service gave up, or a part of it did not come up."""


class Unreachable(ServiceError):
    """No coordinator answers."""


class Cancelled(CognateError):
    """The job was cancelled."""


class NotKnown(CognateError):
    """A question that the service has not decided, such as what is real; the message says why."""


class Unsettled(CognateError):
    """Raised with `strict=True` where an answer is not settled; `result` is the answer as far as it goes.

    Of `solve` a `Result`, of `decompose` a `Decomposition`, of others what they would have given.
    """

    def __init__(self, message: str, result: Any) -> None:
        super().__init__(message)
        self.result = result

    def __reduce__(self) -> tuple[type[Unsettled], tuple[str, Any]]:
        return type(self), (str(self), self.result)


class CognateWarning(UserWarning):
    """What a person should know about an answer."""


class UnsettledWarning(CognateWarning):
    """An answer is not settled: paths failed, ends are undecided, or counts do not add up."""


class RoundedWarning(CognateWarning):
    """An exact number had to be rounded to a double."""


TEXT = "text"
"""What a file is called that holds a text of the user's, whose lines they know."""

_PACKAGE = os.path.dirname(os.path.abspath(__file__)) + os.sep


def warn(message: str, category: type[CognateWarning]) -> None:
    """A warning at the line of the user that called this package."""
    # Level 1 is this function itself.
    level = 2
    frame = sys._getframe(1)
    while frame.f_back is not None and frame.f_code.co_filename.startswith(_PACKAGE):
        frame = frame.f_back
        level += 1
    warnings.warn(message, category, stacklevel=level)


def not_settled(message: str, found: object, strict: bool) -> None:
    """Says that an answer is in doubt: by `Unsettled`, which carries it, where `strict`; else by a warning."""
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
# What the command line's own parser says of an option.
_OPTION = re.compile(r"'--(?P<option>[a-z-]+)[ =]?[^']*'")


def input_error(message: str, *, own: dict[str, str | None] | None = None) -> InputError:
    """An error of input from the program's words.

    `own`: files that were written for the user's objects, with the option that they are of, `TEXT`, or None.
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
        # Lines of a file that the user has never seen say nothing.
        field = (own[file] or "") + (placed["field"] or "")
        return InputError(reason, column=column if placed["within"] else None, field=field or None)
    return InputError(placed["reason"], file=file, line=line, column=column, field=placed["field"])


def in_the_users_words(message: str, own: dict[str, str | None]) -> str:
    """A message that names files of ours by what the user knows."""
    for file, name in own.items():
        message = message.replace(file, name or "input")
    return message


def error_of(exit_code: int, message: str, *, own: dict[str, str | None] | None = None) -> CognateError:
    """The error that a command ended with."""
    if exit_code == 2:
        return input_error(message, own=own)
    if exit_code == 4:
        return Cancelled(message)
    if message.startswith("no coordinator answers"):
        return Unreachable(message)
    return ServiceError(message or f"the program ended with exit code {exit_code} and without a word")
