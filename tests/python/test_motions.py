"""Motions of mechanisms: modes, freedoms, singular positions, workspaces, exceptional values, approximate synthesis.

Known answers with their sources: `meta.json` of each case in tests/motions and tests/mechanisms.
"""

from __future__ import annotations

import copy
import json
import math
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy
import pytest

import cognate as cg
from cognate import program
from conftest import EXAMPLES, REPOSITORY

MOTIONS = REPOSITORY / "tests" / "motions"
QUARTER = math.pi / 2


def instance(name: str, **options: Any) -> cg.Mechanism:
    """A mechanism with a known answer."""
    return cg.Mechanism.read(MOTIONS / name / "mechanism.json", **options)


def given(name: str, file: str) -> Any:
    """A file of a mechanism with a known answer."""
    return json.loads((MOTIONS / name / file).read_text())


def expected(name: str) -> dict[str, Any]:
    """The known answer."""
    answer: dict[str, Any] = given(name, "meta.json")["expected"]
    return answer


@pytest.fixture(scope="module")
def kite() -> cg.Motion:
    return instance("kite").motion(real=True, workers=1)


def test_a_kite_moves_in_two_modes_that_meet(kite: cg.Motion) -> None:
    assert (kite.mobility, kite.gruebler, kite.idle, kite.overconstrained, kite.kinematotropic) == (
        1,
        1,
        0,
        False,
        False,
    )
    assert [(mode.degree, mode.circuits, mode.home) for mode in kite] == [(4, 1, True), (2, 1, False)]
    assert {mode.degree_in for mode in kite} == {"links"} and len(kite) == 2 and kite["1.1"].degree == 4
    [meeting] = kite.meetings
    assert meeting.modes == ("1.1", "1.2") and len(meeting.real) == 2
    assert set(meeting.real[0].joints or {}) == {"A0", "A", "B", "B0"}
    assert kite.settled and kite.circuits == 1 and (kite.isolated, kite.isolated_real) == (0, 0)
    assert repr(kite) == "<Motion: mobility 1, 1.1 of degree 4, 1.2 of degree 2>"
    assert str(kite).splitlines() == [
        "moves with 1 freedom in 2 ways",
        "  1.1  curve, degree 4, 1 circuit, home is here",
        "  1.2  curve, degree 2, 1 circuit",
        "  1.1 and 1.2 meet: 2, 2 real",
    ]
    assert kite._repr_html_().startswith("<pre>moves with 1 freedom")
    with pytest.raises(KeyError):
        kite["2.1"]


def test_where_modes_meet_two_velocities_are_possible(kite: cg.Motion) -> None:
    there = instance("kite").mobility(kite.meetings[0].real)
    assert [(each.infinitesimal, each.local) for each in there] == [(2, 1)] * 2


@pytest.mark.parametrize(("name", "modes"), [("parallelogram", 2), ("rhombus", 3)])
def test_special_four_bars_have_more_modes(name: str, modes: int) -> None:
    folder = REPOSITORY / "tests" / "mechanisms" / name
    [file] = [f for f in folder.glob("*.json") if f.name != "meta.json"]
    motion = cg.Mechanism.read(file).motion(workers=1)
    assert motion.settled and motion.mobility == 1 and len(motion) == modes
    # Without `real` the answer has no circuits.
    assert motion.circuits is None and motion.modes[0].circuits is None


def test_the_path_of_a_coupler_point_is_a_sextic() -> None:
    motion = instance("four_bar_crank_rocker").motion(path="output", workers=1)
    assert [(mode.degree, mode.path_degree) for mode in motion] == [(6, 6)]
    # A joint of the crank moves on a circle.
    motion = instance("four_bar_crank_rocker").motion(path=("crank", (Fraction(3, 5), Fraction(4, 5))), workers=1)
    assert [mode.path_degree for mode in motion] == [2]
    with pytest.raises(cg.InputError, match="wheel"):
        instance("four_bar_crank_rocker").motion(path=("wheel", (1, 2)))


def test_exact_numbers_stay_exact() -> None:
    bennett = instance("bennett").motion(workers=1)
    assert (bennett.mobility, bennett.gruebler, bennett.overconstrained) == (1, -2, True)


