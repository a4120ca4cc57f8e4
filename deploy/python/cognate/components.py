"""Components: all irreducible components of all dimensions, their witness points, and questions about them."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import exact, expressions, program
from .answers import Image, Multidegree, PointMobility, Proofs, RealPoints
from .command_line import option_words
from .errors import (
    CognateWarning,
    InputError,
    Unsettled,
    UnsettledWarning,
    in_the_users_words,
    not_settled,
    warn,
)
from .picture import Picture
from .progress import Bar, Wanted
from .system import problem_file

if TYPE_CHECKING:
    import numpy
    from numpy.typing import NDArray

    from .service import Service

Point = tuple[complex, ...]
"""Coordinates in the order of the variables."""

Ranges = Sequence[tuple[float, float]] | Mapping[str, tuple[float, float]]
"""Two numbers for each variable, in their order or by name."""


@dataclass(frozen=True)
class Component:
    """One irreducible component.

    `id`: its name, such as `2.1`, dimension first. `degree`; `multiplicity`: None if not known.
    `irreducible`: `yes`, `unsettled` or `not_asked`. `self_conjugate`: conjugation maps it to itself, or None. `orbit`:
    number of its orbit under the symmetry group among the orbits of its dimension, or None. `points`: its witness
    points, as many as its degree. `count`: number of components in this entry: very many isolated points of one
    kind are listed together, with their `points` in `Decomposition.witness_points`.
    """

    id: str
    dimension: int
    degree: int
    multiplicity: int | None
    irreducible: str
    self_conjugate: bool | None
    orbit: int | None
    count: int
    points: tuple[Point, ...]


@dataclass(frozen=True)
class Membership:
    """The components that contain a point: `on`: their ids. `solves`: the point solves the equations.

    `unsettled`: components for which the answer is not known.
    """

    index: int
    on: tuple[str, ...]
    solves: bool | None
    unsettled: tuple[str, ...]


@dataclass(frozen=True)
class Sample:
    """Points of components: `points`, by component id."""

    variables: tuple[str, ...]
    points: Mapping[str, tuple[Point, ...]]
    settled: bool
    summary: Mapping[str, Any]

    def array(self, component: str | None = None) -> NDArray[numpy.complex128]:
        """The points of one component, or of all, as an array of shape (points, variables)."""
        import numpy

        chosen = self.points.values() if component is None else [self.points[component]]
        rows = [point for points in chosen for point in points]
        return numpy.array(rows, dtype=numpy.complex128).reshape(len(rows), len(self.variables))


@dataclass(frozen=True, repr=False)
class RealPart:
    """The real part of curves or surfaces; a notebook shows its picture.

    `components`: counts of each component, as in the program's table. `parts`: vertices with their points and edges
    with their samples, or vertices and triangles. `settled`: nothing is in doubt. `picture`: a drawing; in three
    variables also a page with a view that can be turned.
    """

    components: tuple[Mapping[str, Any], ...]
    parts: tuple[Mapping[str, Any], ...]
    settled: bool
    picture: Picture
    summary: Mapping[str, Any]

    def __repr__(self) -> str:
        """The components."""
        shown = ", ".join(str(c["id"]) for c in self.components)
        return f"<RealPart: {shown}{'' if self.settled else ', not settled'}>"

    def _repr_html_(self) -> str:
        return self.picture._repr_html_()

    def plot(self, axes: Any = None, *, plane: tuple[int, int] = (0, 1)) -> Any:
        """Draws real curves by matplotlib, into `axes` or a new figure; gives the axes.

        `plane`: the two coordinates that are shown, by their numbers from 0.
        """
        from .drawing import plane_axes

        axes = plane_axes(axes)
        for number, part in enumerate(self.parts):
            if "edges" not in part:
                raise ValueError("expected curves; a surface is shown by its picture")
            for edge in part["edges"]:
                x, y = ([point[k][0] for point in edge["samples"]] for k in plane)
                axes.plot(x, y, color=f"C{number}")
        return axes


@dataclass(frozen=True, repr=False)
class Decomposition:
    """All irreducible components of all requested dimensions.

    `components`: the highest dimension first. `witness_points`: by id. `settled`: every claim is settled;
    `open_questions`: a sentence for each other claim. `summary`: the program's own answer. `folder`: the files that
    `member` and `sample` read.
    """

    variables: tuple[str, ...]
    components: tuple[Component, ...]
    witness_points: Mapping[str, tuple[Point, ...]]
    settled: bool
    open_questions: tuple[str, ...]
    warnings: tuple[str, ...]
    summary: Mapping[str, Any]
    folder: Path
    _where: tuple[str, ...] = ()
    # A temporary folder. It is removed with the last object that needs it.
    _kept: object = field(default=None, compare=False)

    def __repr__(self) -> str:
        """Dimensions and degrees."""
        shown = ", ".join(
            f"{c.id} of degree {c.degree}" + (f" ({c.count} of them)" if c.count > 1 else "") for c in self.components
        )
        return f"<Decomposition: {shown or 'no components'}{'' if self.settled else ', not settled'}>"

    def __iter__(self) -> Any:
        """The components."""
        return iter(self.components)

    def __len__(self) -> int:
        """Number of components."""
        return sum(component.count for component in self.components)

    def __getitem__(self, id: str) -> Component:
        """The component with this id."""
        for component in self.components:
            if component.id == id:
                return component
        raise KeyError(id)

    @property
    def removed(self) -> Mapping[str, Any]:
        """Components that do not belong to the given equations, by reason: `dimension`, `degree`, `count`."""
        found: Mapping[str, Any] = self.summary["decomposition"].get("removed") or {}
        return found

    def of_dimension(self, dimension: int) -> list[Component]:
        """The components of one dimension."""
        return [c for c in self.components if c.dimension == dimension]

    def array(self, id: str) -> NDArray[numpy.complex128]:
        """The witness points of a component as an array of shape (degree, variables)."""
        import numpy

        rows = self.witness_points[id]
        return numpy.array(rows, dtype=numpy.complex128).reshape(len(rows), len(self.variables))

    def member(
        self,
        points: object,
        *,
        components: Iterable[str] = (),
        accuracy: float | None = None,
        strict: bool = False,
        progress: Wanted = None,
    ) -> list[Membership]:
        """The components that contain given points.

        `points`: one or many; each a mapping by names, a solution, or coordinates in order. Exact numbers stay
        exact. Floats are as accurate as their digits, unless `accuracy` gives the error relative to the point's size.

        >>> import cognate as cg
        >>> found = cg.decompose(["(x^2 + y^2 - 1)*(x - 2)", "(x^2 + y^2 - 1)*(y - 3)"], workers=1)
        >>> [m.on for m in found.member([{"x": 1, "y": 0}, (2, 3), (5, 5)])]
        [('1.1',), ('0.1',), ()]
        """
        more = option_words(accuracy=accuracy)
        listed = _points(points, self.variables)
        summary = self._ask("member", more, components, strict, progress, {"points": listed})
        return [
            Membership(
                index=int(p["index"]),
                on=tuple(_ids(p["on"])),
                solves=p.get("solves"),
                unsettled=tuple(_ids(p.get("unsettled") or [])),
            )
            for p in summary["points"]
        ]

    def sample(
        self,
        count: int,
        *,
        components: Iterable[str] = (),
        real: bool = False,
        near: object = None,
        box: Ranges | None = None,
        strict: bool = False,
        progress: Wanted = None,
    ) -> Sample:
        """Points of components: `count` of each. `real`: only real points; `box`: only real points between two
        numbers for each variable; `near`: points near a point.

        >>> import cognate as cg
        >>> circle = cg.decompose(["x^2 + y^2 - 1"], workers=1)
        >>> found = circle.sample(5, real=True)
        >>> found.array().shape, all(abs(x * x + y * y - 1) < 1e-12 for x, y in found.points["1.1"])
        ((5, 2), True)
        """
        more = [*option_words(count=count), *self._box(box)]
        if real:
            more += option_words(real=True)
        files = {} if near is None else {"near": _points([near], self.variables)}
        summary = self._ask("sample", more, components, strict, progress, files)
        rest = iter(summary["points"])
        points = {
            str(block["id"]): tuple(tuple(complex(re, im) for re, im in next(rest)) for _ in range(int(block["count"])))
            for block in summary["components"]
        }
        return Sample(self.variables, points, bool(summary["settled"]), summary)

    def real_curve(
        self,
        *,
        components: Iterable[str] = (),
        samples: int | None = None,
        tolerance: float | None = None,
        box: Ranges | None = None,
        projection: str | None = None,
        certify: bool = False,
        axes: Sequence[str] = (),
        strict: bool = False,
        progress: Wanted = None,
    ) -> RealPart:
        """The real part of curves: arcs between vertices, loops, singular points.

        `samples`: points of each arc; `tolerance`: largest distance of arcs from the lines between samples, with more
        samples if needed; `box`: only the part between two numbers for each variable; `projection`: the variable
        whose values divide the curve, instead of a random form; `certify`: prove the number of real branches of each
        slab; `axes`: the two variables of the drawing.

        >>> import cognate as cg
        >>> circle = cg.decompose(["x^2 + y^2 - 1"], workers=1).real_curve()
        >>> circle.components[0]["closed_loops"], circle.settled
        (1, True)
        """
        more = option_words(samples=samples)
        more += option_words(tolerance=None if tolerance is None else float(tolerance), projection=projection)
        more += option_words(certify=bool(certify))
        more += option_words(axes=",".join(axes) if axes else None)
        more += self._box(box)
        return self._real("real-curve", "curve", more, components, strict, progress)

    def real_surface(
        self,
        *,
        components: Iterable[str] = (),
        samples: int | None = None,
        strict: bool = False,
        progress: Wanted = None,
    ) -> RealPart:
        """The real part of surfaces in three variables: triangles, curves, points. `samples`: points of each edge."""
        more = option_words(samples=samples)
        return self._real("real-surface", "surface", more, components, strict, progress)

    def project(
        self, onto: Iterable[object], *, components: Iterable[str] = (), strict: bool = False, progress: Wanted = None
    ) -> list[Image]:
        """Dimension and degree of the closures of the components' images in the variables `onto`.

        >>> import cognate as cg
        >>> cubic = cg.decompose(["x*z - y^2", "y - z^2", "x - y*z"], workers=1)
        >>> [(image.dimension, image.degree, image.fiber_dimension) for image in cubic.project("y z")]
        [(1, 2, 0)]
        """
        names = expressions.name_list(onto, "onto")
        summary = self._ask("project", option_words(onto=",".join(names)), components, strict, progress, {})
        return [Image.from_json(fields) for fields in summary["components"]]

    def multidegree(
        self, *, components: Iterable[str] = (), strict: bool = False, progress: Wanted = None
    ) -> list[Multidegree]:
        """Degrees of components by groups of variables.

        >>> import cognate as cg
        >>> graph = cg.decompose(cg.System(["y - x^3"], "x y", groups=[["x"], ["y"]]), workers=1)
        >>> graph.multidegree()[0].degrees
        {(1, 0): 1, (0, 1): 3}
        """
        summary = self._ask("multidegree", [], components, strict, progress, {})
        return [Multidegree.from_json(fields, summary["groups"]) for fields in summary["components"]]

    def mobility(
        self,
        points: object,
        *,
        components: Iterable[str] = (),
        accuracy: float | None = None,
        depth: int | None = None,
        strict: bool = False,
        progress: Wanted = None,
    ) -> list[PointMobility]:
        """Numbers of directions in which points can move along the solutions: to first order, and truly.

        `points` and `accuracy`: as for `member`. `depth`: the highest order of motions that is examined.

        >>> import cognate as cg
        >>> node = cg.decompose(["y^2 - x^2*(x + 1)"], workers=1)
        >>> [(point.infinitesimal, point.local) for point in node.mobility([{"x": 0, "y": 0}, {"x": -1, "y": 0}])]
        [(2, 1), (1, 1)]
        """
        more = option_words(accuracy=accuracy)
        more += option_words(depth=depth)
        listed = _points(points, self.variables)
        summary = self._ask("mobility", more, components, strict, progress, {"at": listed})
        return [PointMobility.from_json(fields) for fields in summary["points"]]

    def real_points(
        self, *, components: Iterable[str] = (), strict: bool = False, progress: Wanted = None
    ) -> RealPoints:
        """At least one point on every connected part of the components' real points.

        >>> import cognate as cg
        >>> cubic = cg.decompose(["x^3 - x - y^2"], workers=1)
        >>> cubic.real_points().has_real_points
        {'1.1': True}
        """
        return RealPoints.from_json(self.variables, self._ask("real-points", [], components, strict, progress, {}))

    def certify(self, *, components: Iterable[str] = (), strict: bool = False, progress: Wanted = None) -> list[Proofs]:
        """Proves that witness points of components exist, and counts the proved points."""
        summary = self._ask("certify", [], components, strict, progress, {})
        return [Proofs.from_json(fields) for fields in summary["components"]]

    def intersect(
        self,
        other: object,
        *,
        components: Iterable[str] = (),
        others: Iterable[str] = (),
        strict: bool = False,
        progress: Wanted = None,
    ) -> Decomposition:
        """Intersections of components with those of another `Decomposition`, or with the solutions of equations.

        `other`: a decomposition in the same variables, or equations as for `solve`. `components`, `others`: ids of
        the components to intersect, by default all.

        >>> import cognate as cg
        >>> sphere = cg.decompose(["x^2 + y^2 + z^2 - 1"], workers=1)
        >>> sphere.intersect(["z - 1/2"])
        <Decomposition: 1.1 of degree 2>
        """
        more = option_words(other=[others] if isinstance(others, str) else list(others))
        return self._set("intersect", more, components, strict, progress, other)

    def singular_locus(
        self, *, components: Iterable[str] = (), strict: bool = False, progress: Wanted = None
    ) -> Decomposition:
        """The points of components at which the equations lose rank.

        >>> import cognate as cg
        >>> node = cg.decompose(["y^2 - x^2*(x + 1)"], workers=1)
        >>> node.singular_locus()
        <Decomposition: 0.1 of degree 1>
        """
        return self._set("singular-locus", [], components, strict, progress)

    def _set(
        self,
        question: str,
        more: list[str],
        components: Iterable[str],
        strict: bool,
        progress: Wanted,
        other: object = None,
    ) -> Decomposition:
        """Runs a question whose answer is a set of components."""
        kept = program.KeptFolder()
        target = kept.path / "set"
        arguments = [question, *option_words(format="json", output=target), *self._where, *more, *_chosen(components)]
        with program.Folder() as folder, Bar(progress) as bar:
            written: program.Own = {}
            second: list[str] = []
            if isinstance(other, Decomposition):
                second = [str(other.folder)]
            elif other is not None:
                file = problem_file(other, folder, self.variables)
                written, second = file.own, [str(file.path)]
            if bar.watcher is not None:
                arguments += option_words(progress="json")
            finished = program.run([*arguments, "--", str(self.folder), *second], own=written, watcher=bar.watcher)
        return _checked(_read(json.loads(finished.output), target, self._where, kept), strict)

    def _box(self, box: Ranges | None) -> list[str]:
        if box is None:
            return []
        if isinstance(box, Mapping):
            missing = [v for v in self.variables if v not in box]
            if missing:
                raise InputError(f"expected a range for each variable, found none for {missing[0]}", field="box")
            box = [box[v] for v in self.variables]
        return option_words(box=",".join(f"{float(low)!r}..{float(high)!r}" for low, high in box))

    def _real(
        self, question: str, name: str, more: list[str], components: Iterable[str], strict: bool, progress: Wanted
    ) -> RealPart:
        with program.Folder() as folder:
            files = folder.path / "files"
            summary = self._ask(question, [*more, *option_words(output=files)], components, strict, progress, {})

            def text(kind: str) -> str | None:
                path = files / f"{name}.{kind}"
                return path.read_text(encoding="utf-8") if path.exists() else None

            picture = Picture(f"{question} of {self!r}", html=text("html"), svg=text("svg"))
        parts = summary.get("curves") or summary.get("surfaces") or []
        return RealPart(tuple(summary["components"]), tuple(parts), bool(summary["settled"]), picture, summary)

    def _ask(
        self,
        question: str,
        more: list[str],
        components: Iterable[str],
        strict: bool,
        progress: Wanted,
        files: Mapping[str, str],
    ) -> dict[str, Any]:
        """Runs a question, and returns the summary of its answer."""
        arguments = [question, *option_words(format="json"), *self._where, *more, *_chosen(components)]
        with program.Folder() as folder, Bar(progress) as bar:
            own: program.Own = {}
            for name, text in files.items():
                path = folder.write(name, text)
                own[str(path)] = name
                arguments += option_words(**{name: path})
            if bar.watcher is not None:
                arguments += option_words(progress="json")
            finished = program.run([*arguments, "--", str(self.folder)], own=own, watcher=bar.watcher)
        summary: dict[str, Any] = json.loads(finished.output)
        if not summary["settled"]:
            not_settled("not settled: " + "; ".join(summary["unsettled"] or [question]), summary, strict)
        return summary


def decompose(
    problem: object,
    *,
    dimension: int | tuple[int, int] | None = None,
    method: str = "auto",
    verify: bool = False,
    certify: bool = False,
    loops: int | None = None,
    seed: int | None = None,
    preset: str | None = None,
    precision: str | int | None = None,
    exact: bool = False,
    service: Service | None = None,
    workers: int | None = None,
    threads: int | None = None,
    progress: Wanted = None,
    strict: bool = False,
    output: str | os.PathLike[str] | None = None,
) -> Decomposition:
    """All irreducible components of all dimensions, with degrees, multiplicities and witness points.

    `problem`: as for `solve`. `dimension`: dimension of the wanted components, or lowest and highest. `method`: `auto`,
    `slices`, `cascade` or `equations`; `verify`: compare with a second method. `certify`: prove the witness points.
    `service`: the service that does the work, instead of this machine. `output`: a folder for all files, among them
    Bertini's.

    Warns with `UnsettledWarning` if a claim is not settled; `strict` raises `Unsettled` instead.

    >>> import cognate as cg
    >>> found = cg.decompose(["x*z - y^2", "y - z^2", "x - y*z"], workers=1)
    >>> found
    <Decomposition: 1.1 of degree 3>
    >>> found["1.1"].multiplicity, len(found["1.1"].points), found.settled
    (1, 3, True)
    """
    kept = program.KeptFolder() if output is None else None
    folder = Path(output) if output is not None else kept.path / "set" if kept is not None else Path()
    where = _place(service, workers, threads)
    arguments = ["decompose", *option_words(format="json", output=folder, method=method), *where]
    if dimension is not None:
        low, high = (dimension, dimension) if isinstance(dimension, int) else dimension
        arguments += option_words(dimension=f"{low}..{high}")
    arguments += option_words(loops=loops, seed=seed, preset=preset, precision=precision)
    arguments += option_words(verify=bool(verify), certify=bool(certify), exact=bool(exact))
    with program.Folder() as given, Bar(progress) as bar:
        file = problem_file(problem, given)
        if bar.watcher is not None:
            arguments += option_words(progress="json")
        finished = program.run([*arguments, "--", str(file.path)], own=file.own, watcher=bar.watcher)
        summary = json.loads(finished.output)
        summary["warnings"] = [in_the_users_words(w, file.own) for w in summary.get("warnings") or []]
    return _checked(_read(summary, folder, where, kept), strict)


def _checked(decomposition: Decomposition, strict: bool) -> Decomposition:
    """Returns an answer. An answer that is not settled gives a warning; `strict` raises `Unsettled`."""
    if strict and not decomposition.settled:
        raise Unsettled("not settled: " + "; ".join(decomposition.open_questions), decomposition)
    for warning in decomposition.warnings:
        warn(warning, CognateWarning)
    if not decomposition.settled:
        warn("not settled: " + "; ".join(decomposition.open_questions), UnsettledWarning)
    return decomposition


def _place(service: Service | None, workers: int | None, threads: int | None) -> tuple[str, ...]:
    """The arguments that choose the service, or the workers and threads."""
    if service is not None:
        return tuple(service._where)
    return tuple(option_words(workers=workers, threads=threads))


def _chosen(components: Iterable[str]) -> list[str]:
    """The arguments that name components. A single text is one name."""
    return option_words(component=[components] if isinstance(components, str) else list(components))


def _read(summary: Mapping[str, Any], folder: Path, where: tuple[str, ...], kept: object) -> Decomposition:
    """The answer in a folder that the program has written."""
    points: dict[str, list[Point]] = {}
    with (folder / "witness_points.jsonl").open(encoding="utf-8") as lines:
        for line in lines:
            found = json.loads(line)
            values = found["variables"].values()
            points.setdefault(str(found["component"]), []).append(
                tuple(complex(float(re), float(im)) for re, im in values)
            )
    system = json.loads((folder / "system.json").read_text(encoding="utf-8"))
    components = []
    for block in summary["decomposition"]["components"]:
        count = int(block["count"])
        own = tuple(points.get(str(block["id"]), ())) if count == 1 else ()
        components.append(
            Component(
                id=str(block["id"]),
                dimension=int(block["dimension"]),
                degree=int(block["degree"]),
                multiplicity=block["multiplicity"],
                irreducible=str(block["irreducible"]),
                self_conjugate=block["self_conjugate"],
                orbit=block.get("orbit"),
                count=count,
                points=own,
            )
        )
    return Decomposition(
        variables=tuple(system["variables"]),
        components=tuple(components),
        witness_points={id: tuple(own) for id, own in points.items()},
        settled=bool(summary["settled"]),
        open_questions=tuple(summary["decomposition"].get("unsettled") or ()),
        warnings=tuple(summary["warnings"]),
        summary=summary,
        folder=folder,
        _where=where,
        _kept=kept,
    )


def _ids(listed: Sequence[Any]) -> list[str]:
    """Ids in a list whose items may have more fields."""
    return [str(entry["component"]) if isinstance(entry, Mapping) else str(entry) for entry in listed]


def _number(value: object, place: str) -> str | list[str]:
    """A number in the format of the file of points; a fraction stays exact."""
    if isinstance(value, complex) or getattr(getattr(value, "dtype", None), "kind", "") == "c":
        z = exact.double(value, place)
        return [repr(z.real), repr(z.imag)]
    return exact.text(value, place)


def _points(points: object, variables: tuple[str, ...]) -> str:
    """Points as lines of JSON, by names."""
    if isinstance(points, Mapping):
        points = [points]
    elif not isinstance(points, Iterable) or isinstance(points, str):
        raise InputError(f"expected a point, or a list or array of points, found {points!r}", field="points")
    listed: list[Any] = list(points)
    if listed and not any(isinstance(p, (Mapping, Sequence)) or getattr(p, "ndim", 0) > 0 for p in listed):
        listed = [listed]
    lines = []
    for i, point in enumerate(listed):
        place = f"points[{i}]"
        if isinstance(point, Mapping):
            values = {expressions.name(key, place): value for key, value in point.items()}
        else:
            values = dict(zip(variables, point, strict=False))
            if len(values) != len(variables) or len(point) != len(variables):
                raise InputError(f"expected {len(variables)} coordinates, found {len(point)}", field=place)
        lines.append(json.dumps({name: _number(value, f"{place}.{name}") for name, value in values.items()}))
    if not lines:
        raise InputError("expected at least one point", field="points")
    return "\n".join(lines) + "\n"
