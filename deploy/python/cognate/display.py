"""Tables of a result: as text, and as HTML for notebooks."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .result import Result, _Answer
    from .solution import Solution

SOLUTIONS_SHOWN = 10
"""Most solutions in a table; the result has all solutions."""

VARIABLES_SHOWN = 6
"""Most columns of coordinates in a table."""

DECOMPOSE = "cognate.decompose(..), or `cognate decompose FILE`,"
"""Name, for messages, of the function and command that find sets of solutions."""


def verdict(result: _Answer) -> str:
    """The answer in one line."""
    counts = result.counts
    on_sets = counts.positive_dimensional or bool(result.paths.positive_dimensional)
    if on_sets and counts.distinct == 0 and counts.undecided == 0:
        return f"no isolated solution, but a positive-dimensional solution set: {DECOMPOSE} finds it"
    line = f"{counts.distinct} solution{'s' if counts.distinct != 1 else ''}"
    if counts.real is not None:
        line += f", {counts.real} real"
    if counts.singular:
        line += f", {counts.singular} singular"
    if counts.certified is not None:
        line += f", {counts.certified} proved"
    if counts.undecided:
        line += f", and {counts.undecided} undecided point{'s' if counts.undecided != 1 else ''}"
    if on_sets:
        line += ", and a positive-dimensional set"
    return line


def coordinate(z: complex) -> str:
    """A coordinate to six digits."""
    return f"{z.real:.6g}{z.imag:+.6g}i"


def kind(solution: Solution) -> str:
    """The kind of a solution, in a word or two."""
    words = [{True: "real", False: "complex", None: "not decided"}[solution.real]]
    if solution.singular:
        words.append("singular")
    return ", ".join(words)


def _rows(result: Result) -> list[list[str]]:
    names = result.variables[:VARIABLES_SHOWN]
    return [
        [str(i + 1), kind(s), *(coordinate(s[name]) for name in names)]
        for i, s in enumerate(result.solutions[:SOLUTIONS_SHOWN])
    ]


def _head(result: Result) -> list[str]:
    return ["#", "kind", *result.variables[:VARIABLES_SHOWN]]


def _more(result: Result) -> str | None:
    hidden = len(result.solutions) - SOLUTIONS_SHOWN
    columns = len(result.variables) - VARIABLES_SHOWN
    words = [f"{hidden} more solutions"] if hidden > 0 else []
    words += [f"{columns} more variables"] if columns > 0 else []
    return " and ".join(words) or None


def text_table(result: Result) -> str:
    """A table of text."""
    lines = [verdict(result), f"{result.start} start, seed {result.seed}, {result.seconds:.3g} s"]
    lines += [f"not settled: {question}" for question in result.open_questions]
    lines.append("")
    for name, count in (*result.paths.classes.items(), ("total", result.paths.total)):
        shown = "not decided" if count is None else str(count)
        lines.append(f"  {name.replace('_', ' '):<22}{shown:>8}")
    rows = [_head(result), *_rows(result)]
    if len(rows) > 1:
        widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
        lines.append("")
        lines += ["  " + "  ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)).rstrip() for row in rows]
    more = _more(result)
    if more:
        lines.append(f"  and {more}")
    return "\n".join(lines)


def html_table(result: Result) -> str:
    """The same table as HTML, without own scripts and styles."""
    parts = [f"<p><b>{escape(verdict(result))}</b><br>"]
    parts.append(f"{escape(result.start)} start, seed {result.seed}, {result.seconds:.3g} s</p>")
    if result.open_questions:
        items = "".join(f"<li>{escape(q)}</li>" for q in result.open_questions)
        parts.append(f"<p><b>Not settled:</b></p><ul>{items}</ul>")
    parts.append("<table><caption>Paths</caption><tbody>")
    for name, count in (*result.paths.classes.items(), ("total", result.paths.total)):
        shown = "not decided" if count is None else str(count)
        parts.append(f"<tr><th scope='row'>{escape(name.replace('_', ' '))}</th><td>{shown}</td></tr>")
    parts.append("</tbody></table>")
    rows = _rows(result)
    if rows:
        head = "".join(f"<th scope='col'>{escape(name)}</th>" for name in _head(result))
        body = "".join("<tr>" + "".join(f"<td>{escape(c)}</td>" for c in row) + "</tr>" for row in rows)
        parts.append(f"<table><caption>Solutions</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>")
    more = _more(result)
    if more:
        parts.append(f"<p>and {escape(more)}</p>")
    return "".join(parts)