def test_motions_at_values_of_open_numbers() -> None:
    family = instance("four_bar_sweep")
    motions = family.motions([{"b": 3, "c": 2}, {"b": Fraction(5, 2), "c": Fraction(7, 2)}], workers=1)
    assert [motion.values for motion in motions] == [{"b": 3.0, "c": 2.0}, {"b": 2.5, "c": 3.5}]
    claims = {tuple(each["free"].items()): each for each in expected("four_bar_sweep")["values"]}
    general = [component["degree"] for component in claims[("b", "5/2"), ("c", "7/2")]["components"]]
    assert [[mode.degree for mode in motion] for motion in motions] == [[4, 2], general]
    with pytest.raises(cg.InputError, match="no number d is open"):
        family.motions([{"b": 3, "c": 2, "d": 1}])


def test_for_which_values_more_moves() -> None:
    answer = instance("free_crank").exceptional(workers=1)
    assert answer.free == ("c",) and answer.generic == 0 and answer.settled
    [each] = answer
    assert (each.dimension, each.mobility) == (0, 1)
    assert each.values == ({"c": 1.0},) and each.exact == ({"c": "1"},)
    with pytest.raises(cg.InputError, match="no number is open"):
        instance("kite").exceptional()


def test_freedoms_at_configurations() -> None:
    parallelogram = instance("change_points")
    answer = parallelogram.mobility(given("change_points", "at.json"))
    for each, claims in zip(answer, expected("change_points")["points"], strict=True):
        assert (each.infinitesimal, each.local) == (claims["infinitesimal"], claims["local"])
        assert each.dimensions_by_order[: len(claims["dimensions_by_order"])] == tuple(claims["dimensions_by_order"])
        assert each.settled
    home = parallelogram.mobility()
    assert repr(home) == "<LocalMobility: 1 to first order, local 1>"
    # An answer is accepted as a configuration.
    position = parallelogram.forward({"A0": 0.4})[0]
    assert parallelogram.mobility(position).local == 1
    assert home.why is None
    cranks = instance("three_equal_cranks").mobility(why=True)
    assert cranks.settled and cranks.why is not None
    assert [(each.keeps, each.assembles) for each in cranks.why] == [(False, True)] * 12
    assert (cranks.why[2].number, cranks.why[2].value) == ("B1.point.0", 0.6)
    with pytest.raises(cg.InputError, match="close"):
        parallelogram.mobility({"A0": 0.1, "A": 0, "B": 0, "B0": 0})
    with pytest.raises(cg.InputError, match="expected home") as raised:
        parallelogram.mobility("house")  # type: ignore[call-overload]
    assert raised.value.field == "at"


def test_exact_configurations_decide_exactly() -> None:
    # The slider moves to the ground joint, and stays there while both dyads turn.
    at = given("switching_point", "at.json")
    answer = instance("switching_point").mobility(at[:3])
    assert [(each.infinitesimal, each.local) for each in answer] == [(1, 1), (2, 2), (3, 2)]
    assert all(each.exact for each in answer)


def test_dead_centres_of_a_four_bar() -> None:
    answer = instance("dead_centres").singularities(workers=1)
    claims = expected("dead_centres")
    assert (answer.kind, answer.inputs, answer.dimension) == ("inputs", ("B0",), 0)
    assert (answer.isolated, answer.isolated_real) == (4, 4) and answer.settled
    assert answer.array(["B0"])[:, 0] == pytest.approx(claims["real_inputs"]["B0"], abs=1e-12)
    assert answer.array().shape == (4, 4)
    assert repr(answer) == "<Singularities of inputs: 4 positions, 4 real>"
    at = instance("dead_centres").singularities(at=list(answer.positions))
    assert [each.singular for each in at] == [True] * 4
    assert instance("dead_centres").singularities(at="home").singular is False


def test_the_singular_poses_of_a_platform_are_a_conic() -> None:
    platform = instance("three_rpr")
    answer = platform.singularities(orientation=expected("three_rpr")["orientation"], workers=1)
    assert answer.dimension == 1 and answer.settled and answer.curves is not None
    [conic] = answer.curves
    points = conic.array()
    assert conic.degree == 2 and points.shape[0] >= 20 and points.shape[1] == 2
    x, y = points.T
    monomials = numpy.stack([x * x, x * y, y * y, x, y, numpy.ones_like(x)], axis=1)
    values = numpy.linalg.svd(monomials, compute_uv=False)
    assert values[-1] < 1e-9 * values[0] < values[-2]
    claims = expected("three_rpr")["inputs"]["points"]
    at = platform.singularities(at=given("three_rpr", "at.json"))
    assert [each.singular for each in at] == [each["singular"] for each in claims]


