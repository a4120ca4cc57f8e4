"""Converts expressions of sympy and plain text to text of our formats."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Iterator
from typing import Any

from . import exact
from .errors import InputError

RESERVED = frozenset({"I", "Pi", "sqrt", "exp", "log", "sin", "cos", "tan"})
"""Names with a fixed meaning."""

CALLED = frozenset({"abs", "cbrt", "cot", "sec", "csc"})
"""Functions of which the names are free without a bracket."""

# A superscript digit is a power in other programs, so it is not part of a name.
_LETTER = "[^\\W⁰¹²³⁴⁵⁶⁷⁸⁹]"
_NAME = re.compile(rf"(?!\d){_LETTER}+")
# Numbers are matched first, because the e of 1e-5 is not a name.
_NUMBER_OR_NAME = re.compile(r"(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|(?P<name>(?!\d)" + _LETTER + "+)")


def names(text: str) -> Iterator[str]:
    """The names in an expression, in order, as often as they occur.

    >>> list(names("2e3*x_1^2 - I*sin(y)"))
    ['x_1', 'y']
    """
    for match in _NUMBER_OR_NAME.finditer(text):
        name = match["name"]
        is_called = name in CALLED and text[match.end() :].lstrip().startswith("(")
        if name is not None and name not in RESERVED and not is_called:
            yield name


def is_sympy(value: object) -> bool:
    """True for an expression, an equation or a polynomial of sympy."""
    sympy = sys.modules.get("sympy")
    if sympy is None:
        return False
    return isinstance(value, (sympy.Basic, sympy.MatrixBase))


def listed(value: object, field: str) -> list[Any]:
    """A list from one object, a sequence or a matrix of sympy."""
    if is_sympy(value):
        import sympy

        return list(value) if isinstance(value, (sympy.MatrixBase, sympy.Tuple)) else [value]
    if isinstance(value, str):
        return [value]
    if callable(value):
        raise InputError(NO_FUNCTION, field=field)
    if not isinstance(value, Iterable):
        raise InputError(f"expected one or several, found {value!r}", field=field)
    return list(value)


# A line goes on inside brackets and behind an operator.
_BETWEEN_EQUATIONS = re.compile(r"(?:[,;]|(?<![-+*/^=(\s])[ \t\r]*\n)(?![^(\[]*[)\]])")


def equation_list(value: object, field: str) -> list[Any]:
    """Equations of one object or several; a text may hold several equations between commas, semicolons or lines.

    >>> equation_list("a = 1, b = 2", "equations")
    ['a = 1', 'b = 2']
    """
    found: list[Any] = []
    for each in listed(value, field):
        parts = _BETWEEN_EQUATIONS.split(each) if isinstance(each, str) else [each]
        found += [part.strip() for part in parts if part.strip()] if len(parts) > 1 else parts
    return found


NO_FUNCTION = (
    "a function of Python cannot be looked into; write the equations as text, such as 'x^2 + y^2 = 4', or call the "
    "function with symbols of sympy: x, y = sympy.symbols('x y'); cognate.solve(f(x, y))"
)
"""Message for a callable in place of equations."""


def equation(value: object, field: str) -> str:
    """An equation as the expression that must be 0.

    >>> equation("x^2 = 2*y", "equations[0]")
    '(x^2)-(2*y)'
    """
    relation = str(value) if isinstance(value, str) or getattr(value, "is_Relational", False) else ""
    if re.search("[<>≤≥]", relation):
        raise InputError(f"expected an equation, found {relation}; conditions on solutions are where=", field=field)
    if isinstance(value, str):
        return _without_equals_sign(value, field)
    if is_sympy(value):
        return from_sympy(value, field)
    if callable(value):
        raise InputError(NO_FUNCTION, field=field)
    return exact.text(value, field)


def expression(value: object, field: str) -> str:
    """An expression as text."""
    if isinstance(value, str):
        return value
    if is_sympy(value):
        return from_sympy(value, field)
    return exact.text(value, field)


def name(value: object, field: str) -> str:
    """The name of a variable or parameter: a word, or a symbol of sympy."""
    if is_sympy(value):
        value = getattr(value, "name", None) or str(value)
    if not isinstance(value, str) or not _NAME.fullmatch(value):
        raise InputError(f"expected a name of letters, digits and _, found {value!r}", field=field)
    if value in RESERVED:
        raise InputError(f"the name {value} means something by itself", field=field)
    return value


def name_list(values: object, field: str) -> tuple[str, ...]:
    """Names from "x, y z" or from a sequence of words or symbols; no name twice."""
    if isinstance(values, str):
        values = values.replace(",", " ").split()
    found = tuple(name(value, f"{field}[{i}]") for i, value in enumerate(listed(values, field)))
    for i, one in enumerate(found):
        if one in found[:i]:
            raise InputError(f"the name {one} stands there twice", field=f"{field}[{i}]")
    return found


_SYMBOLS = re.compile(r"[\w\s+\-*/^().,]*")
# A point beside a letter or a bracket would be attribute access in Python.
_ATTRIBUTE = re.compile(rf"(?:{_LETTER}(?<!\d)|\))\s*\.|\.\s*(?!\d){_LETTER}")


def to_sympy(text: str, symbols: dict[str, Any], field: str) -> Any:
    """An expression as a sympy expression. `symbols`: meanings of the names. Decimals become fractions."""
    import sympy

    unknown = [each for each in names(text) if each not in symbols]
    if unknown or not _SYMBOLS.fullmatch(text) or _ATTRIBUTE.search(_NUMBER_OR_NAME.sub(_plain_name, text)):
        raise InputError(f"expected an expression in {', '.join(symbols)}, found {text!r}", field=field)
    try:
        return sympy.sympify(text, locals={"Pi": sympy.pi, **symbols}, convert_xor=True, rational=True)
    except (sympy.SympifyError, SyntaxError, TypeError) as e:
        raise InputError(f"sympy cannot read {text!r}", field=field) from e


def _plain_name(match: re.Match[str]) -> str:
    """Replaces a number by 0 and keeps a name. The remaining points are then no decimal points."""
    return match["name"] or "0"


def _without_equals_sign(text: str, field: str) -> str:
    sides = re.split("==?", text)
    if len(sides) == 1:
        return text
    if len(sides) > 2 or not all(side.strip() for side in sides):
        raise InputError(f"expected at most one = between two expressions, found {text!r}", field=field)
    left, right = (side.strip() for side in sides)
    return left if right == "0" else f"({left})-({right})"


def check_symbols(values: Iterable[object]) -> None:
    """Refuses two unequal symbols of sympy with the same name. Text would make one symbol of them."""
    found: dict[str, Any] = {}
    for value in values:
        if not is_sympy(value):
            continue
        for symbol in getattr(value, "free_symbols", ()):
            other = found.setdefault(str(symbol), symbol)
            if other != symbol:
                raise InputError(
                    "two symbols of this name differ, by their assumptions for instance", field=str(symbol)
                )


def from_sympy(value: Any, field: str) -> str:
    """An expression, equation or polynomial of sympy as text; rational numbers stay exact."""
    import sympy

    if isinstance(value, sympy.Equality):
        return from_sympy(value.lhs - value.rhs, field)
    if isinstance(value, sympy.Poly):
        return from_sympy(value.as_expr(), field)
    if not isinstance(value, sympy.Expr):
        raise InputError(f"expected an expression, found {value}", field=field)
    for symbol in sorted(value.free_symbols, key=str):
        name(symbol, field)
    return str(_printer(field).doprint(value))


def condition(value: object, field: str) -> str:
    """A condition as text: text, or a relation of sympy such as `x > 0`."""
    if isinstance(value, str):
        return value
    if not is_sympy(value):
        raise InputError(f"expected a condition such as 'x > 0', found {value!r}", field=field)
    import sympy

    if isinstance(value, sympy.Eq):
        return f"{expression(value.lhs, field)} = {expression(value.rhs, field)}"
    if isinstance(value, sympy.core.relational.Relational):
        return f"{expression(value.lhs, field)} {value.rel_op} {expression(value.rhs, field)}"
    raise InputError(f"expected a condition such as 'x > 0', found {value!r}", field=field)


def _printer(field: str) -> Any:
    import sympy
    from sympy.printing.str import StrPrinter

    class Printer(StrPrinter):  # type: ignore[misc]
        """Changes sympy's text where our formats have another notation."""

        def _print_Pi(self, _expression: Any) -> str:
            return "Pi"

        def _print_Exp1(self, _expression: Any) -> str:
            return "exp(1)"

        def _print_Abs(self, absolute: Any) -> str:
            return f"abs({self._print(absolute.args[0])})"

        def _print_Float(self, number: Any) -> str:
            # A double is written as Python shows it; a longer number with all its bits.
            shown = float(number)
            if number._prec <= 53 and number == shown:
                return exact.text(shown, field)
            fraction = sympy.Rational(number)
            return f"({fraction.p}/{fraction.q})"

        def _print_Pow(self, power: Any, rational: bool = False) -> str:
            exponent = power.exp
            if not exponent.is_Rational:
                raise InputError(f"expected a rational exponent, found {exponent}", field=field)
            return str(super()._print_Pow(power, rational=rational))

        def emptyPrinter(self, expr: Any) -> str:
            raise InputError(f"expected polynomials, found {type(expr).__name__}", field=field)

    return Printer()
