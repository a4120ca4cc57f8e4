"""Solving: every form of a problem, exact numbers, errors, progress, async."""

from __future__ import annotations

import asyncio
import os
import pickle
import signal
import subprocess
import sys
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import numpy
import pytest
import sympy

import cognate as cg
from conftest import EXAMPLES, katsura, processes_with, until

X, Y = sympy.symbols("x y")
CIRCLE_JSON = {"variables": ["x", "y"], "equations": ["x^2 + y^2 - 4", "x*y - 1"]}


@pytest.mark.parametrize(
    "problem",
    [
        ["x^2 + y^2 - 4", "x*y - 1"],
        ["x**2 + y**2 = 4", "x*y == 1"],
        [X**2 + Y**2 - 4, sympy.Eq(X * Y, 1)],
        [sympy.Poly(X**2 + Y**2 - 4, X, Y), X * Y - 1],
        sympy.Matrix([X**2 + Y**2 - 4, X * Y - 1]),
        [X**2 + Y**2 - 4, "x*y - 1"],
        CIRCLE_JSON,
        cg.System(["x^2 + y^2 - 4", "x*y - 1"], "x y"),
        "2\n x^2 + y^2 - 4;\n x*y - 1;\n",
        "variable_group x, y; function f, g; f = x^2 + y^2 - 4; g = x*y - 1;",
    ],
    ids=["strings", "signs", "sympy", "poly", "matrix", "mixed", "mapping", "system", "phcpack", "bertini"],
)
def test_every_way_to_say_a_problem(problem: object) -> None:
    found = cg.solve(problem)
    assert found.variables == ("x", "y")
    assert (found.counts.distinct, found.counts.real, found.paths.total) == (4, 4, 4)
    assert found.settled and found.complete is True and found.open_questions == []
    products = found.array()[:, 0] * found.array()[:, 1]
    assert numpy.abs(products - 1).max() < 1e-12


@pytest.mark.parametrize("text", ["x + y = 3, x*y = 2", "x + y = 3\nx*y = 2", "x + y = 3; x*y = 2;"])
def test_several_equations_in_one_text(text: str) -> None:
    for problem in (text, [text], cg.System(text)):
        assert cg.solve(problem).counts.real == 2


def test_conditions_are_no_equations() -> None:
    assert [s["x"] for s in cg.solve("x^2 = 4, x > 0")] == [2]
    for problem in (["x^2 = 4", "x > 0"], [X**2 - 4, X > 0]):
        with pytest.raises(cg.InputError, match="where="):
            cg.solve(problem)


def test_an_objective_without_equations() -> None:
    for problem in ((), [], None):
        found = cg.solve(problem, minimize="x^2 + y^2", where="x + y >= 2")
        assert found.critical is not None and found.critical["minimum"]["value"] == pytest.approx(2)
    found = cg.solve(critical="x^3 - 3*x")
    assert [s.kind for s in found.solutions] == ["minimum", "maximum"]
    with pytest.raises(cg.InputError, match="at least one equation"):
        cg.solve()


def test_a_file_by_its_path(tmp_path: Path) -> None:
    file = EXAMPLES / "three_rpr.bertini"
    by_path = cg.solve(file, conjugates="p~P,t1~T1,t2~T2,t3~T3,g~G", output=tmp_path / "out")
    by_name = cg.solve(str(file), conjugates=[["p", "P"], ["t1", "T1"], ["t2", "T2"], ["t3", "T3"], ["g", "G"]])
    # The README's example: 6 assemblies, all real, with reproducible bits.
    assert by_path.counts.real == 6 and len(by_path.real) == 6
    assert by_path.solutions == by_name.solutions
    assert by_path.output is not None and (by_path.output / "paths.parquet").stat().st_size > 0
    # Isotropic coordinates of a real solution are complex, so there is no array of real numbers.
    with pytest.raises(cg.NotKnown, match="conjugate"):
        by_path.real_array()