def test_a_planar_arm_is_singular_where_it_is_straight() -> None:
    arm = instance("planar_3r")
    answer = arm.singularities("outputs", workers=1)
    assert answer.dimension == 1 and answer.settled
    # Each of two joints is stretched or folded, and the arm is turned about the first joint.
    assert len(answer.components) == 4
    claims = expected("planar_3r")["outputs"]["points"]
    at = arm.singularities("outputs", at=given("planar_3r", "at.json"))
    assert [each.singular for each in at] == [each["singular"] for each in claims]
    with pytest.raises(cg.InputError, match="expected inputs or outputs"):
        arm.singularities("middle")


def test_singular_postures_of_an_arm_are_named() -> None:
    answer = instance("puma").singularities("outputs", at=given("puma", "at.json"))
    claims = expected("puma")["outputs"]["points"]
    assert [list(each.classes) for each in answer] == [each["classes"] for each in claims]
    assert [each.rank_loss for each in answer] == [each["rank_loss"] for each in claims]
    assert repr(answer[1]).startswith("<SingularityAt: singular, wrist, value ")


@pytest.mark.parametrize("name", ["cuspidal_3r", "not_cuspidal_3r"])
def test_cusps_of_arms_of_three_joints(name: str) -> None:
    answer = instance(name).singularities("outputs")
    claims = expected(name)["outputs"]
    assert (answer.cusps, answer.cuspidal) == (claims["cusps"], claims["cuspidal"])
    assert answer.dimension == claims["dimension"]
    assert answer.settled and answer.components == () and answer.curves is None
    assert repr(answer).startswith("<Singularities of outputs: dimension 2, ")


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("planar_2r_limits", {"within_limits": True}),
        ("three_rpr", {"within_limits": True, "orientation": 0.3490658503988659}),
        ("cuspidal_3r", {}),
    ],
)
def test_postures_at_points_of_workspaces(name: str, options: dict[str, Any]) -> None:
    points = numpy.array([point["position"] for point in given(name, "points.json")])
    answer = instance(name).workspace(points, **options)
    claims = expected(name)["workspace"]["points"]
    assert len(answer) == len(claims) == len(points) and answer.settled
    for field, values in (("reachable", answer.reachable()), ("postures", answer.postures())):
        assert values.tolist() == [each[field] for each in claims], field
    if "within_limits" in claims[0]:
        assert [point.within_limits for point in answer] == [each["within_limits"] for each in claims]
    assert answer.points() == pytest.approx(points)


def test_a_point_with_infinitely_many_postures() -> None:
    arm = instance("planar_3r")
    # The tip of the stretched or folded arm is on circles. The outermost and the innermost bound the workspace.
    answer = arm.workspace([[0.6 * r, 0.8 * r] for r in (0.69, 0.71, 5.29, 5.31)])
    assert answer.reachable().tolist() == [False, True, True, False]
    assert answer[1].infinitely_many and answer.postures().tolist() == [0, math.inf, math.inf, 0]
    assert repr(answer) == "<Workspace: 2 of 4 points are reachable>"
    # A single point counts as a list of one.
    assert len(arm.workspace([1, 0.5])) == 1
    with pytest.raises(cg.InputError, match="at least one point"):
        arm.workspace([])
    with pytest.raises(cg.InputError, match="two numbers"):
        arm.workspace([[0, 0], [1, 2, 3]])


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("planar_3r", {}),
        ("planar_2r_limits", {"within_limits": True}),
        ("five_bar_workspace", {}),
        ("three_rpr", {"within_limits": True, "orientation": 0.3490658503988659}),
    ],
)
def test_boundaries_of_workspaces(name: str, options: dict[str, Any]) -> None:
    answer = instance(name).workspace(**options)
    claims = expected(name)["workspace"]
    assert answer.settled and len(answer) == 0 and answer.boundary is not None and answer.boundary_reason is None
    within = claims.get("area_within_limits", {"value": claims.get("area"), "relative_tolerance": 1e-9})
    assert answer.area == pytest.approx(within["value"], rel=within["relative_tolerance"])
    assert repr(answer) == f"<Workspace: area {answer.area:.6g}>"
    if "circles" in claims:
        circles = [(curve.center[0], curve.center[1], curve.radius) for curve in answer.boundary]
        listed = [(*circle["center"], circle["radius"]) for circle in claims["circles"]]
        assert numpy.array(sorted(circles)) == pytest.approx(numpy.array(sorted(listed)))
    if "boundary_from" in claims:
        assert {curve.cause for curve in answer.boundary if curve.on_boundary} == set(claims["boundary_from"])
    for curve in answer.boundary:
        radii = numpy.linalg.norm(curve.array() - numpy.array(curve.center), axis=1)
        assert radii == pytest.approx(numpy.full(len(radii), curve.radius))


