"""Motions of mechanisms: the modes, their common positions, and the freedoms at one configuration."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from fractions import Fraction
from html import escape
from typing import Any

from .errors import InputError
from .positions import Pose, Position, _plain, as_poses

HOME = "home"
"""The configuration of the joints in the mechanism's file."""


@dataclass(frozen=True)
class Configuration:
    """A position of a mechanism: one of `joints`, `points` and `pose`; the others are None.

    `joints`: values of all joints by name, in radians and the file's length. `points`: places of a framework's points
    by name. `pose`: pose of a platform. All three are None if the position is not real. `real`: None if in doubt.
    """

    real: bool | None = True
    joints: Mapping[str, float] | None = None
    points: Mapping[str, tuple[float, ...]] | None = None
    pose: Pose | None = None

    @classmethod
    def from_json(cls, fields: Mapping[str, Any]) -> Configuration:
        """A configuration as the program writes it."""
        joints, points, pose = (fields.get(name) for name in ("joints", "points", "pose"))
        return cls(
            real=fields.get("real"),
            joints=None if joints is None else {name: float(value) for name, value in joints.items()},
            points=None if points is None else {name: tuple(map(float, place)) for name, place in points.items()},
            pose=None if pose is None else Pose.from_json(pose),
        )


Place = Mapping[str, Any] | Configuration | Position | Pose
"""A configuration as input: values of all joints by name, an answer of this package, or a mapping with `joints`,
`points` or `pose` as in the program's files. Values may be fractions. An angle may also be a pair (cosine, sine)."""


@dataclass(frozen=True, repr=False)
class Mode:
    """One mode of motion: an irreducible component of a mechanism's configurations.

    `id`: its name, such as `1.2`, dimension first. `dimension`: its freedoms. `degree`: degree in the coordinates
    `degree_in`: `links` (cosines and sines of the links' turns, and displacements), `joints` (the same for the
    joints), `points` (of a framework) or `study` (a platform's pose in P^7). `multiplicity`: None if not known.
    `home`: the mode contains the file's position; None if the file has no position or in doubt.

    `circuits`: connected pieces of its real positions, if requested and known. `real`: their parts: `closed_loops`,
    `singular_points` and more. `path_degree`: degree of the path of the requested point.
    """

    id: str
    dimension: int
    degree: int
    degree_in: str
    multiplicity: int | None
    home: bool | None
    circuits: int | None
    real: Mapping[str, Any] | None
    path_degree: int | None

    def __repr__(self) -> str:
        """Name, dimension and degree."""
        return f"<Mode {self.id}: {shape(self.dimension)} of degree {self.degree}>"

    @classmethod
    def from_json(cls, fields: Mapping[str, Any]) -> Mode:
        """A mode as the program writes it."""
        return cls(
            id=str(fields["id"]),
            dimension=int(fields["dimension"]),
            degree=int(fields["degree"]),
            degree_in=str(fields["degree_in"]),
            multiplicity=fields["multiplicity"],
            home=fields["home"],
            circuits=fields.get("circuits"),
            real=fields["real"],
            path_degree=fields.get("path_degree"),
        )


@dataclass(frozen=True)
class Meeting:
    """The common positions of two modes.

    `modes`: their names. `positions`: the common positions; None if they are infinitely many or not known.
    """

    modes: tuple[str, str]
    positions: tuple[Configuration, ...] | None

    @property
    def real(self) -> list[Configuration]:
        """The real common positions. The mechanism can change from one mode to the other there."""
        return [position for position in self.positions or () if position.real]


