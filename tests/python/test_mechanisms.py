"""Mechanisms and synthesis: known numbers of positions, round trips, the units of angles, mistakes."""

from __future__ import annotations

import asyncio
import json
import math
import re
from pathlib import Path

import numpy
import pytest

import cognate as cg
from conftest import EXAMPLES

TURN_AND_LIFT = """<robot name="crane">
 <link name="base"/><link name="upper"/><link name="lower"/><link name="hand"/>
 <joint name="q1" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
  <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
 <joint name="q2" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="2 0 0"/><axis xyz="0 0 1"/>
  <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
 <joint name="tool" type="fixed"><parent link="lower"/><child link="hand"/><origin xyz="1 0 0"/></joint>
</robot>
"""


@pytest.fixture(scope="module")
def arm() -> cg.Mechanism:
    return cg.Mechanism.read(EXAMPLES / "arm_6r.json")


def chain(theta: float, d: float, a: float, alpha: float) -> numpy.ndarray:
    """A Denavit-Hartenberg row as a matrix, by the textbook formula."""
    c, s, ca, sa = math.cos(theta), math.sin(theta), math.cos(alpha), math.sin(alpha)
    return numpy.array([[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]])


def test_every_posture_of_an_arm_reaches_its_pose(arm: cg.Mechanism) -> None:
    poses = json.loads((EXAMPLES / "arm_6r_poses.json").read_text())
    found = arm.inverse(poses[:3])
    assert [p.counts["complex"] for p in found] == [16, 16, 16]
    rows = json.loads((EXAMPLES / "arm_6r.json").read_text())["serial"]["joints"]
    for pose, postures in zip(poses, found, strict=False):
        assert postures.settled and len(postures) == postures.counts["real"] > 0
        wanted = numpy.eye(4)
        wanted[:3, :3], wanted[:3, 3] = pose["rotation"], pose["position"]
        for q in postures.array(["q1", "q2", "q3", "q4", "q5", "q6"]):
            reached = numpy.eye(4)
            for angle, row in zip(q, rows, strict=True):
                reached = reached @ chain(angle + row.get("theta", 0), row["d"], row["a"], row["alpha"])
            assert numpy.allclose(reached, wanted, atol=1e-7)
        for posture in postures:
            assert numpy.allclose(posture.output.matrix(), wanted, atol=1e-7)


def test_a_matrix_is_a_pose(arm: cg.Mechanism) -> None:
    pose = json.loads((EXAMPLES / "arm_6r_poses.json").read_text())[0]
    matrix = numpy.eye(4)
    matrix[:3, :3], matrix[:3, 3] = pose["rotation"], pose["position"]
    one = arm.inverse(matrix)
    assert isinstance(one, cg.Positions) and numpy.asarray(one).shape == (len(one), 6)
    several = arm.inverse(numpy.array([matrix, matrix]))
    assert [len(p) for p in several] == [len(one)] * 2
    again = arm.inverse(one[0].output)
    assert numpy.allclose(sorted(again.array().tolist()), sorted(one.array().tolist()), atol=1e-6)


def test_an_arm_goes_forward_and_back(arm: cg.Mechanism) -> None:
    values = dict(zip(arm.joints, (0.3, -0.8, 1.1, 0.4, -1.2, 2.0), strict=True))
    there = arm.forward(values)
    assert len(there) == 1 and there.settled
    rows = json.loads((EXAMPLES / "arm_6r.json").read_text())["serial"]["joints"]
    reached = numpy.eye(4)
    for angle, row in zip(values.values(), rows, strict=True):
        reached = reached @ chain(angle + row.get("theta", 0), row["d"], row["a"], row["alpha"])
    assert numpy.allclose(there[0].output.matrix(), reached, atol=1e-12)
    back = arm.inverse(there[0].output)
    assert min(numpy.abs(q - list(values.values())).max() for q in back.array(arm.joints)) < 1e-6
    held = cg.Mechanism.read(EXAMPLES / "arm_6r.json", lock={"q4": 0.4})
    others = {name: value for name, value in values.items() if name != "q4"}
    assert numpy.allclose(held.forward(others)[0].output.matrix(), reached, atol=1e-12)


def test_rows_are_an_arm() -> None:
    rows = [(0, 0.1625, 0, math.pi / 2), (0, 0, -0.425, 0), (0, 0, -0.3922, 0)]
    rows += [(0, 0.1333, 0, math.pi / 2), (0, 0.0997, 0, -math.pi / 2), (0, 0.0996, 0, 0)]
    arm = cg.Mechanism.from_dh(rows)
    reached = numpy.eye(4)
    angles = (0.2, -1.0, 0.7, 0.4, 0.9, -0.3)
    for angle, row in zip(angles, rows, strict=True):
        reached = reached @ chain(angle + row[0], *row[1:])
    there = arm.forward(dict(zip(arm.joints, angles, strict=True)))
    assert numpy.allclose(there[0].output.matrix(), reached, atol=1e-12)
    with pytest.raises(cg.InputError, match="four numbers"):
        cg.Mechanism.from_dh([(0, 0, 0)])