def test_a_boundary_that_is_not_known_says_why() -> None:
    with pytest.warns(cg.UnsettledWarning, match="no boundary"):
        answer = instance("cuspidal_3r").workspace()
    assert answer.boundary is None and answer.area is None and answer.max_postures == 4
    assert answer.boundary_reason is not None and repr(answer) == "<Workspace: no area, not settled>"


@pytest.mark.parametrize("name", ["arm_6r", "lift"])
def test_a_jacobian_is_the_derivative_of_the_pose(name: str) -> None:
    if name == "lift":
        arm = cg.Mechanism.from_dh([(0, 0, 0.2, 0.3), (0.4, 0.1, 0.1, 0.7), (0, 0.2, 0.1, 0)], types=["R", "P", "R"])
    else:
        arm = cg.Mechanism.read(EXAMPLES / "arm_6r.json")
    values = dict(zip(arm.joints, [0.3, -0.4, 0.9, 0.2, 0.7, -0.5], strict=False))
    jacobian = arm.jacobian(values)
    assert jacobian.shape == (6, len(values))
    step = 1e-6
    for column, joint in zip(jacobian.T, values, strict=True):
        near = [arm.forward({**values, joint: values[joint] + sign * step})[0].output.matrix() for sign in (1, -1)]
        difference = (near[0] - near[1]) / (2 * step)
        turn = difference[:3, :3] @ arm.forward(values)[0].output.matrix()[:3, :3].T
        assert column == pytest.approx([*difference[:3, 3], turn[2, 1], turn[0, 2], turn[1, 0]], abs=1e-8)
    assert arm.jacobian(arm.forward(values)[0]) == pytest.approx(jacobian)


def test_a_mechanism_with_loops_has_no_jacobian() -> None:
    with pytest.raises(cg.InputError, match="without loops"):
        instance("kite").jacobian({"A0": 0})


def test_what_a_mechanism_says_of_itself(tmp_path: Path) -> None:
    arm = instance("planar_3r")
    assert arm.inputs == ("q1", "q2", "q3") and repr(arm) == "<Mechanism: mechanism.json>"
    rows = [(0, 0.2, 0, QUARTER), (0, 0, 0.5, 0)]
    table = cg.Mechanism.from_dh(rows)
    assert repr(table) == "<Mechanism: mechanism>"
    again = cg.Mechanism.from_json(table.to_json())
    assert again.joints == table.joints
    file = tmp_path / "arm.csv"
    file.write_text(table.to_table())
    values = {"q1": 0.3, "q2": 0.4}
    there = [each.forward(values)[0].output.matrix() for each in (table, again, cg.Mechanism.read(file))]
    assert numpy.allclose(there[0], there[1]) and numpy.allclose(there[0], there[2])


def test_only_the_branch_from_a_posture() -> None:
    arm = cg.Mechanism.read(EXAMPLES / "arm_6r.json")
    values = dict(zip(arm.joints, [0.3, -0.4, 0.9, 0.2, 0.7, -0.5], strict=True))
    start = arm.forward(values)[0].output.matrix()
    end = start.copy()
    end[2, 3] += 0.02
    [branch] = arm.follow([start, end], samples=5, near=values).branches
    assert branch.array(arm.joints)[0] == pytest.approx(list(values.values()), abs=1e-6)


