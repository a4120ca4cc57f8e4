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
    for name in ("witness_data", "main_data", "decomposition.json"):
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
