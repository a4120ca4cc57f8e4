"""Positions of mechanisms: poses, postures and sets of postures, as the program writes and reads them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .errors import InputError

if TYPE_CHECKING:
    import numpy
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Pose:
    """Pose of a body: `position`, and `quaternion` (w, x, y, z) in space or `angle` in radians in the plane."""

    position: tuple[float, ...]
    quaternion: tuple[float, float, float, float] | None = None
    angle: float | None = None

    @classmethod
    def from_json(cls, found: Mapping[str, Any]) -> Pose:
        """A pose as the program writes it."""
        position = tuple(float(x) for x in found["position"])
        if "quaternion" not in found:
            angle = found.get("angle")
            return cls(position, angle=None if angle is None else float(angle))
        w, x, y, z = (float(part) for part in found["quaternion"])
        return cls(position, quaternion=(w, x, y, z))

    def rotation(self) -> list[list[float]]:
        """The rotation as a matrix: 3 by 3, in the plane 2 by 2.

        >>> Pose((0.0, 0.0, 0.0), quaternion=(0.0, 0.0, 0.0, 1.0)).rotation()
        [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]]
        """
        if self.quaternion is None:
            c, s = math.cos(self.angle or 0.0), math.sin(self.angle or 0.0)
            return [[c, -s], [s, c]]
        w, x, y, z = self.quaternion
        return [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]

    def matrix(self) -> NDArray[numpy.float64]:
        """Rotation and position as a homogeneous matrix: 4 by 4, in the plane 3 by 3."""
        import numpy

        turn = numpy.array(self.rotation())
        size = len(turn)
        found = numpy.eye(size + 1)
        found[:size, :size] = turn
        found[:size, size] = self.position
        return found


@dataclass(frozen=True)
class Position:
    """One position of a mechanism.

    `joints`: values of all joints by name, in radians and the file's length. `output`: the pose of the output, if the
    mechanism has one. `links`: the poses of all links. `within_limits`: None if not decided; `violated`: names of
    joints beyond their limits. `certified`: None if no proof was requested. `residual`: closure error.
    `singular`: an arm is singular there; `dependent`: the joints that can begin to move while its tool is at rest;
    `multiplicity`: number of coinciding postures, None for one of a set. `condition`: that of an arm's screws.
    """

    joints: Mapping[str, float]
    output: Pose | None
    links: Mapping[str, Pose]
    singular: bool
    certified: bool | None
    within_limits: bool | None
    violated: tuple[str, ...]
    residual: float
    condition: float | None
    dependent: tuple[str, ...] = ()
    multiplicity: int | None = 1

    @classmethod
    def from_json(cls, found: Mapping[str, Any]) -> Position:
        """A real position as the program writes it."""
        output = found.get("output")
        return cls(
            joints={name: float(value) for name, value in {**found["inputs"], **found["joints"]}.items()},
            output=None if output is None else Pose.from_json(output),
            links={name: Pose.from_json(pose) for name, pose in found["links"].items()},
            singular=bool(found["singular"]),
            certified=found["certified"],
            within_limits=found["within_limits"],
            violated=tuple(str(v) for v in found["violated"]),
            residual=float(found["residual"]),
            condition=found["condition"],
            dependent=tuple(str(joint) for joint in found["dependent"]),
            multiplicity=found["multiplicity"],
        )


@dataclass(frozen=True)
class PostureSet:
    """Postures of one pose along which an arm moves while its tool is at rest.

    `joints`: the moving joints. `spans`: range of each, in radians and the file's length; empty if `dimension` is above
    1. `closed`: the set returns to its start. `paths`: number of paths that end on it. `posture`: one of its postures.
    """

    dimension: int
    joints: tuple[str, ...]
    spans: Mapping[str, float]
    closed: bool
    paths: int
    posture: Position

    @classmethod
    def from_json(cls, found: Mapping[str, Any]) -> PostureSet:
        """A set as the program writes it."""
        return cls(
            dimension=int(found["dimension"]),
            joints=tuple(str(joint) for joint in found["joints"]),
            spans={joint: float(span) for joint, span in found["spans"].items()},
            closed=bool(found["closed"]),
            paths=int(found["paths"]),
            posture=Position.from_json(found["posture"]),
        )


@dataclass(frozen=True, repr=False)
class Positions(Sequence[Position]):
    """All real positions for one target; a sequence of `Position`.

    `counts`: numbers of positions: `complex`, `real`, `within_limits`, `failed`, ... `expected`: usual number of
    complex positions of this mechanism, or None. `settled`: all paths are accounted for. `sets`: sets of postures of an
    arm; one posture of each set is also among the positions.
    """

    names: tuple[str, ...]
    positions: tuple[Position, ...]
    counts: Mapping[str, int | None]
    expected: int | None
    settled: bool
    sets: tuple[PostureSet, ...] = ()

    def __repr__(self) -> str:
        """Counts in one line."""
        shown = f"{self.counts['real']} real of {self.counts['complex']}"
        singular = sum(1 for position in self.positions if position.singular) - len(self.sets)
        if singular:
            shown += f", {singular} singular"
        if self.sets:
            shown += f", {len(self.sets)} sets" if len(self.sets) > 1 else ", 1 set"
        return f"<Positions: {shown}{'' if self.settled else ', not settled'}>"

    def __len__(self) -> int:
        """Number of real positions."""
        return len(self.positions)

    def __getitem__(self, index: Any) -> Any:
        """One position, or a slice."""
        return self.positions[index]

    def array(self, names: Sequence[str] | None = None) -> NDArray[numpy.float64]:
        """Values of the joints as an array of shape (positions, joints); `names` chooses joints and their order."""
        import numpy

        chosen = self.names if names is None else tuple(names)
        rows = [[position.joints[name] for name in chosen] for position in self.positions]
        return numpy.array(rows, dtype=numpy.float64).reshape(len(rows), len(chosen))

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        """For numpy: as `array()`."""
        found = self.array()
        return found if dtype is None else found.astype(dtype)


def positions_of(target: Mapping[str, Any], expected: int | None) -> Positions:
    """The answer for a target as the program writes it."""
    listed = [Position.from_json(found) for found in target["solutions"] if found["real"]]
    names: tuple[str, ...] = tuple(listed[0].joints) if listed else ()
    return Positions(
        names=names,
        positions=tuple(listed),
        counts=dict(target["configurations"]),
        expected=expected,
        settled=bool(target["settled"]),
        sets=tuple(PostureSet.from_json(found) for found in target["sets"]),
    )


def as_poses(poses: Any, task: str = "pose") -> tuple[bool, list[dict[str, Any]]]:
    """True for a single pose; and the poses as the program reads them. The task "position" also accepts points."""
    if task == "position" and _depth(poses) == 1:
        return True, [{"position": _plain(poses)}]
    if task == "position" and _depth(poses) == 2 and all(len(point) == 3 for point in poses):
        return False, [{"position": _plain(point)} for point in poses]
    if isinstance(poses, (Mapping, Pose)) or _depth(poses) == 2:
        return True, [_pose(poses, "poses")]
    return False, [_pose(pose, f"poses[{i}]") for i, pose in enumerate(poses)]


def _depth(value: Any) -> int:
    """Nesting depth of numbers in lists or arrays."""
    dimensions = getattr(value, "ndim", None)
    if dimensions is not None:
        return int(dimensions)
    if isinstance(value, (str, Mapping, Pose)) or not isinstance(value, Iterable):
        return 0
    first = next(iter(value), None)
    return 1 + _depth(first)


def _pose(pose: Any, place: str) -> dict[str, Any]:
    if isinstance(pose, Pose):
        turns = {"quaternion": pose.quaternion and list(pose.quaternion), "angle": pose.angle}
        return {"position": list(pose.position), **{name: turn for name, turn in turns.items() if turn is not None}}
    if isinstance(pose, Mapping):
        return {name: _plain(value) for name, value in pose.items()}
    if _depth(pose) != 2:
        raise InputError("expected a matrix, a Pose, or a mapping with position", field=place)
    rows = [[float(x) for x in row] for row in pose]
    size = len(rows)
    if size not in (3, 4) or any(len(row) != size for row in rows):
        raise InputError("expected a homogeneous matrix, 4 by 4 or in the plane 3 by 3", field=place)
    if rows[-1] != [0.0] * (size - 1) + [1.0]:
        raise InputError(f"expected a last row of zeros and a one, found {rows[-1]}", field=place)
    position = [row[-1] for row in rows[:-1]]
    turn_rows = [row[:-1] for row in rows[:-1]]
    if size == 3:
        return {"position": position, "angle": math.atan2(turn_rows[1][0], turn_rows[0][0])}
    return {"position": position, "rotation": turn_rows}


def _plain(value: Any) -> Any:
    """Converts to Python's lists and numbers."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, (list, tuple)):
        return [_plain(part) for part in value]
    return value
