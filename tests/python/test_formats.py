"""Files and objects of other programs, there and back."""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import numpy
import pytest

import cognate as cg
from cognate.formats import bertini, homotopy_continuation, phcpack, phcpy
from conftest import EXAMPLES

SYSTEMS = sorted(EXAMPLES.glob("*.bertini"))


@pytest.fixture(scope="module")
def solved() -> cg.Result:
    return cg.solve(["x^2 + y^2 - 4", "x*y - 1/3"])


def same_answer(a: cg.System, b: cg.System) -> bool:
    """True if the program's digests of two systems are equal."""
    first, second = (cg.solve(s, seed=1) for s in (a, b))
    return (
        first.summary["problem"]["digest"] == second.summary["problem"]["digest"]
        and first.solutions == second.solutions
    )


@pytest.mark.parametrize("path", SYSTEMS, ids=lambda p: p.stem)
def test_every_example_there_and_back(path: Path) -> None:
    system = cg.System.read(path)
    assert cg.System.from_json(system.to_json()) == system
    again = cg.System.from_text(system.to_bertini())
    assert (again.variables, again.groups, len(again.equations)) == (
        system.variables,
        system.groups,
        len(system.equations),
    )
    assert cg.System.from_text(again.to_bertini()) == again
    assert cg.System.from_homotopy_continuation(system.to_homotopy_continuation()).variables == system.variables


@pytest.mark.parametrize("notation", ["json", "bertini", "phcpack", "homotopy-continuation"])
def test_a_system_is_the_same_in_every_notation(notation: str, tmp_path: Path) -> None:
    system = cg.System(
        ["x^2*y - 1/3*x + 7/2*y^3 - 0.25", "(x + 2*y)^3 - (1 - 2*I)*x - 5", "z*x - 10^3 + 2/7*z^2"], "z x y"
    )
    path = tmp_path / "file"
    system.write(path, notation)
    if notation == "homotopy-continuation":
        again = cg.System.from_homotopy_continuation(path.read_text())
    else:
        again = cg.System.read(path)
    assert again.variables == ("z", "x", "y")
    # Sums may have another order, so the test compares points and not digests.
    first, second = (sorted_points(cg.solve(s, digits=20)) for s in (system, again))
    assert len(first) == 18 == len(second)
    assert numpy.allclose(first, second, rtol=1e-12, atol=1e-13)


def sorted_points(found: cg.Result) -> list[tuple[complex, ...]]:
    return sorted(
        (s.coordinates for s in found.solutions),
        key=lambda p: [(round(z.real, 8), round(z.imag, 8)) for z in p],
    )


def test_what_a_notation_cannot_say(solved: cg.Result) -> None:
    family = cg.System(["x^2 - p", "y - x"], parameters="p", conjugates=[("x", "y")])
    with pytest.raises(cg.InputError, match="parameters"):
        family.to_phcpack()
    with pytest.warns(cg.CognateWarning, match="conjugates are left out"):
        assert "parameter p" in family.to_bertini()
    grouped = cg.System(["x*y - 1", "x + y - 3"], groups=[["x"], ["y"]])
    with pytest.warns(cg.CognateWarning, match="groups are left out"):
        grouped.to_phcpack()
    with pytest.raises(cg.InputError) as raised:
        grouped.write("nowhere", "macaulay3")
    assert raised.value.field == "notation"
    with pytest.raises(cg.InputError) as raised:
        cg.System.from_json({"variables": ["x"]})
    with pytest.raises(cg.InputError) as raised:
        cg.System.from_json('{"variables": [x]}')
    assert raised.value.line == 1


def test_decimals_that_count_as_rounded_are_named() -> None:
    with pytest.warns(cg.CognateWarning, match="count as rounded"):
        assert "123456789" in cg.System.from_text("1\nx - 1.23456789;\n").equations[0]


