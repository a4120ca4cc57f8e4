"""Text of Julia for HomotopyContinuation.jl: `@var` lines, assignments and one `System`.

What is read is this subset, and no more of Julia:

    using HomotopyContinuation
    @var x y z[1:3] p
    f = x^2 + 2y - 1//3
    F = System([f, x*y - p]; variables = [x, y], parameters = [p])

Names like `x₁`, which `@var x[1:3]` makes, are read and written as `x1`. A list of solutions has Bertini's format
(`write_solutions` there, `formats.bertini` here).
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..errors import InputError

if TYPE_CHECKING:
    from ..system import System

_SUBSCRIPTS = str.maketrans("₀₁₂₃₄₅₆₇₈₉₋", "0123456789_")

_FUNCTIONS = ("sqrt", "exp", "log", "sin", "cos", "tan")
"""Functions that our notation has, too; of constants only."""

_TOKEN = re.compile(
    r"(?P<space>[ \t\r]+|#[^\n]*)"
    r"|(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)"
    r"|(?P<name>[^\W\d][\w₋]*)"
    r"|(?P<symbol>//|\.\.|[-+*/^()\[\],;=:@\n])"
)

MOST_INDICES = 100_000
"""Variables of one `@var x[1:n]`."""


@dataclass(frozen=True)
class _Token:
    kind: str
    text: str
    line: int
    column: int
    # Whether the token before it touches it: `2x` is a product, `2 x` is none.
    touches: bool


def _tokens(text: str) -> list[_Token]:
    found: list[_Token] = []
    at, line, begin, touches = 0, 1, 0, False
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None:
            raise InputError(
                f"expected Julia's numbers, names and operators, found {text[at]!r}",
                line=line,
                column=at - begin + 1,
            )
        kind = match.lastgroup or ""
        if kind != "space":
            found.append(_Token(kind, match[0], line, at - begin + 1, touches))
        touches = kind != "space"
        at = match.end()
        if match[0] == "\n":
            line, begin = line + 1, at
    found.append(_Token("end", "the end", line, at - begin + 1, False))
    return found


class _Reader:
    """Statements of the text, one after the other."""

    def __init__(self, text: str) -> None:
        self.tokens = _tokens(text)
        self.at = 0
        self.variables: dict[str, None] = {}
        self.families: dict[str, list[str]] = {}
        self.definitions: dict[str, str] = {}
        self.vectors: dict[str, list[str]] = {}

    @property
    def token(self) -> _Token:
        return self.tokens[self.at]

    def wrong(self, expected: str) -> InputError:
        token = self.token
        found = "the end of the line" if token.text == "\n" else token.text
        return InputError(f"expected {expected}, found {found!r}", line=token.line, column=token.column)

    def is_symbol(self, text: str) -> bool:
        return self.token.kind == "symbol" and self.token.text == text

    def take(self, text: str) -> None:
        if not self.is_symbol(text):
            raise self.wrong(f"`{text}`")
        self.at += 1

    def skip_lines(self) -> None:
        while self.is_symbol("\n") or self.is_symbol(";"):
            self.at += 1

    def end_of_statement(self) -> None:
        if self.token.kind != "end" and not self.is_symbol("\n") and not self.is_symbol(";"):
            raise self.wrong("the end of the statement")

    def name(self) -> str:
        if self.token.kind != "name":
            raise self.wrong("a name")
        self.at += 1
        return self.tokens[self.at - 1].text.translate(_SUBSCRIPTS)

    def system(self) -> System:
        while True:
            self.skip_lines()
            if self.token.kind == "end":
                raise self.wrong("a `System`")
            if self.is_symbol("@"):
                self.at += 1
                self.declarations()
                continue
            name = self.name()
            if name in ("using", "import"):
                while self.token.kind != "end" and not self.is_symbol("\n"):
                    self.at += 1
                continue
            if name == "System":
                return self.call()
            self.take("=")
            if self.token.kind == "name" and self.token.text == "System":
                self.at += 1
                return self.call()
            if self.is_symbol("["):
                self.vectors[name] = self.expressions()
            else:
                self.define(name)
            self.end_of_statement()

    def define(self, name: str) -> None:
        if name in self.variables or name in self.definitions:
            raise self.wrong(f"a name other than {name}, which is in use")
        self.definitions[name] = self.expression()

    def declarations(self) -> None:
        if self.name() not in ("var", "polyvar"):
            raise self.wrong("`@var`")
        while self.token.kind == "name":
            name = self.name()
            members = [name]
            if self.is_symbol("["):
                members = [name + index for index in self.indices()]
                self.families[name] = members
            for member in members:
                if member in self.variables:
                    raise InputError(f"the name {member} is declared twice", line=self.token.line)
                self.variables[member] = None
        self.end_of_statement()

    def indices(self) -> list[str]:
        """`[1:3]`, or `[1:2, 1:2]`, of which the first index runs first."""
        self.take("[")
        found = [""]
        while True:
            low = self.integer()
            self.take(":")
            high = self.integer()
            if (high - low + 1) * len(found) > MOST_INDICES:
                raise self.wrong(f"at most {MOST_INDICES} variables")
            more = [str(i) for i in range(low, high + 1)]
            # x[1,2] is shown as `x₁₋₂` there: no x[12].
            found = [f"{a}_{b}" if a else b for b in more for a in found]
            if self.is_symbol("]"):
                self.at += 1
                return found
            self.take(",")

    def integer(self) -> int:
        if self.token.kind != "number" or not self.token.text.isdecimal() or len(self.token.text) > 9:
            raise self.wrong("a whole number")
        self.at += 1
        return int(self.tokens[self.at - 1].text)

    def call(self) -> System:
        from ..system import System

        self.take("(")
        self.blank()
        if self.token.kind == "name" and self.token.text in self.vectors:
            equations = self.vectors[self.name()]
        else:
            equations = self.expressions()
        options: dict[str, list[list[str]]] = {}
        self.blank()
        while self.is_symbol(";") or self.is_symbol(","):
            self.at += 1
            self.blank()
            if self.is_symbol(")"):
                break
            token = self.token
            option = self.name()
            if option not in ("variables", "parameters", "variable_groups"):
                raise InputError(
                    f"expected variables, parameters or variable_groups, found {option}",
                    line=token.line,
                    column=token.column,
                )
            self.take("=")
            options[option] = self.groups() if option == "variable_groups" else [self.names()]
            self.blank()
        self.take(")")
        parameters = options.get("parameters", [[]])[0]
        groups = options.get("variable_groups")
        if "variables" in options:
            variables = options["variables"][0]
        elif groups is not None:
            variables = [name for group in groups for name in group]
        else:
            # Without a list HomotopyContinuation.jl takes all that occur, sorted by name.
            variables = sorted(self.occurring(equations) - set(parameters))
        return System(equations, variables, parameters=parameters, groups=groups, definitions=self.needed(equations))

    def occurring(self, equations: list[str]) -> set[str]:
        from .. import expressions

        needed = self.needed(equations)
        texts = [*equations, *needed.values()]
        return {name for text in texts for name in expressions.names(text) if name in self.variables}

    def needed(self, equations: list[str]) -> dict[str, str]:
        """The definitions that occur, also within others."""
        from .. import expressions

        found: set[str] = set()
        open_texts = list(equations)
        while open_texts:
            for name in expressions.names(open_texts.pop()):
                if name in self.definitions and name not in found:
                    found.add(name)
                    open_texts.append(self.definitions[name])
        return {name: text for name, text in self.definitions.items() if name in found}

    def blank(self) -> None:
        while self.is_symbol("\n"):
            self.at += 1

    def names(self) -> list[str]:
        """`[x, y]`, or the name of a family."""
        if self.token.kind == "name" and self.token.text in self.families:
            return self.families[self.name()]
        self.take("[")
        found: list[str] = []
        while True:
            self.blank()
            if self.is_symbol("]"):
                self.at += 1
                return found
            name = self.name()
            if self.is_symbol("["):
                self.at += 1
                name = self.element(name)
            found += self.families.get(name, [name])
            self.blank()
            if self.is_symbol(",") or self.is_symbol(";"):
                self.at += 1

    def element(self, name: str) -> str:
        """`x[3]`, behind its opening bracket."""
        index = str(self.integer())
        while self.is_symbol(","):
            self.at += 1
            index += f"_{self.integer()}"
        self.take("]")
        if name + index not in self.variables:
            raise self.wrong(f"a declared variable instead of {name}[{index}]")
        return name + index

    def groups(self) -> list[list[str]]:
        self.take("[")
        found: list[list[str]] = []
        while True:
            self.blank()
            if self.is_symbol("]"):
                self.at += 1
                return found
            found.append(self.names())
            self.blank()
            if self.is_symbol(","):
                self.at += 1

    def expressions(self) -> list[str]:
        self.take("[")
        found: list[str] = []
        while True:
            self.blank()
            if self.is_symbol("]"):
                self.at += 1
                return found
            found.append(self.expression())
            self.blank()
            if self.is_symbol(","):
                self.at += 1
            elif not self.is_symbol("]"):
                raise self.wrong("`,` or `]`")

    def expression(self) -> str:
        """The text of an expression in our notation, up to what cannot belong to it."""
        parts: list[str] = []
        depth = 0
        begin = self.at
        while True:
            token = self.token
            before = self.tokens[self.at - 1] if self.at > begin else None
            if token.kind == "end":
                break
            if token.kind == "symbol":
                if token.text == "(":
                    depth += 1
                    if before is None or before.text not in _FUNCTIONS:
                        parts += self.product(before)
                elif token.text == ")":
                    if depth == 0:
                        break
                    depth -= 1
                elif token.text == "\n":
                    # A line goes on in brackets, and behind an operator.
                    if depth == 0 and (before is None or before.text not in ("+", "-", "*", "/", "//", "^", "\n")):
                        break
                    self.at += 1
                    continue
                elif token.text == "//":
                    # Julia binds // tighter than * and /, which a text in our notation would not.
                    self.fraction(parts, before)
                    continue
                elif token.text not in ("+", "-", "*", "/", "^"):
                    break
                parts.append(token.text)
            elif token.kind == "number":
                if before is not None and (before.kind != "symbol" or before.text == ")"):
                    raise self.wrong("an operator")
                parts.append(token.text)
            else:
                parts += self.product(before)
                parts.append(self.atom(token))
                continue
            self.at += 1
        if depth > 0:
            raise self.wrong("`)`")
        if not parts:
            raise self.wrong("an expression")
        return "".join(parts)

    def atom(self, token: _Token) -> str:
        self.at += 1
        name = token.text.translate(_SUBSCRIPTS)
        if name == "im":
            return "I"
        if name in ("pi", "π"):
            return "Pi"
        if self.is_symbol("[") and self.token.touches and name in self.families:
            self.at += 1
            return self.element(name)
        return name

    def product(self, before: _Token | None) -> list[str]:
        """The `*` that `2x` and `2(x+1)` leave out; refused where Julia or our notation read it otherwise."""
        if before is None or (before.kind == "symbol" and before.text != ")"):
            return []
        if before.kind != "number" or not self.token.touches:
            raise self.wrong("an operator")
        # 1/2x is 1/(2x) and 2^3x is 2^(3x) in Julia, and 0x1 is a number.
        earlier = self.tokens[self.at - 2].text
        if earlier in ("/", "//", "^") or (before.text == "0" and self.token.text[0] in "xob"):
            raise self.wrong(f"`*` behind `{before.text}`")
        return ["*"]

    def fraction(self, parts: list[str], before: _Token | None) -> None:
        following = self.tokens[self.at + 1]
        after = self.tokens[self.at + 2].text if self.at + 2 < len(self.tokens) else ""
        earlier = self.tokens[self.at - 2].text if self.at >= 2 else ""
        whole = before is not None and before.text.isdecimal() and following.text.isdecimal()
        if not whole or earlier in ("^", "//") or after in ("^", "//"):
            raise self.wrong("`//` between whole numbers, in brackets where it stands beside ^ or //")
        parts.append("(" + parts.pop() + "/" + following.text + ")")
        self.at += 2


def read(text: str) -> System:
    """A system from text of Julia.

    >>> system = read('''
    ... @var x y p
    ... F = System([x^2 + 2y - 1//3, x*y - p]; variables = [x, y], parameters = [p])
    ... ''')
    >>> system.equations, system.parameters
    (('x^2+2*y-(1/3)', 'x*y-p'), ('p',))
    """
    return _Reader(text).system()


def write(system: System) -> str:
    """A system as text of Julia; whole numbers in quotients and decimals are written as exact fractions.

    >>> import cognate as cg
    >>> print(write(cg.System(["x^2 - 0.5*y", "x*y/3 - I"])), end="")
    using HomotopyContinuation
    @var x y
    F = System([
        x^2-(5//10)*y,
        x*y/(3//1)-im,
    ]; variables = [x, y])
    """
    if system.path_variable is not None:
        raise InputError("a homotopy with a path variable has no words in HomotopyContinuation.jl's notation")
    lines = ["using HomotopyContinuation", "@var " + " ".join((*system.variables, *system.parameters))]
    lines += [f"{name} = {_julia(text, f'definitions.{name}')}" for name, text in _ordered(system)]
    lines.append("F = System([")
    lines += [f"    {_julia(text, f'equations[{i}]')}," for i, text in enumerate(system.equations)]
    options = []
    if system.groups is not None and len(system.groups) > 1:
        groups = ", ".join("[" + ", ".join(group) + "]" for group in system.groups)
        options.append(f"variable_groups = [{groups}]")
    else:
        options.append("variables = [" + ", ".join(system.variables) + "]")
    if system.parameters:
        options.append("parameters = [" + ", ".join(system.parameters) + "]")
    lines.append(f"]; {', '.join(options)})")
    return "\n".join(lines) + "\n"


def _ordered(system: System) -> Iterator[tuple[str, str]]:
    """Definitions, each behind those that it uses: Julia runs them in their order."""
    from .. import expressions

    waiting = dict(system.definitions)
    while waiting:
        ready = [
            name for name, text in waiting.items() if not any(other in waiting for other in expressions.names(text))
        ]
        if not ready:
            raise InputError("these definitions use one another in a circle", field="definitions")
        for name in ready:
            yield name, waiting.pop(name)


_PIECE = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)|(?P<name>[^\W\d]\w*)|(?P<symbol>\*\*|.))\s*"
)


def _julia(text: str, field: str) -> str:
    """An expression in Julia's notation, of the same exact value."""
    pieces = [(m.lastgroup or "", m[m.lastgroup or 0]) for m in _PIECE.finditer(text)]
    # Whole numbers are of 64 bits there, and 1/3 of them is a float: as fractions they stay exact, or overflow aloud.
    digits = sum(len(piece) for kind, piece in pieces if kind == "number")
    fractions = digits > 18 or any(piece in ("/", "^", "**") for _, piece in _behind_numbers(pieces))
    found: list[str] = []
    for i, (kind, piece) in enumerate(pieces):
        before = found[-1] if found else ""
        if kind == "number":
            if before == "^" or (before in ("-", "+") and len(found) > 1 and found[-2] == "^"):
                if not piece.isdecimal():
                    raise InputError(f"expected a whole exponent, found {piece}", field=field)
                found.append(piece)
            elif not piece.isdecimal():
                found.append(_fraction(piece))
            else:
                found.append(f"({piece}//1)" if fractions else piece)
        elif kind == "name":
            found.append({"I": "im", "Pi": "pi"}.get(piece, piece))
        else:
            found.append("^" if piece == "**" else piece)
            if piece in ("^", "**") and i + 1 < len(pieces) and pieces[i + 1][1] == "(":
                raise InputError("expected a whole number as exponent, without brackets", field=field)
    return "".join(found)


def _behind_numbers(pieces: list[tuple[str, str]]) -> Iterator[tuple[str, str]]:
    """What stands between a number or a bracket and what follows it, and every quotient."""
    for before, piece in itertools.pairwise(pieces):
        if piece[1] == "/" or before[0] == "number" or before[1] == ")":
            yield piece


def _fraction(decimal: str) -> str:
    """A decimal as a fraction of Julia: 0.25e-1 is 25//1000."""
    mantissa, _, exponent = decimal.lower().partition("e")
    whole, _, places = mantissa.partition(".")
    power = int(exponent or 0) - len(places)
    if abs(power) > 1000:
        raise InputError(f"expected an exponent of at most a thousand, found {decimal}")
    digits = (whole + places).lstrip("0") or "0"
    if power >= 0:
        return f"({digits + '0' * power}//1)"
    return f"({digits}//1{'0' * -power})"
