"""Numbers as exact text, or as doubles if only doubles are accepted."""

from __future__ import annotations

import math
from decimal import Decimal
from fractions import Fraction
from numbers import Complex, Integral, Rational, Real

from .errors import InputError, RoundedWarning, warn

Number = int | float | complex | Fraction | Decimal
"""Accepted types of numbers, with numpy's types. A float is the decimal that Python shows for it."""


def text(value: object, field: str | None = None) -> str:
    """A number in the notation of our formats; a fraction stays a fraction.

    >>> from fractions import Fraction
    >>> text(Fraction(-2, 3)), text(0.1), text(1.5 - 2j), text(10**30)
    ('-2/3', '0.1', '(1.5-2.0*I)', '1000000000000000000000000000000')
    """
    if isinstance(value, bool):
        raise InputError(f"expected a number, found {value}", field=field)
    if isinstance(value, Decimal):
        if not value.is_finite():
            raise InputError(f"expected a finite number, found {value}", field=field)
        return format(value, "f")
    if isinstance(value, Integral):
        return _digits(int(value), field)
    if isinstance(value, Rational):
        return f"{_digits(int(value.numerator), field)}/{_digits(int(value.denominator), field)}"
    if isinstance(value, Real):
        number = float(value)
        if not math.isfinite(number):
            raise InputError(f"expected a finite number, found {number}", field=field)
        return repr(number)
    if isinstance(value, Complex):
        number_ = complex(value)
        re, im = text(number_.real, field), text(abs(number_.imag), field)
        sign = "-" if math.copysign(1.0, number_.imag) < 0 else "+"
        return f"({re}{sign}{im}*I)"
    raise InputError(f"expected a number, found {value!r}", field=field)


def _digits(value: int, field: str | None) -> str:
    try:
        return str(value)
    except ValueError as e:
        raise InputError(f"expected a number of fewer digits: {e}", field=field) from e


def double(value: object, field: str | None = None) -> complex:
    """A number as a double. The service holds parameters and starting points as doubles.

    Warns if an exact number is rounded.

    >>> double(3), double(0.5 + 1j)
    ((3+0j), (0.5+1j))
    """
    if _is_sympy(value):
        value = _from_sympy(value, field)
    if isinstance(value, bool) or not isinstance(value, (Complex, Decimal)):
        raise InputError(f"expected a number, found {value!r}", field=field)
    try:
        rounded = complex(value)
    except OverflowError as e:
        raise InputError(f"expected a number that a double can hold, found {value}", field=field) from e
    if not (math.isfinite(rounded.real) and math.isfinite(rounded.imag)):
        raise InputError(f"expected a finite number, found {value}", field=field)
    exact = isinstance(value, (Rational, Decimal))
    if exact and Fraction(rounded.real) != Fraction(str(value)):
        where = f" of {field}" if field else ""
        warn(
            f"the value {value}{where} is rounded to the double {rounded.real!r}; "
            "System.at() puts exact values into the equations",
            RoundedWarning,
        )
    return rounded


def _is_sympy(value: object) -> bool:
    return type(value).__module__.partition(".")[0] == "sympy"


def _from_sympy(value: object, field: str | None) -> object:
    """A number of sympy as a Python number."""
    import sympy

    if isinstance(value, sympy.Rational):
        return Fraction(int(value.p), int(value.q))
    try:
        return complex(value)  # type: ignore[call-overload]
    except TypeError as e:
        raise InputError(f"expected a number, found {value}", field=field) from e


def dyadic(value: str) -> Fraction:
    """The exact value of a number of a certificate, such as `-0x1p-296`.

    >>> dyadic("0x3p-2"), dyadic("-0x0p0")
    (Fraction(3, 4), Fraction(0, 1))
    """
    digits, mark, exponent = value.partition("p")
    if not mark:
        raise InputError(f"expected a number such as 0x3p-2, found {value!r}")
    mantissa, power = int(digits, 16), int(exponent)
    if abs(power) > 1_000_000:
        raise InputError(f"expected an exponent of at most a million, found {value!r}")
    return Fraction(mantissa) * (Fraction(2) ** power)
