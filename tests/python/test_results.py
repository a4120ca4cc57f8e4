"""Results: counts that do not add up, doubts, points at their targets, displays and tables."""

from __future__ import annotations

import copy
import json
import warnings
from typing import Any

import numpy
import pytest

import cognate as cg
from cognate import result as result_
from cognate.solution import Solution
from cognate.solving import checked


@pytest.fixture(scope="module")
def solved() -> cg.Result:
    return cg.solve(["x^2 + y^2 - 4", "x*y - 1"])


def changed(solved: cg.Result, **changes: Any) -> cg.Result:
    """The answer with other numbers: `paths_failed=1` for `summary["paths"]["failed"]`."""
    summary = copy.deepcopy(dict(solved.summary))
    for name, value in changes.items():
        block, _, field = name.partition("_")
        summary[block][field] = value
    summary["settled"] = changes.get("settled", summary["settled"])
    return result_.from_summary(summary, list(solved.solutions), output=None)


@pytest.mark.parametrize(
    ("changes", "question"),
    [
        ({"paths_total": 5, "paths_failed": 1}, "1 paths failed"),
        ({"paths_total": 5}, "the classes of paths add up to 4 of 5"),
        ({"paths_total": 6, "paths_undecided": 2}, "2 ends at singular points"),
        ({"paths_total": 5, "paths_within_data_accuracy": 1}, "within the accuracy"),
        ({"paths_crossings_found": 3, "paths_crossings_resolved": 1}, "2 path crossings"),
        ({"paths_decided_by_precision_limit": 1}, "limit of the precision"),
        ({"solutions_doubtful_multiplicity": 1}, "multiplicity"),
        ({"solutions_without_conjugate": 1}, "no conjugate"),
        ({"solutions_nonsingular": 3}, "3 \\+ 0 solutions are not 4"),
    ],
)
def test_what_is_not_settled_warns(solved: cg.Result, changes: dict[str, int], question: str) -> None:
    found = changed(solved, **changes)
    with pytest.warns(cg.UnsettledWarning, match=question):
        checked(found, strict=False)
    with pytest.raises(cg.Unsettled, match=question) as raised:
        checked(found, strict=True)
    assert raised.value.result is found
    for shown in (str(found), found._repr_html_()):
        assert "ot settled" in shown


def test_counts_that_do_not_add_up_are_not_settled(solved: cg.Result) -> None:
    assert not changed(solved, paths_total=5).settled
    with pytest.raises(cg.CognateError, match="5 solutions .* are counted, 4 are listed"):
        changed(solved, solutions_distinct=5)


def test_a_summary_that_says_no_is_believed(solved: cg.Result) -> None:
    summary = {**solved.summary, "settled": False}
    found = result_.from_summary(summary, list(solved.solutions), output=None)
    assert not found.settled and found.open_questions == ["a count is not settled"]


def test_an_answer_in_doubt_warns_or_is_right() -> None:
    # Two solutions are 2e-11 apart. In doubles they look almost like one double point.
    with warnings.catch_warnings(record=True) as issued:
        warnings.simplefilter("always")
        found = cg.solve(["(x - 1)^2 - 10^-22", "y - 1"])
    if found.settled:
        assert found.counts.nonsingular == 2
        return
    assert any(w.category is cg.UnsettledWarning and w.filename == __file__ for w in issued)
    assert found.open_questions and found.complete is not True
    with warnings.catch_warnings(), pytest.raises(cg.Unsettled):
        warnings.simplefilter("ignore")
        cg.solve(["(x - 1)^2 - 10^-22", "y - 1"], strict=True)


def test_undecided_points_are_apart(solved: cg.Result) -> None:
    line = json.loads(
        '{"variables":{"x":[0,0],"y":[0,0]},"multiplicity":1,"cycles":[1],"real":null,"singular":true,'
        '"residual":0,"condition":null,"accuracy":1e-8,"precision_bits":106,"class":null,"paths":[4],'
        '"certificate":null,"deflations":null,"undecided":true}'
    )
    summary = copy.deepcopy(dict(solved.summary))
    summary["paths"].update(total=5, undecided=1)
    summary["solutions"].update(undecided=1)
    found = result_.from_summary(summary, [*solved.solutions, Solution.from_json(line)], output=None)
    assert len(found.solutions) == 4 and len(found.undecided) == 1 and len(found.real) == 4
    assert found.array().shape == (4, 2)
    assert "undecided point" in found.report()


def test_a_point_at_the_wrong_target_is_refused() -> None:
    family = cg.System(["x^2 - p"], parameters="p")
    base = cg.solve(family, start="monodromy", expect=2)
    found = cg.solve(family, start=base, targets=[[1], [4], [9]])
    listed = list(found.solutions)
    assert [sorted(round(s["x"].real) for s in t.solutions) for t in found.targets] == [
        [-1, 1],
        [-2, 2],
        [-3, 3],
    ]
    listed[0], listed[5] = listed[5], listed[0]
    with pytest.raises(cg.CognateError, match="target 0"):
        result_.from_summary(found.summary, listed, output=None)