def test_a_table_in_radians_names_its_unit(tmp_path: Path) -> None:
    file = tmp_path / "arm.csv"
    file.write_text("theta,d,a,alpha\n0,0.1625,0,1.5707963\n0,0,-0.425,0\n")
    with pytest.raises(cg.InputError, match="# angles: rad"):
        cg.Mechanism.read(file).info()
    file.write_text("# angles: rad\n" + file.read_text())
    assert cg.Mechanism.read(file, snap=False).forward(q1=0, q2=0)[0].output is not None


def test_a_platform_has_forty_positions() -> None:
    platform = cg.Mechanism.read(EXAMPLES / "hexapod.toml")
    lengths = json.loads((EXAMPLES / "hexapod_lengths.json").read_text())[0]
    found = platform.forward(**lengths)
    assert (found.counts["complex"], found.counts["real"], found.settled) == (40, 4, True)
    bodies = platform.info()
    assert bodies["name"] == "hexapod"
    assert len(platform.forward([lengths, lengths])) == 2


def test_a_urdf_is_read_and_angles_are_radians(tmp_path: Path) -> None:
    file = tmp_path / "crane.urdf"
    file.write_text(TURN_AND_LIFT)
    crane = cg.Mechanism.from_urdf(file)
    assert [j["name"] for j in crane.info()["joints"]] == ["q1", "q2"]
    # Two joints reach few poses. The test uses one reachable pose, and one at the base that is not reachable.
    reached = crane.forward(q1=0.3, q2=0.2)[0].output
    found = crane.inverse(reached)
    assert found.settled and found.array() == pytest.approx(numpy.array([[0.3, 0.2]]))
    with pytest.warns(cg.CognateWarning, match="does not reach"):
        nothing = crane.inverse(numpy.eye(4))
    assert nothing.settled and len(nothing) == 0


def test_an_aligned_wrist_has_a_set_of_postures() -> None:
    lengths = [(0, 0), (0, 0.4318), (0.15, 0.0203), (0.4318, 0), (0, 0), (0, 0)]
    twists = [90, 0, -90, 90, -90, 0]
    puma = cg.Mechanism.from_dh([(0, d, a, math.radians(twist)) for (d, a), twist in zip(lengths, twists, strict=True)])
    names = puma.joints
    pose = puma.forward(dict(zip(names, [0.3, -0.8, 0.5, 0.7, 0.0, -1.2], strict=True)))[0].output
    found = puma.inverse(pose)
    assert found.settled and [set_.dimension for set_ in found.sets] == [1]
    aligned = found.sets[0]
    assert aligned.closed and aligned.joints == (names[3], names[5])
    assert aligned.spans[names[3]] == pytest.approx(2 * math.pi)
    assert aligned.posture.singular and aligned.posture in list(found)


def test_equations_are_a_system(arm: cg.Mechanism) -> None:
    system = arm.equations("inverse")
    assert len(system.variables) == 8 and system.parameters