def test_exact_numbers_stay_exact() -> None:
    third, tenth = Fraction(1, 3), Decimal("0.1")
    system = cg.System([X - sympy.Rational(1, 3), "y - a", "z - b"], definitions={"a": third, "b": tenth})
    (solution,) = cg.solve(system, certify=True, digits=40).solutions
    re, im = solution.decimal("y")
    assert im == 0 and abs(Fraction(re) - third) < Fraction(1, 10**40)
    assert abs(Fraction(solution.decimal("z")[0]) - Fraction(1, 10)) < Fraction(1, 10**40)
    certificate = solution.certificate
    assert certificate is not None and certificate.certified and certificate.real
    for box, exactly in zip(certificate.coordinates, (third, third, Fraction(1, 10)), strict=True):
        assert abs(box.re - exactly) <= box.radius and box.error <= box.radius


def test_sympy_numbers_keep_every_bit() -> None:
    exact_float = sympy.Float(1, 40) / 3
    system = cg.System([X - sympy.Float(0.1), Y - exact_float])
    assert system.equations[0] == "x - 0.1"
    fraction = sympy.Rational(exact_float)
    assert f"{fraction.p}/{fraction.q}" in system.equations[1]
    roots = cg.System([X**2 - sympy.sqrt(2), Y - sympy.I * sympy.pi + 1 / sympy.sqrt(3)])
    found = cg.solve(roots, certify=True)
    assert len(found.certified) == 2
    assert abs(found.solutions[0]["y"] - (1j * numpy.pi - 3**-0.5)) < 1e-14


def test_two_symbols_of_one_name_are_refused() -> None:
    real = sympy.Symbol("x", real=True)
    for equations, more in (([X - 1, real - 2], {}), ([X - 1], {"parameters": [real]}), ([X * real - 1], {})):
        with pytest.raises(cg.InputError, match="differ") as raised:
            cg.System(equations, **more)
        assert raised.value.field == "x"
    system = cg.System((X**n - 1 for n in (2, 3)), (s for s in (Y, X)))
    assert system.variables == ("y", "x") and len(system.equations) == 2


def test_answers_and_errors_can_be_pickled() -> None:
    found = cg.solve(["x^2 - 2"], certify=True)
    assert pickle.loads(pickle.dumps(found)) == found
    unsettled = pickle.loads(pickle.dumps(cg.Unsettled("not settled", found)))
    assert unsettled.result == found and str(unsettled) == "not settled"
    error = pickle.loads(pickle.dumps(cg.InputError("wrong", file="f", line=2, field="g")))
    assert (error.file, error.line, error.field, error.reason) == ("f", 2, "g", "wrong")


def test_an_interrupt_leaves_nothing_behind(tmp_path: Path) -> None:
    # The program has another name here.
    name = f"interrupted-{os.getpid()}"
    (tmp_path / name).symlink_to(cg.program.find())
    katsura(14).write(tmp_path / "system.bertini", "bertini")
    system = str(tmp_path / "system.bertini")
    script = f"import cognate as cg; cg.solve({system!r}, progress=lambda now: print('on', flush=True))"
    environment = {**os.environ, "COGNATE_PROGRAM": str(tmp_path / name)}
    pipe = subprocess.PIPE
    child = subprocess.Popen([sys.executable, "-c", script], stdout=pipe, stderr=pipe, text=True, env=environment)
    assert child.stdout is not None and child.stdout.readline() == "on\n"
    assert any(f"{name} serve" in line for line in processes_with(name))
    child.send_signal(signal.SIGINT)
    _, error = child.communicate(timeout=600)
    assert "KeyboardInterrupt" in error and not processes_with(name)


def test_the_same_seed_gives_the_same_bits() -> None:
    problem = ["x^3 + y^2 - 2", "x*y + y - 3"]
    first, second = (cg.solve(problem, seed=7, workers=w) for w in (1, 2))
    assert first.solutions == second.solutions and first.seed == 7


