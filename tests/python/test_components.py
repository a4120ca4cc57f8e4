"""Components: known decompositions, points that lie on them or not, samples; doubt and mistakes."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy
import pytest

import cognate as cg

# A sphere, and a point that is not on it.
SPHERE = "(x^2 + y^2 + z^2 - 1)"
SPHERE_AND_POINT = [f"{SPHERE}*(x - 2)", f"{SPHERE}*(y - 1)", f"{SPHERE}*(z - 1/2)"]


@pytest.fixture(scope="module")
def sphere() -> cg.Decomposition:
    return cg.decompose(SPHERE_AND_POINT, workers=1)


def test_components_have_dimension_degree_and_points(sphere: cg.Decomposition) -> None:
    assert [(c.id, c.dimension, c.degree, c.multiplicity) for c in sphere] == [("2.1", 2, 2, 1), ("0.1", 0, 1, 1)]
    assert sphere.settled and len(sphere) == 2 and sphere.of_dimension(1) == []
    assert sphere.array("2.1").shape == (2, 3)
    for x, y, z in sphere["2.1"].points:
        assert abs(x * x + y * y + z * z - 1) < 1e-12
    assert sphere["0.1"].points == ((2, 1, 0.5),)
    with pytest.raises(KeyError):
        sphere["1.1"]


@pytest.mark.parametrize(
    "point",
    [
        {"x": Fraction(3, 5), "y": Fraction(4, 5), "z": 0},
        (0.6, 0.8, 0.0),
        numpy.array([0.6, 0.8, 0.0]),
        # 1 + 5/4 - 5/4 = 1, with z imaginary
        (1.0, 1.25**0.5, 1.25**0.5 * 1j),
    ],
    ids=["exact", "tuple", "array", "complex"],
)
def test_points_are_on_their_components(sphere: cg.Decomposition, point: Any) -> None:
    [found] = sphere.member(point)
    assert found.on == ("2.1",) and found.solves


def test_many_points_at_once(sphere: cg.Decomposition) -> None:
    found = sphere.member(numpy.array([[2, 1, 0.5], [0, 0, 1], [9, 9, 9]]))
    assert [m.on for m in found] == [("0.1",), ("2.1",), ()]
    assert [m.solves for m in found] == [True, True, False]
    assert [m.index for m in found] == [0, 1, 2]


def test_samples_are_on_the_component(sphere: cg.Decomposition) -> None:
    found = sphere.sample(20, components=["2.1"], real=True, box=[(0, 1), (-1, 1), (-1, 1)])
    points = found.array("2.1")
    assert points.shape == (20, 3) and not points.imag.any() and (points.real[:, 0] >= 0).all()
    assert numpy.allclose((points**2).sum(axis=1), 1, atol=1e-12)
    assert [m.on for m in sphere.member(points.real, accuracy=1e-12)] == [("2.1",)] * 20
    near = sphere.sample(1, components="2.1", near=(0, 0, 1)).array()
    assert near.shape == (1, 3)


def test_files_stay_where_they_are_wanted(tmp_path: Path) -> None:
    found = cg.decompose(["x*y"], workers=1, output=tmp_path / "set", certify=True)
    assert sorted(c.degree for c in found) == [1, 1]
    for name in ("witness_data", "main_data", "decomposition.json", "witness_set_1_2", "points/1.2.points"):
        assert (tmp_path / "set" / name).is_file()
    assert found.summary["decomposition"]["components"][0]["certified"] is not None


def test_real_parts_are_seen(tmp_path: Path) -> None:
    node = cg.decompose(["y^2 - x^2*(x + 1)"], workers=1).real_curve(samples=20, axes=["x", "y"])
    assert node.settled and node.components[0]["singular_points"] == 1
    assert len(node.parts[0]["edges"]) >= 3 and node._repr_html_().startswith("<svg")
    assert node.picture.save(tmp_path / "node.svg").read_text() == node.picture.svg
    circle = cg.decompose(["x^2 + y^2 - 1"], workers=1)
    part = circle.real_curve(box={"x": (0, 2), "y": (-2, 2)}, tolerance=1e-3, certify=True)
    [counts] = part.components
    assert part.settled and (counts["arcs_across_box"], counts["closed_loops"]) == (1, 0)
    assert counts["proved_slabs"] == counts["slabs"] > 0 and len(part.parts[0]["edges"][0]["samples"]) > 20
    assert circle.real_curve(projection="x", samples=2).components[0]["closed_loops"] == 1
    with pytest.raises(cg.InputError, match="none for y"):
        circle.real_curve(box={"x": (0, 1)})
    sphere = cg.decompose(["x^2 + y^2 + z^2 - 1"], workers=1).real_surface(samples=4)
    assert sphere.settled and sphere.components[0]["euler"] == 2
    assert len(sphere.parts[0]["triangles"]) > 20
    assert "class Scene" in sphere.picture.save(tmp_path / "sphere.html").read_text()
    assert sphere._repr_html_().startswith("<iframe") and repr(sphere) == "<RealPart: 2.1>"
    with pytest.raises(ValueError, match=r"no drawing"):
        cg.Picture("nothing").save(tmp_path / "nothing.svg")


def test_images_and_degrees_by_groups() -> None:
    cubic = cg.decompose(["y - x^2", "z - x^3"], workers=1)
    [flat] = cubic.project(["x", "y"])
    assert (flat.id, flat.dimension, flat.degree, flat.fiber_dimension, flat.doubts) == ("1.1", 1, 2, 0, ())
    [cusp] = cubic.project("y, z")
    assert (cusp.dimension, cusp.degree, cusp.fiber_degree) == (1, 3, 1)
    graph = cg.decompose(cg.System(["y - x^3"], "x y", groups=[["x"], ["y"]]), workers=1)
    [degrees] = graph.multidegree()
    assert degrees.groups == (("x",), ("y",)) and degrees.degrees == {(1, 0): 1, (0, 1): 3}
    with pytest.raises(cg.InputError, match="expected some of"):
        cubic.project(["w"])


def test_freedoms_at_points() -> None:
    node = cg.decompose(["y^2 - x^2*(x + 1)"], workers=1)
    found = node.mobility([(0, 0), {"x": -1, "y": 0}], depth=3)
    assert [(point.infinitesimal, point.local, point.on) for point in found] == [(2, 1, ("1.1",)), (1, 1, ("1.1",))]
    assert found[0].dimensions_by_order[:3] == (1, 3, 5) and len(found[0].reason) > 10


def test_common_points_are_components() -> None:
    sphere = cg.decompose(["x^2 + y^2 + z^2 - 1"], workers=1)
    circle = sphere.intersect("z - 3/5")
    assert [(c.dimension, c.degree) for c in circle] == [(1, 2)] and circle.settled
    # The result accepts further questions.
    assert circle.member((Fraction(4, 5), 0, Fraction(3, 5)))[0].on == ("1.1",)
    cone = cg.decompose(["x^2 + y^2 - z^2"], workers=1)
    assert sum(c.degree for c in sphere.intersect(cone, components="2.1", others=["2.1"])) == 4
    locus = cone.singular_locus()
    assert [c.dimension for c in locus] == [0] and abs(locus.array("0.1")).max() < 1e-12


def test_real_points_and_proofs() -> None:
    cubic = cg.decompose(["x^3 - x - y^2"], workers=1)
    found = cubic.real_points()
    assert found.settled and found.has_real_points == {"1.1": True}
    x, y = found.array("1.1").T
    assert numpy.allclose(x**3 - x, y**2) and (x > 0.5).any() and (x < 0.5).any()
    assert cg.decompose(["x^2 + y^2 + 1"], workers=1).real_points().has_real_points == {"1.1": False}
    [proofs] = cubic.certify()
    assert (proofs.points, proofs.certified, proofs.distinct) == (3, 3, True)


def test_parameters_of_more_solutions() -> None:
    lines = cg.System(["a*x + b*y", "c*x + d*y"], "x y", parameters="a b c d")
    found = cg.exceptional(lines, 1, workers=1)
    determinant = found[0]
    assert found.settled and found.parameters == ("a", "b", "c", "d") and len(found.products) >= 1
    assert (determinant.dimension, determinant.codimension, determinant.degree) == (3, 1, 2)
    a, b, c, d = determinant.point.values()
    assert abs(a * d - b * c) < 1e-9
    # All coefficients 0: a plane of solutions.
    plane = cg.exceptional(lines, 2, workers=1)
    assert [each.dimension for each in plane] == [0] and repr(plane) == "<ExceptionalSets: 1 set for dimension 2>"
    with pytest.raises(cg.InputError, match="no parameters"):
        cg.exceptional(["x*y"], 1)


def test_a_service_does_it(service: cg.Service) -> None:
    found = cg.decompose(["x^2 - y^3"], service=service)
    assert [(c.dimension, c.degree) for c in found] == [(1, 3)]
    assert [m.on for m in found.member([(1, 1), (8, 4), (1, 2)])] == [("1.1",), ("1.1",), ()]
    jobs = service.jobs()
    assert len(jobs) >= 2


def test_mistakes_are_named(sphere: cg.Decomposition) -> None:
    with pytest.raises(cg.InputError, match="expected 3 coordinates, found 2") as raised:
        sphere.member([(1, 2, 3), (1, 2)])
    assert raised.value.field == "points[1]"
    with pytest.raises(cg.InputError, match="at least one point"):
        sphere.member([])
    with pytest.raises(cg.InputError, match="9.9"):
        sphere.sample(1, components="9.9")
    with pytest.raises(cg.InputError, match="none for y"):
        sphere.sample(1, box={"x": (0, 1)})
    with pytest.raises(cg.InputError) as equation:
        cg.decompose(["x^2 +"])
    assert equation.value.field == "equations[0]"


def test_doubt_is_raised_or_warned(sphere: cg.Decomposition) -> None:
    summary = {
        **sphere.summary,
        "settled": False,
        "decomposition": {**sphere.summary["decomposition"], "unsettled": ["a trace is not linear"]},
    }
    from cognate import components

    found = components._read(summary, sphere.folder, (), None)
    assert not found.settled and found.open_questions == ("a trace is not linear",)
    assert "not settled" in repr(found)