def test_points_of_bertini_there_and_back(solved: cg.Result, tmp_path: Path) -> None:
    points = [s.coordinates for s in solved.solutions]
    assert bertini.read_points(bertini.write_points(points)) == points
    # A file that the program writes for users of Bertini.
    again = cg.solve(["x^2 + y^2 - 4", "x*y - 1/3"], output=tmp_path / "out")
    assert bertini.read_points((tmp_path / "out" / "finite_solutions").read_text()) == points
    assert again.solutions == solved.solutions
    assert bertini.read_points("0\n") == []
    values = [complex(random.Random(3).random(), -1e-300)]
    assert list(bertini.read_parameters(bertini.write_parameters(values))) == values


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("x\n", 1),
        ("2\n\n1 0\n", 1),
        ("2\n\n1 0\n2 0\n3 0\n", 1),
        ("1\n\n1 zero\n", 3),
        ("1\n\n1\n", 3),
        ("1\n", 1),
    ],
)
def test_wrong_points_of_bertini(text: str, line: int) -> None:
    with pytest.raises(cg.InputError) as raised:
        bertini.read_points(text, file="finite_solutions")
    assert (raised.value.file, raised.value.line) == ("finite_solutions", line)


def test_solutions_of_phcpack_there_and_back(solved: cg.Result, tmp_path: Path) -> None:
    text = phcpack.write_solutions(solved.solutions)
    again = phcpack.read_solutions(text)
    assert [s.coordinates for s in again] == [s.coordinates for s in solved.solutions]
    assert [s.names for s in again] == [("x", "y")] * 4
    assert phcpack.read_solutions(phcpack.write_solutions(again)) == again
    # The program accepts this list as start solutions.
    family = cg.System(["x^2 + y^2 - p", "x*y - 1/3"], parameters="p")
    file = tmp_path / "starts.phc"
    file.write_text(text)
    found = cg.solve(family, start_solutions=file, start_parameters=[4], targets=[5])
    assert found.counts.distinct == 4 and found.settled


def test_wrong_solutions_of_phcpack(solved: cg.Result) -> None:
    text = phcpack.write_solutions(solved.solutions)
    lines = text.splitlines()
    for wrong, line in (
        ("\n".join(lines[:11]), 2),
        (text.replace("m : 1", "m : one", 1), 6),
        (text.replace(" x :", " x =", 1), 8),
    ):
        with pytest.raises(cg.InputError) as raised:
            phcpack.read_solutions(wrong, file="list")
        assert raised.value.file == "list" and raised.value.line == line


def test_phcpy_there_and_back(solved: cg.Result) -> None:
    system = cg.System(["x^2 + y^2 - 4", "x*y - 1/3"])
    polynomials = system.to_phcpy()
    assert len(polynomials) == 2 and all(p.endswith(";") for p in polynomials)
    assert same_answer(cg.System.from_phcpy(polynomials), cg.System.from_phcpy(polynomials))
    assert cg.System.from_phcpy(polynomials).variables == ("x", "y")
    solution = solved.solutions[0]
    found = phcpy.dictionary(solution)
    assert set(found) == {"x", "y", "t", "m", "err", "rco", "res"} and found["x"] == solution["x"]
    assert phcpy.dictionary(phcpy.from_dictionary(found)) == found
    text = phcpy.string(solution)
    assert phcpy.from_string(text).coordinates == solution.coordinates
    assert phcpy.string(phcpy.from_string(text)) == text
    with pytest.raises(cg.InputError) as raised:
        phcpy.file_text(["x - 1"])
    assert raised.value.field == "[0]"
    with pytest.raises(cg.InputError):
        phcpy.from_string("nothing")


@pytest.mark.parametrize("what", ["bertini", "phcpack", "phcpy", "julia", "json"])
def test_broken_texts_are_refused_or_read(what: str, solved: cg.Result) -> None:
    """Texts with cuts, copies and other characters either are read or raise `InputError`."""
    readers: dict[str, tuple[str, Callable[[str], object]]] = {
        "bertini": (bertini.write_points([s.coordinates for s in solved.solutions]), bertini.read_points),
        "phcpack": (phcpack.write_solutions(solved.solutions), phcpack.read_solutions),
        "phcpy": (phcpy.string(solved.solutions[0]), phcpy.from_string),
        "julia": (JULIA, homotopy_continuation.read),
        "json": (cg.System(["x^2 - p", "y - x"], parameters="p").to_json(), cg.System.from_json),
    }
    text, read = readers[what]
    chance = random.Random(5)
    refused = 0
    for _ in range(1500):
        at, size = chance.randrange(len(text)), chance.choice([1, 1, 2, 8, 60])
        put = chance.choice(["", "x", "9" * 5000, "-", "(", "[", "]", "\n", "é", "₁", "e", ".", "//", "0", text[:size]])
        try:
            read(text[:at] + put + text[at + size :])
        except cg.InputError:
            refused += 1
    assert refused > 100


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("groups", 5),
        ("definitions", []),
        ("conjugates", [5]),
        ("conjugates", [["x"]]),
        ("degenerate", 1),
        ("symmetry", 1),
        ("homogeneous", "yes"),
        ("variables", 5),
        ("variables", ["x", "x"]),
        ("equations", [10**5000]),
        ("parameters", [1]),
    ],
)
def test_wrong_fields_of_json(field: str, value: object) -> None:
    with pytest.raises(cg.InputError) as raised:
        cg.System.from_json({"variables": ["x"], "equations": ["x - 1"], field: value})
    assert raised.value.field is not None and raised.value.field.startswith(field)


