"""Families: monodromy, then many targets; exact parameters."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy
import pytest

import cognate as cg

FAMILY = cg.System(["x^2 + y^2 - p", "x*y - q"], parameters="p q")


@pytest.fixture(scope="module")
def base() -> cg.Result:
    return cg.solve(FAMILY, start="monodromy", expect=4)


def circle(p: float, q: float) -> set[complex]:
    """The exact x: (x + y)^2 = p + 2q, (x - y)^2 = p - 2q."""
    s, d = numpy.sqrt(complex(p + 2 * q)), numpy.sqrt(complex(p - 2 * q))
    return {(a * s + b * d) / 2 for a in (1, -1) for b in (1, -1)}


def is_at(found: cg.TargetResult | cg.Result, p: float, q: float) -> bool:
    expected = sorted(circle(p, q), key=lambda z: (round(z.real, 9), round(z.imag, 9)))
    x = sorted((s["x"] for s in found.solutions), key=lambda z: (round(z.real, 9), round(z.imag, 9)))
    return len(x) == 4 and max(abs(a - b) for a, b in zip(expected, x, strict=True)) < 1e-9


def test_an_array_of_targets(base: cg.Result) -> None:
    targets = numpy.array([[4, 1], [5, 0.5], [1, 2], [3, -1]])
    found = cg.solve(FAMILY, start=base, targets=targets)
    assert len(found.targets) == 4 and found.paths.total == 16
    for target, (p, q) in zip(found.targets, targets, strict=True):
        assert is_at(target, p, q), (p, q)
        assert target.settled and target.paths.adds_up
    assert [len(t.real) for t in found.targets] == [4, 4, 0, 4]


def test_targets_said_in_other_ways(base: cg.Result, tmp_path: Path) -> None:
    for targets, count in (
        ({"p": 4, "q": 1}, 0),
        ([{"p": 4, "q": 1}, {"p": 5, "q": 0.5}], 2),
        ({"p": numpy.array([4, 5]), "q": 1}, 2),
        ([4, 1], 0),
        ([[4, 1], (5, 0.5)], 2),
    ):
        found = cg.solve(FAMILY, start=base, targets=targets)
        assert len(found.targets) == count
        assert is_at(found.targets[0] if count else found, 4, 1)
    again = cg.solve(
        FAMILY,
        start_solutions=base.array(),
        start_parameters=[base.parameters["p"], base.parameters["q"]],
        targets=[4, 1],
    )
    assert is_at(again, 4, 1)
    # A file in Bertini's format.
    file = tmp_path / "final_parameters"
    file.write_text(cg.formats.bertini.write_parameters([4, 1]))
    starts = tmp_path / "start"
    starts.write_text(
        cg.formats.bertini.write_points(
            cg.formats.bertini.read_points(cg.formats.bertini.write_points([s.coordinates for s in base.solutions]))
        )
    )
    found = cg.solve(FAMILY, start_solutions=starts, start_parameters=base.parameters, targets=file, certify=True)
    assert is_at(found, 4, 1) and len(found.certified) == 4


def test_exact_parameters(base: cg.Result) -> None:
    with pytest.warns(cg.RoundedWarning, match="1/3 of targets.q"):
        cg.solve(FAMILY, start=base, targets={"p": 4, "q": Fraction(1, 3)})
    exactly = FAMILY.at(p=4, q=Fraction(1, 3))
    found = cg.solve(exactly, certify=True, digits=30)
    solution = found.certified[0]
    (xr, _), (yr, _) = solution.decimal("x"), solution.decimal("y")
    assert abs(Fraction(xr) * Fraction(yr) - Fraction(1, 3)) < Fraction(1, 10**28)


@pytest.mark.parametrize(
    ("targets", "field"),
    [
        ([1, 2, 3], "targets"),
        ([[4, 1], [4]], "targets[1]"),
        ({"p": [1, 2], "q": [1, 2, 3]}, "targets"),
        ({"p": "four", "q": 1}, "targets.p"),
        ([], "targets"),
        ({"p": float("inf"), "q": 1}, "targets.p"),
    ],
)
def test_wrong_targets(base: cg.Result, targets: object, field: str) -> None:
    with pytest.raises(cg.InputError) as raised:
        cg.solve(FAMILY, start=base, targets=targets)
    assert raised.value.field == field


def test_missing_parameters(base: cg.Result) -> None:
    with pytest.raises(cg.InputError) as raised:
        cg.solve(FAMILY, start=base, targets={"p": 4})
    assert "q" in str(raised.value)
    with pytest.raises(cg.InputError, match="monodromy"):
        cg.solve(FAMILY, start=cg.solve(["x - 1"]), targets=[4, 1])
    with pytest.raises(cg.InputError) as raised:
        FAMILY.at(r=1)
    assert raised.value.field == "r"


CUBIC = cg.System(["x^3 + p*x + q"], parameters="p q")


def test_a_sweep_needs_no_start(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    targets = {"p": -3, "q": numpy.array([-3, 0, 2, 3])}
    found = cg.sweep(CUBIC, targets=targets, sort="-x", real=True)
    assert found.settled and found.family["solutions"] == 3
    assert [t.counts.real for t in found.targets] == [1, 3, 2, 1]
    assert [t.changes for t in found.targets] == [False, True, True, True]
    assert found.targets[2].by_itself and [s.multiplicity for s in found.targets[2].solutions] == [2, 1]
    three = [s["x"].real for s in found.targets[1].solutions]
    assert numpy.allclose(three, [3**0.5, 0, -(3**0.5)])
    assert found.targets[1].real_array().shape == (3, 1)
    frame = found.frame()
    assert list(frame["q"]) == [-3, 0, 2, 3] and list(frame["selected"]) == [1, 3, 2, 1]
    assert cg.sweep(CUBIC, targets=targets).family["source"] == "cache"


@pytest.mark.parametrize(
    ("options", "field"),
    [
        ({}, "targets"),
        ({"targets": {"p": 1, "q": 2}}, "targets"),
        ({"targets": [[1, 2], [3, 4]], "start": "monodromy"}, "start"),
    ],
)
def test_what_is_no_sweep(options: dict[str, object], field: str) -> None:
    with pytest.raises(cg.InputError) as raised:
        cg.sweep(CUBIC, **options)  # type: ignore[arg-type]
    assert raised.value.field == field


def test_the_largest_value_where_conditions_hold() -> None:
    # The largest box whose edges add up to 6.
    found = cg.solve(["x + y + z = 6"], maximize="x*y*z", positive=True)
    assert abs(found.critical["maximum"]["value"] - 8) < 1e-12
    (best,) = found.solutions
    assert best.kind == "maximum" and best.on_border is False
    assert all(abs(z - 2) < 1e-9 for z in best.coordinates)
    with pytest.raises(cg.NotKnown):
        _ = cg.solve(["x^2 - 2"]).critical