def test_conditions_select_among_solutions_whose_counts_stay() -> None:
    equations = ["x^2 + y^2 - 25", "x*y - 12"]
    found = cg.solve(equations, where=["x > y", "y > -5"], positive=True)
    assert [solution.coordinates for solution in found.solutions] == [(4, 3)]
    assert found.counts.distinct == 4
    assert found.summary["selected"]["count"] == 1
    ordered = cg.solve(equations, sort="-x", real=True)
    assert [round(solution["x"].real) for solution in ordered.solutions] == [4, 3, -3, -4]


def test_several_targets_from_nothing_are_a_sweep() -> None:
    family = cg.System(["x^2 - p"], parameters="p")
    with pytest.raises(cg.CognateError, match="sweep"):
        cg.solve(family, targets=[[1], [4]])


def test_newer_programs_may_say_more(solved: cg.Result) -> None:
    summary = copy.deepcopy(dict(solved.summary))
    summary["paths"]["new_count"] = 3
    summary["new_block"] = {}
    found = result_.from_summary(summary, list(solved.solutions), output=None)
    assert found.settled and found.summary["paths"]["new_count"] == 3


def test_tables(solved: cg.Result) -> None:
    frame = solved.frame()
    assert list(frame.columns[:3]) == ["x", "y", "real"] and len(frame) == 4
    assert frame["real"].all()
    assert solved.real_array().dtype == float and solved.real_array().shape == (4, 2)
    html = solved._repr_html_()
    assert html.count("<tr>") == 10 + 5 and "<script" not in html and "4 solutions, 4 real" in html
    assert "4 solutions, 4 real" in str(solved)


def test_no_solutions_have_empty_arrays() -> None:
    found = cg.solve(["x*y - 1", "x"])
    assert found.counts.distinct == 0 and found.array().shape == (0, 0) and found.real == []
    assert found.paths.at_infinity == found.paths.total


def test_a_solution_is_a_mapping(solved: cg.Result) -> None:
    solution = solved.solutions[0]
    assert dict(solution) == {"x": solution["x"], "y": solution["y"]}
    with pytest.raises(KeyError):
        solution["z"]
    with pytest.raises(KeyError):
        solution.decimal("z")
    assert complex(*map(float, solution.decimal("x"))) == solution["x"]


def test_a_result_is_a_sequence_of_solutions() -> None:
    found = cg.solve(["x^2 + y^2 = 5", "x*y = 2"])
    assert len(found) == 4 and list(found) == list(found.solutions) and found[0] is found.solutions[0]
    assert len(found[1:]) == 3 and sorted(round(solution["x"].real) for solution in found) == [-2, -1, 1, 2]


def test_solutions_are_drawn() -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    found = cg.solve(["x^3 = 1", "y = x^2 + 1"])
    axes = found.plot()
    assert axes.lines[0].get_xydata() == pytest.approx(numpy.array([[1.0, 2.0]])) and axes.get_ylabel() == "y"
    assert len(found.plot("x").lines[0].get_xydata()) == 3
    with pytest.raises(ValueError, match="expected one or two of x, y"):
        found.plot("z")


def test_words_of_other_programs_are_answered_with_ours() -> None:
    family = cg.System(["x^2 - p"], parameters="p")
    with pytest.raises(TypeError, match="targets="):
        cg.solve(family, target_parameters=[2])  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="System"):
        cg.solve(["x^2 - 1"], vars="x")  # type: ignore[call-arg]
    for function in (lambda x: x**2 - 1, [lambda x: x**2 - 1]):
        with pytest.raises(cg.InputError, match="write the equations as text"):
            cg.solve(function)


def test_equations_go_to_sympy_and_back() -> None:
    sympy = pytest.importorskip("sympy")
    x, y, p, e = sympy.symbols("x y p E")
    system = cg.System(
        ["x^2 = 1/3*b + 0.5", "sqrt(y)*I - E*p"], "x y E", parameters="p", definitions={"b": "a^2", "a": "y + 1e-1"}
    )
    tenth, half, third = sympy.Rational(1, 10), sympy.Rational(1, 2), sympy.Rational(1, 3)
    first, second = system.to_sympy()
    assert sympy.expand(first - (x**2 - third * (y + tenth) ** 2 - half)) == 0
    assert second == sympy.sqrt(y) * sympy.I - e * p
    assert cg.System(system.to_sympy(), "x y E", parameters="p").to_sympy() == [first, second]
    for text in ("x.__class__", "x . real", "(x).real", "__import__('os')", "x[0]"):
        with pytest.raises(cg.InputError, match="expected an expression in x"):
            cg.System([text], "x").to_sympy()
    with pytest.raises(cg.InputError, match="do not need each other"):
        cg.System(["a"], "x", definitions={"a": "b + x", "b": "a"}).to_sympy()