@pytest.mark.parametrize(
    ("pose", "words"),
    [
        (numpy.ones((4, 4)), "last row"),
        (numpy.eye(5), "homogeneous matrix"),
        ({"position": [0, 0, 0], "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 2]]}, "rotation"),
    ],
    ids=["row", "size", "rotation"],
)
def test_what_is_no_pose_is_refused(arm: cg.Mechanism, pose: object, words: str) -> None:
    with pytest.raises(cg.InputError, match=words):
        arm.inverse(pose)


def test_positions_are_shown(arm: cg.Mechanism, tmp_path: Path) -> None:
    poses = json.loads((EXAMPLES / "arm_6r_poses.json").read_text())
    page = arm.show(poses[0], certify=True)
    data = json.loads(re.search(r'id="data">(.*?)</script>', page.html or "")[1])  # type: ignore[index]
    assert data["counts"][0] == ["complex", 16] and len(data["bodies"]) == 7
    assert all(found["proved"] for found in data["sets"])
    assert page.save(tmp_path / "arm.html").read_text() == page.html
    with pytest.raises(TypeError, match="found both"):
        arm.show(poses[0], inputs={"q1": 1.0})


def test_linkages_for_five_poses() -> None:
    # All four dyads of this example are real: six linkages (source: deploy/examples/five_poses.csv).
    found = cg.synthesize("body-guidance", EXAMPLES / "five_poses.csv", workers=1)
    assert len(found) == 6 and found.settled and repr(found) == "<Synthesis: 6 linkages>"
    rows = [line.split(",") for line in (EXAMPLES / "five_poses.csv").read_text().splitlines()[2:]]
    again = cg.synthesize("body-guidance", [[float(x) for x in row] for row in rows], workers=1)
    assert sorted(abs(p) for linkage in again for p in linkage.pivots) == pytest.approx(
        sorted(abs(p) for linkage in found for p in linkage.pivots)
    )
    for linkage in found:
        first, second = linkage.pivots
        lengths = linkage.data["lengths"]
        assert abs(first - second) == pytest.approx(lengths["ground"])


def test_a_crank_for_three_timed_poses() -> None:
    # The crank turns about (0, 0) with its joint at (1, 0), the body about the joint: a point of it at distance 1.
    turn = numpy.deg2rad
    poses = []
    for crank, angle in ((0, 0), (30, -20), (70, -25)):
        joint = numpy.array([numpy.cos(turn(crank)), numpy.sin(turn(crank))])
        place = joint + numpy.array([numpy.cos(turn(angle)), numpy.sin(turn(angle))])
        poses.append((*place, angle, crank))
    found = cg.synthesize("body-guidance-timing", poses, pivots=[(3, -1)], workers=1)
    assert found.settled and len(found) == 1
    assert found[0].pivots == pytest.approx((0, 3 - 1j), abs=1e-9)
    assert found[0].joints[0] == pytest.approx(1, abs=1e-9)
    with pytest.raises(cg.InputError, match="expected three poses, found 2"):
        cg.synthesize("body-guidance-timing", poses[:2])


def test_chains_in_space_for_seven_poses() -> None:
    # Twenty complex chains of two balls (C. Innocenti 1995); one made the poses: its ball stays 2 away from a point.
    random = numpy.random.default_rng(3)
    centre, ball = numpy.array([1.0, 1.0, 0.0]), numpy.array([0.5, -0.25, 1.0])
    poses = []
    for _ in range(7):
        turn, _ = numpy.linalg.qr(random.normal(size=(3, 3)))
        turn *= numpy.linalg.det(turn)
        away = random.normal(size=3)
        pose = numpy.eye(4)
        pose[:3, :3] = turn
        pose[:3, 3] = centre + 2 * away / numpy.linalg.norm(away) - turn @ ball
        poses.append(pose)
    found = cg.synthesize_spatial("SS", poses, workers=1, certify=True)
    assert found.settled and found.summary["paths"]["finite"] == 20
    assert any(dyad.fixed["point"] == pytest.approx(tuple(centre)) for dyad in found)
    assert all(dyad.certified for dyad in found) and len(found) % 2 == 0
    with pytest.raises(cg.InputError, match="expected 6 poses, found 7"):
        cg.synthesize_spatial("PPS", poses)


def test_mistakes_of_synthesis_are_named() -> None:
    with pytest.raises(cg.InputError, match="expected one of nine-point"):
        cg.synthesize("ten-point", [])
    with pytest.raises(cg.InputError, match="expected 3 numbers") as raised:
        cg.synthesize("body-guidance", [(0, 0, 0), (1, 2)])
    assert raised.value.field == "rows[1]"
    with pytest.raises(cg.InputError, match="five"):
        cg.synthesize("body-guidance", [(0, 0, 0), (1, 2, 3)])


def test_a_served_arm_answers_as_the_program_does(arm: cg.Mechanism) -> None:
    random = numpy.random.default_rng(4)
    names = arm.joints
    targets = [dict(zip(names, random.uniform(-2, 2, len(names)), strict=True)) for _ in range(300)]
    poses = [found[0].output for found in arm.forward(targets)]
    expected = arm.inverse(poses)
    with arm.served() as served:
        found = served.inverse(poses)
        assert [len(one) for one in found] == [len(one) for one in expected]
        assert served.inverse(poses[7]).array() == pytest.approx(expected[7].array())
        matrices = numpy.stack([pose.matrix() for pose in poses])
        values, offsets = served.inverse_array(matrices)
        assert values.shape == (offsets[-1], len(names)) and offsets.shape == (301,)
        assert values[offsets[7] : offsets[8]] == pytest.approx(expected[7].array())
        with pytest.raises(cg.InputError, match=r"poses\[1\]"):
            served.inverse([poses[0], {"position": [0, 0, 0], "quaternion": [3, 0, 0, 0]}])
        # A refused pose has no effect on later poses.
        assert len(served.inverse(poses[0])) == len(expected[0])
    with pytest.raises(cg.ServiceError, match="closed"):
        served.inverse(poses[0])


def test_a_pose_of_four_digits_is_rounded_and_said(arm: cg.Mechanism) -> None:
    pose = {"position": [0.4, 0.2, 0.3], "quaternion": [0.7071, 0.7071, 0, 0]}
    with pytest.warns(cg.CognateWarning, match="its rotation is off"):
        rounded = arm.inverse(pose)
    exact = arm.inverse({"position": [0.4, 0.2, 0.3], "quaternion": [0.5**0.5, 0.5**0.5, 0, 0]})
    assert rounded.array() == pytest.approx(exact.array())


def test_branches_of_an_arm_along_a_line(arm: cg.Mechanism) -> None:
    start = arm.forward(dict(zip(arm.joints, [0.3, -0.4, 0.9, 0.2, 0.7, -0.5], strict=True)))[0].output.matrix()
    end = start.copy()
    end[2, 3] += 0.05
    path = arm.follow([start, end], samples=9)
    assert path.settled and path.samples >= 9 and path.branches
    for branch in path.branches:
        assert {branch.begins, branch.ends} <= {"path", "fold"}
        assert branch.array().shape == (len(branch), len(arm.joints))
    at_folds = sum((branch.begins == "fold") + (branch.ends == "fold") for branch in path.branches)
    assert at_folds == 2 * len(path.folds)
    with pytest.raises(TypeError, match="poses or inputs"):
        arm.follow()


def test_points_and_directions_are_enough_for_short_arms() -> None:
    quarter = math.pi / 2
    leg = cg.Mechanism.from_dh([(0, 0.1, 0.05, quarter), (0, 0, 0.3, 0), (0, 0.02, 0.28, 0)])
    points = numpy.array([[0.25, 0.1, 0.3], [0.1, -0.3, 0.2]])
    for point, postures in zip(points, leg.inverse(points, task="position"), strict=True):
        assert len(postures) == 4 and postures.settled
        for posture in postures:
            assert posture.output is not None and posture.output.position == pytest.approx(point, abs=1e-9)
    with leg.served(task="position") as served:
        assert len(served.inverse(points[0])) == 4
    with pytest.warns(cg.CognateWarning, match="does not reach"):
        assert len(leg.inverse([9, 0, 0], task="position")) == 0
    with pytest.raises(cg.InputError, match="expected pose, position"):
        leg.inverse({"position": [0.2, 0.1, 0.3]}, task="place")
    with pytest.raises(cg.InputError, match="expected a matrix"):
        leg.inverse(points[0])


def test_a_redundant_arm_is_answered_at_values_of_a_joint() -> None:
    quarter = math.pi / 2
    twists = [-quarter, quarter, quarter, -quarter, -quarter, quarter, 0]
    rows = [(0, d, 0, alpha) for d, alpha in zip([0.34, 0, 0.4, 0, 0.4, 0, 0.126], twists, strict=True)]
    arm = cg.Mechanism.from_dh(rows)
    with pytest.raises(cg.InputError, match="--sweep"):
        arm.inverse({"position": [0.4, 0.1, 0.5]})
    found = arm.inverse({"position": [0.4, 0.1, 0.5], "quaternion": [0.5, 0.5, 0.5, 0.5]}, sweep="q3", samples=4)
    assert len(found) == 4 and all(postures.settled for postures in found)
    for postures, value in zip(found, [-math.pi, -quarter, 0, quarter], strict=True):
        for posture in postures:
            assert math.cos(posture.joints["q3"] - value) == pytest.approx(1)


def test_a_served_platform_answers_values_of_its_inputs() -> None:
    platform = cg.Mechanism.read(EXAMPLES / "hexapod.toml")
    lengths = json.loads((EXAMPLES / "hexapod_lengths.json").read_text())[0]
    expected = platform.forward(lengths)
    with platform.served(forward=True) as served:
        found = served.forward([lengths, lengths])
        assert [(one.counts["complex"], len(one)) for one in found] == [(40, len(expected))] * 2
        waited = asyncio.run(served.forward_async(lengths))
        assert waited.array() == pytest.approx(found[0].array())
        with pytest.raises(cg.InputError, match="the value of this input") as raised:
            served.forward([lengths, {}])
        assert raised.value.field == "inputs[1]"
        with pytest.raises(cg.InputError, match="by name"):
            served.forward([[1, 2]])  # type: ignore[list-item]
        with pytest.raises(cg.ServiceError, match="open another"):
            served.inverse(numpy.eye(4))


def test_a_served_arm_can_be_awaited(arm: cg.Mechanism) -> None:
    pose = arm.forward(dict(zip(arm.joints, [0.3, -0.4, 0.9, 0.2, 0.7, -0.5], strict=True)))[0].output

    async def ask() -> list[cg.Positions]:
        return list(await asyncio.gather(*(served.inverse_async(pose) for _ in range(3))))

    with arm.served() as served:
        found = asyncio.run(ask())
        assert len({len(one) for one in found}) == 1 and len(found[0]) > 0
        with pytest.raises(cg.ServiceError, match=r"served\(forward=True\)"):
            served.forward({"q1": 0.0})