JULIA = """
using HomotopyContinuation  # as their guide begins
@var x[1:2] a y₁
@polyvar b
c = 3x[1]^2 - 2//7
f = [
    c + x₂*y₁ - 0.5a,
    (2 + 3im)*x[2] - 4(x₁ - b) +
        1e-1,
    y₁^2 - b
]
F = System(f; variables = [x; y₁], parameters = [a, b])
"""


def test_text_of_julia() -> None:
    system = homotopy_continuation.read(JULIA)
    assert system.variables == ("x1", "x2", "y1") and system.parameters == ("a", "b")
    assert system.definitions == {"c": "3*x1^2-(2/7)"}
    assert system.equations == ("c+x2*y1-0.5*a", "(2+3*I)*x2-4*(x1-b)+1e-1", "y1^2-b")
    again = homotopy_continuation.read(system.to_homotopy_continuation())
    at = {"a": Fraction(1, 3), "b": 2}
    first, second = (sorted_points(cg.solve(s.at(at))) for s in (system, again))
    assert len(first) == len(second) == 4
    assert numpy.allclose(first, second, rtol=1e-12, atol=1e-13)


def test_groups_and_defaults_of_julia() -> None:
    grouped = homotopy_continuation.read("@var x y\nSystem([x*y - 1, x + y], variable_groups=[[x], [y]])")
    assert grouped.groups == (("x",), ("y",))
    assert homotopy_continuation.read(grouped.to_homotopy_continuation()).groups == grouped.groups
    sorted_by_name = homotopy_continuation.read("@var z x unused\nSystem([z - x, x*z - 4])")
    assert sorted_by_name.variables == ("x", "z")


@pytest.mark.parametrize(
    ("expression", "meaning"),
    [
        ("2x^2", "2*x^2"),
        ("2(x+1)", "2*(x+1)"),
        ("x*1//3", "x*(1/3)"),
        ("-x^2", "-x^2"),
        ("1.5e-3x", "1.5e-3*x"),
        ("x+\n1", "x+1"),
        ("(x\n+1)", "(x+1)"),
        ("2π*x", "2*Pi*x"),
    ],
)
def test_what_julia_means(expression: str, meaning: str) -> None:
    assert homotopy_continuation.read(f"@var x\nSystem([{expression}])").equations == (meaning,)


@pytest.mark.parametrize(
    "expression",
    [
        "1/2x",
        "2^3x",
        "x^1//2",
        "1//2//3",
        "1//x",
        "x x",
        "2 3",
        "x(x)",
        "(x)(x)",
        "0x10",
        "x'",
        "x .+ 1",
        "x; y",
        "(x",
        "",
    ],
)
def test_what_is_not_read_of_julia_is_refused(expression: str) -> None:
    with pytest.raises(cg.InputError) as raised:
        system = homotopy_continuation.read(f"@var x\nSystem([{expression}])")
        system.info()
    assert raised.value.line == 2 or raised.value.field is not None


@pytest.mark.parametrize(
    ("expression", "julia"),
    [
        ("x/3", "x/(3//1)"),
        ("2/3*x", "(2//1)/(3//1)*x"),
        ("2^100*x", "(2//1)^100*x"),
        ("99999999999*99999999999*x", "(99999999999//1)*(99999999999//1)*x"),
        ("0.125*x", "(125//1000)*x".replace("125", "0125").replace("0125", "125")),
        ("x**2*I", "x^2*im"),
        ("x^-2", "x^-2"),
        ("1.5e3", "(1500//1)"),
    ],
)
def test_numbers_are_exact_in_julia(expression: str, julia: str) -> None:
    text = homotopy_continuation.write(cg.System([f"{expression} + x*0 + x"], "x"))
    assert f"    {julia}" in text.replace("+x*0+x", "").replace("+x*(0//1)+x", "")