def test_singular_solutions_and_multiplicity() -> None:
    found = cg.solve(["x^2", "y - 1"])
    assert [s.multiplicity for s in found.solutions] == [2]
    assert found.singular and not found.nonsingular
    assert found.counts.with_multiplicity == 2


def test_classes_of_a_symmetry() -> None:
    symmetry = [{"permutation": {"x": "y", "y": "x"}}]
    found = cg.solve(["x^2 + y^2 - 4", "x*y - 1"], symmetry=symmetry)
    assert found.classes["count"] == 2 and found.classes["group_order"] == 2
    assert {s.symmetry_class for s in found.solutions} == {0, 1}


def test_what_is_real_is_said_or_refused() -> None:
    found = cg.solve(["x^2 - I"])
    assert found.counts.real is None
    with pytest.raises(cg.NotKnown, match="conjugation"):
        _ = found.real
    with pytest.raises(cg.NotKnown, match="certify"):
        _ = found.certified


@pytest.mark.parametrize(
    ("problem", "attributes"),
    [
        (["x^2 - 1", "x + $"], {"field": "equations[1]", "column": 5, "file": None, "line": None}),
        ({"variables": ["x"], "equations": ["x"], "foo": 1}, {"field": "foo"}),
        ("2\nx^2 - 1;\nx*y - ;\n", {"file": None, "line": 3, "column": 7}),
        (["x^2 = 1 = 2"], {"field": "equations[0]"}),
        ([X**Y], {"field": "equations[0]"}),
        ([sympy.Symbol("a b") - 1], {"field": "equations[0]"}),
        ([float("nan")], {"field": "equations[0]"}),
        ([], {"field": "equations"}),
        ("missing.bertini", {"file": "missing.bertini"}),
    ],
)
def test_errors_name_the_place(problem: object, attributes: dict[str, object]) -> None:
    with pytest.raises(cg.InputError) as raised:
        cg.solve(problem)
    for name, value in attributes.items():
        assert getattr(raised.value, name) == value, (name, raised.value)
    assert "/tmp" not in str(raised.value)


def test_warnings_name_what_the_user_knows(service: cg.Service) -> None:
    text = "1\nx^2 - 1;\nand more\n"
    with pytest.warns(cg.CognateWarning, match="^text:3: what follows") as issued:
        found = cg.solve(text)
    assert issued[0].filename == __file__
    with pytest.warns(cg.CognateWarning, match="^text:3: what follows"):
        again = service.submit(text).results()
    assert found.warnings == again.warnings and len(found.warnings) == 1


def test_errors_of_files_and_options(tmp_path: Path) -> None:
    file = tmp_path / "bad.bertini"
    file.write_text("INPUT\nvariable_group x;\nfunction f;\nf = x^2 - z;\nEND;\n")
    with pytest.raises(cg.InputError) as raised:
        cg.solve(file)
    assert (raised.value.file, raised.value.line, raised.value.column) == (str(file), 4, 11)
    with pytest.raises(cg.InputError) as raised:
        cg.solve(["x^2 - 1"], digits=-3)
    assert raised.value.field == "digits"
    with pytest.raises(cg.InputError) as raised:
        cg.solve(["x*y - 1", "x - y"], groups=[["x"], ["z"]])
    assert "z" in raised.value.reason
    with pytest.raises(TypeError, match="certfy"):
        cg.solve(["x - 1"], certfy=True)  # type: ignore[call-arg]