def test_dyads_that_miss_eight_poses_least() -> None:
    poses = []
    for pose in given("eight_poses", "poses.json"):
        cosine, sine = (float(Fraction(x)) for x in pose["angle"])
        poses.append([*(float(Fraction(x)) for x in pose["position"]), math.degrees(math.atan2(sine, cosine))])
    answer = cg.synthesize_approximately("body-guidance", numpy.array(poses))
    claims = expected("eight_poses")
    assert answer.settled and answer.method == "stationary" and answer.objective == "dyad"
    assert answer.stationary is not None and answer.stationary[0] == claims["stationary"]["complex"]
    assert len(answer.minima) == claims["stationary"]["minima"]
    for dyad, reference in zip(answer.minima, claims["dyads"], strict=False):
        assert dyad.error == pytest.approx(reference["error"], rel=1e-6)
        assert dyad.pivot == pytest.approx(complex(*reference["pivot"]), rel=1e-6)
        assert dyad.length == pytest.approx(reference["length"], rel=1e-6)


def test_a_function_generator_for_seven_pairs() -> None:
    pairs = numpy.degrees(given("seven_pairs", "pairs.json"))
    answer = cg.synthesize_approximately("function-generation", pairs)
    claims = expected("seven_pairs")
    assert answer.settled and answer[0].kind == "minimum"
    best = answer[0]
    assert best.error == pytest.approx(claims["error"], rel=claims["relative_tolerance"])
    crank, rocker = (
        numpy.radians(pairs[:, k] + offset) for k, offset in ((0, best.crank_offset), (1, best.rocker_offset))
    )
    ratio = (best.crank**2 - best.coupler**2 + best.rocker**2 + 1) / (2 * best.crank * best.rocker)
    residuals = numpy.cos(rocker) / best.crank - numpy.cos(crank) / best.rocker + ratio - numpy.cos(crank - rocker)
    assert (residuals**2).sum() == pytest.approx(best.error, rel=1e-6)


def test_a_linkage_near_twelve_points() -> None:
    answer = cg.synthesize_approximately("path", given("twelve_points", "points.json"), starts=10)
    assert answer.method == "refined" and answer.stationary is None and answer.settled
    errors = [linkage.error for linkage in answer]
    # This test uses ten random linkages. The known error is from the best of ten thousand.
    assert errors == sorted(errors) and expected("twelve_points")["error"] < errors[0] < 0.02
    assert repr(answer).startswith("<Approximation: ") and repr(answer).endswith(", refined>")
    assert {linkage.kind for linkage in answer[:3]} == {"minimum"}


def test_mistakes_of_approximate_synthesis_are_named() -> None:
    with pytest.raises(cg.InputError, match="expected one of path"):
        cg.synthesize_approximately("nine-point", [])
    with pytest.raises(cg.InputError, match="expected 2 numbers") as raised:
        cg.synthesize_approximately("path", [(0, 0), (1, 2, 3)])
    assert raised.value.field == "rows[1]"
    with pytest.raises(cg.InputError, match="expected more than 5"):
        cg.synthesize_approximately("body-guidance", [(0, 0, 0), (1, 2, 3)])


def test_doubt_is_raised_or_warned(kite: cg.Motion, monkeypatch: pytest.MonkeyPatch) -> None:
    fields = copy.deepcopy(dict(kite.summary))
    fields.update(settled=False, unsettled=["a mode may be missing"], mobility=None)

    def run(*_: object, **__: object) -> program.Finished:
        return program.Finished(program.UNSETTLED, json.dumps(fields), ["a mode may be missing"])

    monkeypatch.setattr(program, "run", run)
    with pytest.warns(cg.UnsettledWarning, match="a mode may be missing") as warnings:
        answer = instance("kite").motion()
    assert len(warnings) == 1 and not answer.settled and answer.open_questions == ("a mode may be missing",)
    assert "mobility not known" in repr(answer) and "not settled" in repr(answer)
    assert str(answer).splitlines()[-1] == "  not settled: a mode may be missing"
    with pytest.raises(cg.Unsettled) as raised:
        instance("kite").motion(strict=True)
    assert raised.value.result == answer


def test_plots() -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    answer = instance("three_rpr").singularities(orientation=0.35, workers=1)
    axes = answer.plot()
    assert len(axes.lines) == 1 and axes.get_xlabel() == "x"
    points = numpy.random.default_rng(1).uniform(-2, 2, (6, 2))
    drawn = instance("planar_2r_limits").workspace(points).plot()
    assert len(drawn.collections) == 1
    cubic = cg.decompose(["x^3 - x - y^2"], workers=1).real_curve()
    assert len(cubic.plot(axes).lines) > 1
    with pytest.raises(ValueError, match="no curve"):
        instance("dead_centres").singularities(workers=1).plot()
