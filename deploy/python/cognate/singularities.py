"""Singular positions of mechanisms: all singular positions, and tests of single configurations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .motions import Configuration, counted, shape

if TYPE_CHECKING:
    import numpy
    from numpy.typing import NDArray


@dataclass(frozen=True)
class SingularComponent:
    """A component of positive dimension of the singular positions.

    `degree`: degree in the coordinates `degree_in` (see `Mode`). `whole_mode`: the component is a whole mode of the
    motion, so all positions of the mode are singular; None in doubt.
    """

    id: str
    dimension: int
    degree: int
    degree_in: str
    whole_mode: bool | None


@dataclass(frozen=True, repr=False)
class SingularCurve:
    """A curve of singular positions, in the plane of the output.

    `id`: id of its component. `degree`: its degree. `samples`: its real points, one arc after the other.
    """

    id: str
    degree: int
    samples: tuple[tuple[float, float], ...]

    def __repr__(self) -> str:
        """Degree and number of samples."""
        return f"<SingularCurve {self.id}: degree {self.degree}, {len(self.samples)} samples>"

    def array(self) -> NDArray[numpy.float64]:
        """The samples as an array of shape (samples, 2), in the file's length."""
        import numpy

        return numpy.array(self.samples, dtype=numpy.float64).reshape(len(self.samples), 2)


@dataclass(frozen=True, repr=False)
class Singularities:
    """All singular positions of a mechanism.

    `kind`: `inputs` (something moves while all inputs are held) or `outputs` (the output has lost a direction).
    `inputs`: the driving joints. `dimension`: largest dimension of a component; 0 if all positions are isolated, -1 if
    there are none, None in doubt. `components`: components of positive dimension. `isolated`, `isolated_real`: numbers
    of isolated positions. `positions`: the real isolated positions. `curves`: the curves of a locus that is a curve in
    the output's plane, else None.

    For an arm of three joints that places a point, `cusps` is the number of cusps of the critical values, and
    `cuspidal` is True if the posture can change without a singularity. Both are None in doubt, and for other
    mechanisms. The components of this kind of arm are not listed.

    `settled`: nothing is in doubt; `open_questions`: a sentence for each doubt. `summary`: the program's own answer.
    """

    kind: str
    inputs: tuple[str, ...]
    dimension: int | None
    components: tuple[SingularComponent, ...]
    isolated: int | None
    isolated_real: int | None
    positions: tuple[Configuration, ...]
    curves: tuple[SingularCurve, ...] | None
    cuspidal: bool | None
    cusps: int | None
    settled: bool
    open_questions: tuple[str, ...]
    summary: Mapping[str, Any]

    @classmethod
    def from_json(cls, fields: Mapping[str, Any]) -> Singularities:
        """Singular positions as the program writes them."""
        components = [
            SingularComponent(
                id=str(component["id"]),
                dimension=int(component["dimension"]),
                degree=int(component["degree"]),
                degree_in=str(component["degree_in"]),
                whole_mode=component["whole_mode"],
            )
            for component in fields["components"] or ()
        ]
        curves = None
        if fields["curves"] is not None:
            curves = tuple(
                SingularCurve(
                    id=str(curve["id"]),
                    degree=int(curve["degree"]),
                    samples=tuple((float(x), float(y)) for x, y in curve["samples"]),
                )
                for curve in fields["curves"]
            )
        return cls(
            kind=str(fields["kind"]),
            inputs=tuple(fields["inputs"] or ()),
            dimension=fields["dimension"],
            components=tuple(components),
            isolated=fields["isolated"]["complex"],
            isolated_real=fields["isolated"]["real"],
            positions=tuple(Configuration.from_json(each) for each in fields["solutions"] if each["real"]),
            curves=curves,
            cuspidal=fields["cuspidal"],
            cusps=fields["cusps"],
            settled=bool(fields["settled"]),
            open_questions=tuple(str(doubt) for doubt in fields["unsettled"]),
            summary=fields,
        )

    def __repr__(self) -> str:
        """Counts in one line."""
        parts = [f"{component.id} {shape(component.dimension)}" for component in self.components]
        if self.isolated:
            real = "?" if self.isolated_real is None else self.isolated_real
            parts.append(f"{counted(self.isolated, 'position')}, {real} real")
        if self.cusps is not None:
            parts.append(f"dimension {self.dimension}, {counted(self.cusps, 'cusp')}")
        doubt = "" if self.settled else ", not settled"
        return f"<Singularities of {self.kind}: {', '.join(parts) or 'none'}{doubt}>"

    def array(self, names: Sequence[str] | None = None) -> NDArray[numpy.float64]:
        """Values of joints at the real isolated positions, as an array of shape (positions, joints).

        Units are radians and the file's length. `names` chooses joints and their order, by default all.
        """
        import numpy

        rows = [position.joints for position in self.positions if position.joints is not None]
        chosen = tuple(rows[0]) if names is None and rows else tuple(names or ())
        values = [[row[name] for name in chosen] for row in rows]
        return numpy.array(values, dtype=numpy.float64).reshape(len(values), len(chosen))

    def plot(self, axes: Any = None) -> Any:
        """Draws the curves by matplotlib, into `axes` or a new figure; returns the axes."""
        from .drawing import plane_axes

        if not self.curves:
            raise ValueError("there is no curve in the output's plane to be drawn")
        axes = plane_axes(axes)
        for curve in self.curves:
            x, y = curve.array().T
            axes.plot(x, y, ".", markersize=3, label=f"{curve.id}, degree {curve.degree}")
        axes.legend()
        return axes


@dataclass(frozen=True, repr=False)
class SingularityAt:
    """Test of a configuration for singularity.

    `singular`: None in doubt, with the `reason`. `rank_loss`: number of lost or gained directions. `value`: the
    deciding singular value, with lengths over the mechanism's size. `classes`: for an arm with a spherical wrist, some
    of `elbow`, `shoulder` and `wrist`. `index`: position in the list of given configurations.
    """

    index: int
    singular: bool | None
    rank_loss: int | None
    value: float
    classes: tuple[str, ...]
    reason: str | None

    def __repr__(self) -> str:
        """One word, and the deciding value."""
        word = {True: "singular", False: "regular", None: "in doubt"}[self.singular]
        named = "".join(f", {name}" for name in self.classes)
        return f"<SingularityAt: {word}{named}, value {self.value:.3g}>"

    @classmethod
    def from_json(cls, fields: Mapping[str, Any]) -> SingularityAt:
        """An answer as the program writes it."""
        return cls(
            index=int(fields["index"]),
            singular=fields["singular"],
            rank_loss=fields["rank_loss"],
            value=float(fields["value"]),
            classes=tuple(str(name) for name in fields["classes"]),
            reason=fields.get("reason"),
        )