def test_no_program(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COGNATE_PROGRAM", "/nowhere/cognate")
    with pytest.raises(cg.ProgramNotFound, match="/nowhere/cognate"):
        cg.solve(["x - 1"])


def test_progress_is_told_to_a_function() -> None:
    seen: list[cg.Progress] = []
    found = cg.solve(EXAMPLES / "katsura_10.bertini", progress=seen.append)
    assert found.paths.total == 1024
    assert seen and seen[-1].done <= seen[-1].total and seen[-1].unit == "path"


@pytest.mark.parametrize("bar", ["tqdm", "plain"])
def test_there_is_one_bar_where_it_is_asked_for(
    bar: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from cognate import progress

    if bar == "plain":
        monkeypatch.setattr(progress.importlib.util, "find_spec", lambda name: None)
    with progress.Bar(True) as shown:
        assert shown.watcher is not None
        for done in (1, 5, 10):
            shown.watcher(cg.Progress("tracking", done, 10, 1, "path", 1.0))
    error = capsys.readouterr().err
    assert "tracking" in error and "10" in error
    cg.solve(["x - 1"])
    assert capsys.readouterr() == ("", "")


def test_async_solves_run_together() -> None:
    async def both() -> list[cg.Result]:
        return await asyncio.gather(*(cg.solve_async([f"x^{n} - 2"], workers=1) for n in (2, 3)))

    assert [r.counts.distinct for r in asyncio.run(both())] == [2, 3]


def test_a_cancelled_task_leaves_nothing_behind(tmp_path: Path) -> None:
    name = f"cancelled-{os.getpid()}.bertini"
    file = tmp_path / name
    katsura(13).write(file, "bertini")

    async def cancelled() -> None:
        task = asyncio.create_task(cg.solve_async(file))
        await asyncio.sleep(0.3)
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task

    asyncio.run(cancelled())
    assert until(lambda: not processes_with(name))


def test_points_where_a_denominator_is_0_are_no_solutions() -> None:
    equations = ["x/y + y/x - 5/2", "1/x + 1/y - 3/2"]
    with pytest.warns(cg.CognateWarning, match="denominators are multiplied out"):
        found = cg.solve(equations)
    points = sorted((round(s["x"].real), round(s["y"].real)) for s in found.solutions)
    assert points == [(1, 2), (2, 1)] and len(found.real) == 2
    assert found.settled and found.complete and found.paths.adds_up
    assert found.counts.removed == {"a denominator is 0": 1} and found.paths.removed == 2
    with pytest.warns(cg.CognateWarning, match="denominators are multiplied out"):
        components = cg.decompose(equations)
    assert len(components) == 2 and components.settled
    assert components.removed == {"a denominator is 0": [{"dimension": 0, "degree": 1, "count": 1}]}


def test_no_isolated_solution_says_what_there_is() -> None:
    found = cg.solve(["x*(x - y)", "x*(y - 1)*x"])
    assert found.counts.positive_dimensional
    lines = str(found).splitlines()
    assert "a positive-dimensional" in lines[0]
    found = cg.solve(["x - y", "(x - y)*x"])
    assert str(found).splitlines()[0].startswith("no isolated solution, but a positive-dimensional")
    assert "decompose" in str(found).splitlines()[0]
    with pytest.raises(cg.CognateError, match="decompose"):
        cg.solve(["x - y^2"])


def test_roots_absolute_values_and_relations_of_sympy_are_taken() -> None:
    x = sympy.Symbol("x")

    def values(equation: object, **options: object) -> list[float]:
        return sorted(round(s["x"].real, 9) for s in cg.solve(equation, **options).solutions)  # type: ignore[arg-type]

    assert values(sympy.cbrt(x) - 2) == [8]
    assert values(sympy.root(x, 5) - 2) == [32]
    assert values(sympy.Abs(x) - 2, real=True) == [-2, 2]
    assert values(x**2 - 4, where=x > 0) == [2]
    assert values(x**2 - 4, where=[x < 0, sympy.Ne(x, 1)]) == [-2]
    with pytest.raises(cg.InputError, match="rational exponent"):
        cg.solve(x**sympy.pi - 1)
    with pytest.raises(cg.InputError, match="expected a condition"):
        cg.solve(x**2 - 4, where=[3])