@dataclass(frozen=True, repr=False)
class Motion:
    """All modes of motion of a mechanism; iterate over the modes, or take one by its name.

    `mobility`: largest number of freedoms of a mode; 0 if the mechanism is rigid, -1 if it cannot be assembled, None in
    doubt. `gruebler`: mobility by the count of links and joints. `idle`: freedoms that move no other link.
    `overconstrained`: the mobility is larger than this count without idle freedoms. `kinematotropic`: modes with
    different numbers of freedoms meet in a real position. Both are None in doubt.

    `modes`: the largest dimension first. `isolated`, `isolated_real`: numbers of rigid positions. `meetings`: pairs of
    modes with common positions. `circuits`: number of connected pieces of all real positions, if requested. `removed`:
    components that are not positions, by reason. `values`: values of the numbers that the file leaves open.

    `settled`: nothing is in doubt; `open_questions`: a sentence for each doubt. `summary`: the program's own answer.
    """

    mobility: int | None
    gruebler: int | None
    idle: int
    overconstrained: bool | None
    kinematotropic: bool | None
    modes: tuple[Mode, ...]
    isolated: int | None
    isolated_real: int | None
    meetings: tuple[Meeting, ...]
    circuits: int | None
    removed: Mapping[str, Any]
    settled: bool
    open_questions: tuple[str, ...]
    summary: Mapping[str, Any]
    values: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def from_json(cls, fields: Mapping[str, Any]) -> Motion:
        """A motion as the program writes it. A motion of a sweep has no meetings."""
        meetings = []
        for first, second, positions in fields.get("meets") or ():
            common = None if positions is None else tuple(Configuration.from_json(each) for each in positions)
            meetings.append(Meeting((str(first), str(second)), common))
        return cls(
            mobility=fields["mobility"],
            gruebler=fields["gruebler"],
            idle=int(fields["idle"]),
            overconstrained=fields["overconstrained"],
            kinematotropic=fields.get("kinematotropic"),
            modes=tuple(Mode.from_json(component) for component in fields["components"]),
            isolated=fields["isolated"]["complex"],
            isolated_real=fields["isolated"]["real"],
            meetings=tuple(meetings),
            circuits=fields.get("circuits"),
            removed=fields["removed"],
            settled=bool(fields["settled"]),
            open_questions=tuple(str(doubt) for doubt in fields["unsettled"]),
            summary=fields,
            values={name: float(value) for name, value in (fields.get("free") or {}).items()},
        )

    def __repr__(self) -> str:
        """Mobility and degrees in one line."""
        mobility = "not known" if self.mobility is None else self.mobility
        shown = "".join(f", {mode.id} of degree {mode.degree}" for mode in self.modes)
        return f"<Motion: mobility {mobility}{shown}{'' if self.settled else ', not settled'}>"

    def __str__(self) -> str:
        """A line for the mechanism, and one for each mode and meeting."""
        lines = [self._headline()]
        for mode in self.modes:
            line = f"  {mode.id}  {shape(mode.dimension)}, degree {mode.degree}"
            if mode.circuits is not None:
                line += f", {counted(mode.circuits, 'circuit')}"
            if mode.path_degree is not None:
                line += f", path of degree {mode.path_degree}"
            lines.append(line + (", home is here" if mode.home else ""))
        for meeting in self.meetings:
            number = f"{len(meeting.positions or ())}, {len(meeting.real)} real"
            number = "infinitely many or unknown" if meeting.positions is None else number
            lines.append(f"  {meeting.modes[0]} and {meeting.modes[1]} meet: {number}")
        return "\n".join([*lines, *(f"  not settled: {doubt}" for doubt in self.open_questions)])

    def _repr_html_(self) -> str:
        return f"<pre>{escape(str(self))}</pre>"

    def _headline(self) -> str:
        if self.mobility is None:
            return f"{counted(len(self.modes), 'mode')}, not all settled"
        if self.mobility < 0:
            return "cannot be assembled"
        if self.mobility == 0:
            return f"rigid in {counted(self.isolated or 0, 'position')}, {self.isolated_real} of them real"
        return f"moves with {counted(self.mobility, 'freedom')} in {counted(len(self.modes), 'way')}"

    def __iter__(self) -> Iterator[Mode]:
        """The modes."""
        return iter(self.modes)

    def __len__(self) -> int:
        """Number of modes."""
        return len(self.modes)

    def __getitem__(self, id: str) -> Mode:
        """The mode with this name, such as `1.2`."""
        for mode in self.modes:
            if mode.id == id:
                return mode
        raise KeyError(id)


@dataclass(frozen=True)
class NumberEffect:
    """Effect of a small change of one number of the file on a mechanism's freedoms near a configuration.

    `number`: its name, such as `q2.a`, `B.point.0`, or a bar's name. `value`: its value in the file's unit. `keeps`:
    the number of freedoms stays the same; None in doubt. `assembles`: the mechanism still closes near there; None if
    not decided. `reason`: text.
    """

    number: str
    value: float
    keeps: bool | None
    assembles: bool | None
    reason: str

    @classmethod
    def from_json(cls, fields: Mapping[str, Any]) -> NumberEffect:
        """An effect as the program writes it."""
        return cls(
            number=str(fields["number"]),
            value=float(fields["value"]),
            keeps=None if fields["freedoms"] is None else fields["freedoms"] == "kept",
            assembles=fields.get("assembles"),
            reason=str(fields["reason"]),
        )


