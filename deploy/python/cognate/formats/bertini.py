"""Bertini's lists of points: `finite_solutions`, `start`, `start_parameters` and their like.

A list of points is their number, then for each an empty line and a line `RE IM` for each coordinate.
HomotopyContinuation.jl's `write_solutions` and `write_parameters` have the same format.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

from ..errors import InputError

MOST_DIGITS = 12
"""Digits of a number of points."""

Point = tuple[complex, ...]
"""One point, in the order of the variables."""


def read_points(text: str, *, file: str | None = None) -> list[Point]:
    """The points of a list; `file` is for messages.

    >>> read_points('''2
    ...
    ... 1.5 0
    ... 0 -1
    ...
    ... 2e0 0;
    ... 3 0;
    ... ''')
    [((1.5+0j), -1j), ((2+0j), (3+0j))]
    """
    lines = _numbered(text)
    count, line = _count(lines, file)
    coordinates = [(_coordinate(content, number, file), number) for number, content in lines]
    if count == 0 and not coordinates:
        return []
    if count == 0 or len(coordinates) % count != 0 or not coordinates:
        raise InputError(
            f"expected the coordinates of {count} points, found {len(coordinates)} lines", file=file, line=line
        )
    size = len(coordinates) // count
    values = [z for z, _ in coordinates]
    return [tuple(values[i : i + size]) for i in range(0, len(values), size)]


def write_points(points: Iterable[Sequence[complex]]) -> str:
    """A list of points, with every bit of their doubles.

    >>> write_points([(1.5, -1j)])
    '1\\n\\n1.5 0.0\\n-0.0 -1.0\\n\\n'
    """
    listed = [tuple(complex(z) for z in point) for point in points]
    sizes = {len(point) for point in listed}
    if len(sizes) > 1:
        raise InputError(f"expected points of one dimension, found {sorted(sizes)}")
    blocks = ["".join(f"{_line(z)}\n" for z in point) + "\n" for point in listed]
    return f"{len(listed)}\n\n" + "".join(blocks)


def read_parameters(text: str, *, file: str | None = None) -> Point:
    """Values of parameters: their number, then a line `RE IM` for each."""
    lines = _numbered(text)
    count, line = _count(lines, file)
    values = tuple(_coordinate(content, number, file) for number, content in lines)
    if len(values) != count:
        raise InputError(f"expected {count} parameters, found {len(values)}", file=file, line=line)
    return values


def write_parameters(values: Sequence[complex]) -> str:
    """Values of parameters, with every bit.

    >>> read_parameters(write_parameters([0.1, 2 - 1j]))
    ((0.1+0j), (2-1j))
    """
    listed = [complex(z) for z in values]
    return f"{len(listed)}\n\n" + "".join(f"{_line(z)}\n" for z in listed)


def _line(z: complex) -> str:
    return f"{z.real!r} {z.imag!r}"


def _numbered(text: str) -> Iterator[tuple[int, str]]:
    """Lines that are not empty, with their numbers."""
    lines = ((i + 1, line.strip().rstrip(";").strip()) for i, line in enumerate(text.splitlines()))
    return (pair for pair in lines if pair[1])


def _count(lines: Iterator[tuple[int, str]], file: str | None) -> tuple[int, int]:
    number, content = next(lines, (1, ""))
    if not content.isdecimal() or len(content) > MOST_DIGITS:
        raise InputError(f"expected the number of points, found {content[:40]!r}", file=file, line=number)
    return int(content), number


def _coordinate(content: str, number: int, file: str | None) -> complex:
    words = content.split()
    try:
        re, im = (float(word) for word in words)
        if not (math.isfinite(re) and math.isfinite(im)):
            raise ValueError(content)
    except ValueError as e:
        reason = f"expected a real and an imaginary part, found {content[:40]!r}"
        raise InputError(reason, file=file, line=number) from e
    return complex(re, im)