@dataclass(frozen=True, repr=False)
class LocalMobility:
    """Freedoms of a mechanism at a configuration.

    `infinitesimal`: directions in which a motion can begin. `local`: dimension of the configurations around this one.
    Both are None in doubt. `dimensions_by_order`: lengths of the local ring modulo the powers of its maximal ideal,
    from the first power on; they do not depend on coordinates. `multiplicity`: for a configuration without motion.
    `exact`: computed in exact numbers. `reason`: text. `index`: position in the list of given configurations. `why`:
    the effect of each number of the file if requested, else None.
    """

    index: int
    infinitesimal: int | None
    local: int | None
    dimensions_by_order: tuple[int, ...]
    multiplicity: int | None
    exact: bool
    reason: str
    why: tuple[NumberEffect, ...] | None = None

    def __repr__(self) -> str:
        """The two numbers."""
        shown = ["?" if number is None else str(number) for number in (self.infinitesimal, self.local)]
        return f"<LocalMobility: {shown[0]} to first order, local {shown[1]}>"

    @property
    def settled(self) -> bool:
        """Both numbers are known, and the effects if requested."""
        known = self.infinitesimal is not None and self.local is not None
        return known and all(effect.keeps is not None for effect in self.why or ())

    def doubts(self) -> list[str]:
        """A sentence for each doubt."""
        if self.infinitesimal is None or self.local is None:
            return [self.reason]
        return [f"{effect.number}: {effect.reason}" for effect in self.why or () if effect.keeps is None]

    @classmethod
    def from_json(cls, fields: Mapping[str, Any]) -> LocalMobility:
        """Freedoms as the program writes them."""
        return cls(
            index=int(fields["index"]),
            infinitesimal=fields["infinitesimal"],
            local=fields["local"],
            dimensions_by_order=tuple(int(length) for length in fields["dimensions_by_order"]),
            multiplicity=fields["multiplicity"],
            exact=bool(fields["exact"]),
            reason=str(fields["reason"]),
            why=None if "why" not in fields else tuple(NumberEffect.from_json(each) for each in fields["why"]),
        )


def counted(number: int, noun: str) -> str:
    """A number with its noun: `1 mode`, `2 modes`."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def shape(dimension: int) -> str:
    """The word for a set of this dimension."""
    return {1: "curve", 2: "surface"}.get(dimension, f"{dimension} freedoms")


def as_configurations(at: Any) -> tuple[bool, list[dict[str, Any]] | None]:
    """True for a single configuration; and the configurations as the program reads them, None for home."""
    if isinstance(at, str):
        if at != HOME:
            raise InputError(
                f"expected {HOME}, values of all joints by name, or a list of them, found {at!r}", field="at"
            )
        return True, None
    if isinstance(at, (Mapping, Configuration, Position, Pose)):
        return True, [_configuration(at, "at")]
    if not isinstance(at, Sequence) or not at:
        raise InputError(f"expected a configuration or a list of them, found {at!r}", field="at")
    return False, [_configuration(place, f"at[{i}]") for i, place in enumerate(at)]


def _configuration(place: Place, field_name: str) -> dict[str, Any]:
    if isinstance(place, Pose):
        return {"pose": as_poses(place)[1][0]}
    if isinstance(place, Position):
        return {"joints": dict(place.joints)}
    if isinstance(place, Configuration):
        if place.pose is not None:
            return {"pose": as_poses(place.pose)[1][0]}
        given: dict[str, Any] = {"joints": place.joints, "points": place.points}
        kind = next((name for name, values in given.items() if values is not None), None)
        if kind is None:
            raise InputError("expected a real configuration; this one has no values", field=field_name)
        return {kind: numbers(given[kind])}
    if not isinstance(place, Mapping):
        raise InputError(f"expected values of all joints by name, found {place!r}", field=field_name)
    for kind in ("joints", "points", "pose"):
        if set(place) == {kind}:
            inside = as_poses(place[kind])[1][0] if kind == "pose" else place[kind]
            return {kind: numbers(inside)}
    return {"joints": numbers(place)}


def numbers(value: Any) -> Any:
    """Numbers, also within mappings and lists, as JSON numbers; fractions become exact texts."""
    if isinstance(value, Mapping):
        return {str(name): numbers(part) for name, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [numbers(part) for part in value]
    if isinstance(value, (Fraction, Decimal)):
        return str(value)
    return _plain(value)
