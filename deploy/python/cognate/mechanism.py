"""Mechanism: arms, platforms and linkages; every posture for a pose, every position for given inputs."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import program
from .errors import CognateWarning, InputError, in_the_users_words, not_settled, warn
from .picture import Picture
from .served import ServedMechanism
from .system import System

if TYPE_CHECKING:
    import numpy
    from numpy.typing import NDArray

    from .branches import FollowedPath


@dataclass(frozen=True)
class Pose:
    """Where a body is: `position`, and `quaternion` (w, x, y, z) in space or `angle` in the plane."""

    position: tuple[float, ...]
    quaternion: tuple[float, float, float, float] | None = None
    angle: float | None = None

    @classmethod
    def from_json(cls, found: Mapping[str, Any]) -> Pose:
        """A pose as the program writes it."""
        position = tuple(float(x) for x in found["position"])
        if "quaternion" not in found:
            return cls(position, angle=float(found["angle"]))
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
    """One way in which a mechanism stands.

    `joints`: values of all joints by name, in radians and the file's length. `output`: the pose of the output, where
    one is named. `links`: the poses of all links. `within_limits`: None where that is not decided; `violated`: names
    of joints beyond their limits. `certified`: None where no proof was asked for. `residual`: how well it closes.
    `singular`: an arm is singular there; `dependent`: the joints that can begin to move while its tool is at rest;
    `multiplicity`: how many postures come together, None for one of a set. `condition`: of an arm, of its screws.
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

    `joints`: those that move. `spans`: by how much each does, in radians and the file's length; empty where `dimension`
    is above 1. `closed`: whether it comes back to where it begins. `paths`: how many end on it. `posture`: one of it.
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

    `counts`: numbers of positions: `complex`, `real`, `within_limits`, `failed`, ... `expected`: how many complex
    ones this mechanism has as a rule, or None. `settled`: all paths are accounted for. `sets`: sets of postures of an
    arm; one of each is among the positions, too.
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
        """One position, or some."""
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


Target = Mapping[str, float]
"""Values of inputs by name: radians, and the file's length."""


class Mechanism:
    """Links and joints. Angles are radians here, whatever the file says.

    Made by `from_json`, `from_dh`, `from_urdf` or `read`.

    >>> import cognate as cg
    >>> arm = cg.Mechanism.from_json({"name": "arm", "space": "planar", "angles": "rad",
    ...     "links": ["ground", "upper", "lower"],
    ...     "joints": [{"name": "q1", "type": "R", "links": ["ground", "upper"], "point": [0, 0]},
    ...                {"name": "q2", "type": "R", "links": ["upper", "lower"], "point": [2, 0]}],
    ...     "inputs": ["q1", "q2"], "output": {"link": "lower", "point": [3, 0]}})
    >>> arm.info()["joints"][0]["name"]
    'q1'
    """

    def __init__(self, file: Path, options: Sequence[str] = (), kept: object = None) -> None:
        self._file = file
        self._options = [*options, "--angles", "rad"]
        # A temporary folder, which goes with this object.
        self._kept = kept

    @classmethod
    def read(cls, file: str | os.PathLike[str], *, lock: Target | None = None, snap: bool = True) -> Mechanism:
        """A mechanism from a file: JSON, TOML, URDF, or CSV with Denavit-Hartenberg rows, told by its content.

        `lock`: joints that are held at a value. `snap`: rounded right angles, such as 1.5708, are right angles.
        """
        return cls(Path(file), _file_options(lock, snap))

    @classmethod
    def from_urdf(
        cls,
        file: str | os.PathLike[str],
        *,
        base: str | None = None,
        tip: str | None = None,
        lock: Target | None = None,
        snap: bool = True,
    ) -> Mechanism:
        """The chain of a URDF from `base` (default: the root) to `tip` (default: tool0, or the only one)."""
        options = _file_options(lock, snap)
        for name, link in (("base", base), ("tip", tip)):
            if link is not None:
                options += [f"--{name}", link]
        return cls(Path(file), options)

    @classmethod
    def from_json(
        cls,
        mechanism: str | os.PathLike[str] | Mapping[str, Any],
        *,
        lock: Target | None = None,
        snap: bool = True,
    ) -> Mechanism:
        """A mechanism from our JSON: a file by its path, or what `json.loads` makes of one."""
        if not isinstance(mechanism, Mapping):
            return cls(Path(mechanism), _file_options(lock, snap))
        folder = program.KeptFolder()
        path = folder.path / "mechanism.json"
        path.write_text(json.dumps(mechanism), encoding="utf-8")
        return cls(path, _file_options(lock, snap), folder)

    @classmethod
    def from_dh(
        cls,
        rows: Iterable[Sequence[float]],
        *,
        convention: str = "standard",
        types: Sequence[str] | None = None,
        names: Sequence[str] | None = None,
        lock: Target | None = None,
        snap: bool = True,
    ) -> Mechanism:
        """An arm from its rows of Denavit and Hartenberg: (theta, d, a, alpha), angles in radians.

        `theta` is the angle of a revolute joint at 0, `d` the place of a prismatic one. `convention`: "standard", or
        "modified" (Craig). `types`: "R" or "P" for each joint, by default R. `names`: by default q1, q2, ...

        >>> import cognate as cg
        >>> arm = cg.Mechanism.from_dh([(0, 0, 0.4, 0), (0, 0, 0.3, 0)])
        >>> arm.joints
        ('q1', 'q2')
        >>> [round(x, 3) for x in arm.forward(q1=0, q2=1.5707963267948966)[0].output.position]
        [0.4, 0.3, 0.0]
        """
        table = [[float(value) for value in row] for row in rows]
        if any(len(row) != 4 for row in table):
            raise InputError("expected rows of four numbers: theta, d, a, alpha", field="rows")
        for what, given in (("types", types), ("names", names)):
            if given is not None and len(given) != len(table):
                raise InputError(f"expected one for each of {len(table)} rows, found {len(given)}", field=what)
        joints = []
        for i, (theta, d, a, alpha) in enumerate(table):
            name = f"q{i + 1}" if names is None else names[i]
            kind = "R" if types is None else types[i]
            joints.append({"name": name, "type": kind, "theta": theta, "d": d, "a": a, "alpha": alpha})
        mechanism = {"angles": "rad", "serial": {"convention": convention, "joints": joints}}
        return cls.from_json(mechanism, lock=lock, snap=snap)

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints that have a value, in the order of the file."""
        return tuple(str(joint["name"]) for joint in self.info()["joints"])

    def info(self) -> dict[str, Any]:
        """Links, joints, freedoms, the family and its number of positions: `cognate mechanism info`."""
        found: dict[str, Any] = self._run(["info", "--format", "json"])
        return found

    def equations(self, problem: str = "forward") -> System:
        """The equations that are solved: of `forward`, `inverse` or `motion`."""
        with program.Folder() as folder:
            finished = self._call(["equations", f"--problem={problem}", "--to", "json"], folder, {})
        return System.from_json(finished.output)

    def inverse(
        self,
        poses: Any,
        *,
        within_limits: bool = False,
        near: Target | None = None,
        certify: bool = False,
        seed: int | None = None,
        strict: bool = False,
        task: str = "pose",
        sweep: str | None = None,
        samples: int = 36,
    ) -> Any:
        """Every real posture for a pose of the output: `Positions`; for many poses a list of them.

        A pose: a homogeneous matrix (4 by 4, in the plane 3 by 3), a `Pose`, or a mapping with `position` and
        `quaternion`, `rotation`, `rpy` or `angle`. Many: a list of these, or an array of shape (n, 4, 4).
        `near`: values of all joints by name; the postures nearest to them come first.

        `task`: the part of a pose that is asked for: "position" (points will do: three numbers, or an array of shape
        (n, 3)), "pointing" (origin and z axis: a mapping with `position` and `direction`), "xyz-yaw" (`position` and
        `yaw`), "planar" (`position` and `angle`).

        `sweep`: a joint of a redundant arm that is held at `samples` values along its limits, or once around: for each
        pose a list of `Positions`, one for each value.

        >>> import cognate as cg
        >>> leg = cg.Mechanism.from_dh([(0, 0.1, 0.05, 1.5707963267948966), (0, 0, 0.3, 0), (0, 0.02, 0.28, 0)])
        >>> len(leg.inverse([0.25, 0.1, 0.3], task="position"))
        4
        """
        one, listed = as_poses(poses, task)
        options, each = [*self._near(near), f"--task={task}"], 1
        if sweep is not None:
            each = int(samples)
            options += [f"--sweep={sweep}", f"--samples={each}"]
        found = self._solve("inverse", "poses", listed, options, within_limits, certify, seed, strict, each)
        if sweep is None:
            return found[0] if one else found
        swept = [found[i : i + each] for i in range(0, len(found), each)]
        return swept[0] if one else swept

    def follow(
        self,
        poses: Any = None,
        *,
        inputs: Sequence[Target] | None = None,
        samples: int | None = None,
        within_limits: bool = False,
        seed: int | None = None,
        strict: bool = False,
    ) -> FollowedPath:
        """Branches of real positions along a path through poses of the output, or through values of the inputs.

        Each branch is proved from sample to sample, and ends where two meet at a fold. `samples`: how many, at least;
        by default neighbours are within 0.1 radians and a hundredth of the size.

        >>> import cognate as cg
        >>> rows = [(0, 0.2, 0, 1.5707963267948966), (0, 0, 0.5, 0), (0, 0, 0.4, 0), (0, 0.1, 0, 1.5707963267948966),
        ...         (0, 0.1, 0, -1.5707963267948966), (0, 0.08, 0, 0)]
        >>> arm = cg.Mechanism.from_dh(rows)
        >>> start = arm.forward(dict(zip(arm.joints, [0.3, -0.4, 0.9, 0.2, 0.7, -0.5])))[0].output.matrix()
        >>> end = start.copy()
        >>> end[2, 3] += 0.02
        >>> path = arm.follow([start, end])
        >>> path.settled, path.branches[0].array().shape == (path.samples, 6)
        (True, True)
        """
        from .branches import FollowedPath

        if (poses is None) == (inputs is None):
            raise TypeError("expected poses or inputs")
        arguments = ["follow", "--format", "json", *_solving_options(within_limits=within_limits, seed=seed)]
        if samples is not None:
            arguments.append(f"--samples={int(samples)}")
        option, targets = (
            ("poses", as_poses(list(poses))[1]) if inputs is None else ("inputs", [dict(x) for x in inputs])
        )
        with program.Folder() as folder:
            finished = self._call(arguments, folder, {option: json.dumps(targets)})
        answer = json.loads(finished.output)
        for warning in answer["warnings"]:
            warn(warning, CognateWarning)
        found = FollowedPath.from_json(answer)
        if not found.settled:
            not_settled("not settled: a branch is in doubt", found, strict)
        return found

    def _near(self, near: Target | None) -> list[str]:
        if near is None:
            return []
        kinds = self.info()["joints"]
        unknown = sorted(set(near) ^ {str(joint["name"]) for joint in kinds})
        if unknown:
            raise InputError(
                f"expected a value for each joint; there is not one, or no joint, for {unknown[0]}", field="near"
            )
        values = [f"{float(near[joint['name']])!r}" + ("rad" if joint["type"] == "R" else "") for joint in kinds]
        return ["--near=" + ",".join(values)]

    def served(
        self,
        *,
        within_limits: bool = False,
        near: Target | None = None,
        certify: bool = False,
        seed: int | None = None,
        task: str = "pose",
    ) -> ServedMechanism:
        """The same mechanism with a process that stays open, so that a pose is answered in milliseconds.

        `near` and `task`: as for `inverse`.
        """
        arguments = [*self._near(near), f"--task={task}", *_solving_options(within_limits, certify, seed)]
        own: program.Own = {} if self._kept is None else {str(self._file): None}
        return ServedMechanism([*arguments, *self._options, "--", str(self._file)], own, task)

    def forward(
        self,
        inputs: Target | Sequence[Target] | None = None,
        *,
        within_limits: bool = False,
        certify: bool = False,
        seed: int | None = None,
        strict: bool = False,
        **values: float,
    ) -> Any:
        """Every real position for values of the inputs: `Positions`; for a list of values a list of them.

        Values by name, as a mapping or as keywords. Without any, of a structure that has no inputs. Inputs that
        the file does not name are taken from the names of the first values.
        """
        if inputs is not None and values:
            raise TypeError("expected values as a mapping or as keywords, found both")
        one = inputs is None or isinstance(inputs, Mapping)
        given: list[Target] = [values if inputs is None else inputs] if one else list(inputs)  # type: ignore
        for i, target in enumerate(given):
            if not isinstance(target, Mapping):
                raise InputError(f"expected values by name, found {target!r}", field=f"inputs[{i}]")
        listed = [{name: float(value) for name, value in target.items()} for target in given]
        driven = [f"--input={name}" for name in listed[0]] if listed and self._needs(listed[0]) else []
        found = self._solve("forward", "inputs", listed, driven, within_limits, certify, seed, strict)
        return found[0] if one else found

    def show(
        self,
        poses: Any = None,
        *,
        inputs: Target | Sequence[Target] | None = None,
        follow: bool = False,
        samples: int | None = None,
        certify: bool = False,
    ) -> Picture:
        """A page of the real positions, which can be turned by hand: for poses of the output, or values of the inputs.

        `follow`: branches along the targets instead, two or more of them, with a slider for each; `samples`: in how
        many steps. Shown by notebooks; `save` writes it.
        """
        if (poses is None) == (inputs is None) and poses is not None:
            raise TypeError("expected poses or inputs, found both")
        problem, option = ("inverse", "poses") if poses is not None else ("forward", "inputs")
        more: list[str] = ["--certify"] if certify else []
        if poses is not None:
            targets: list[Any] = as_poses(poses)[1]
        else:
            given = [inputs] if inputs is None or isinstance(inputs, Mapping) else list(inputs)
            targets = [{name: float(x) for name, x in (values or {}).items()} for values in given]
            if targets[0] and self._needs(targets[0]):
                more += [f"--input={name}" for name in targets[0]]
        if follow:
            problem = "follow"
            more += [] if samples is None else [f"--samples={samples}"]
        files = {option: json.dumps(targets)} if targets != [{}] else {}
        with program.Folder() as folder:
            page = folder.path / "page"
            finished = self._call([problem, "--format", "json", f"--output={page}", *more], folder, files)
            html = (page / "page.html").read_text(encoding="utf-8")
        for warning in finished.warnings:
            warn(warning, CognateWarning)
        return Picture(f"{self._file.stem}: {'branches' if follow else 'positions'}", html=html)

    def _needs(self, values: Target) -> bool:
        """Whether the inputs that are given are others than the file's."""
        return set(self.info().get("inputs") or ()) != set(values)

    def _solve(
        self,
        problem: str,
        option: str,
        targets: list[Any],
        more: list[str],
        within_limits: bool,
        certify: bool,
        seed: int | None,
        strict: bool,
        answers_each: int = 1,
    ) -> list[Positions]:
        arguments = [problem, "--format", "json", *more, *_solving_options(within_limits, certify, seed)]
        # A structure has nothing to be told.
        files = {option: json.dumps(targets)} if targets != [{}] else {}
        with program.Folder() as folder:
            finished = self._call(arguments, folder, files)
        answer = json.loads(finished.output)
        family = answer["mechanism"]["family"]
        expected = family.get("here") or family.get("expected")
        found = [positions_of(target, expected) for target in answer["targets"]]
        if len(found) != answers_each * len(targets):
            raise InputError(f"{len(targets)} targets were given, and {len(found)} are answered", field=option)
        if not answer["settled"]:
            where = [str(target["index"]) for target in answer["targets"] if not target["settled"]]
            not_settled(f"not settled: targets {', '.join(where) or 'unknown'}", found, strict)
        # What it says of the poses as they are written stands beside the answer.
        for warning in dict.fromkeys([*finished.warnings, *answer["warnings"]]):
            warn(warning, CognateWarning)
        return found

    def _run(self, arguments: list[str]) -> Any:
        with program.Folder() as folder:
            return json.loads(self._call(arguments, folder, {}).output)

    def _call(self, arguments: list[str], folder: program.Folder, files: Mapping[str, str]) -> program.Finished:
        own: program.Own = {} if self._kept is None else {str(self._file): None}
        for name, text in files.items():
            path = folder.write(name, text)
            own[str(path)] = name
            arguments = [*arguments, f"--{name}", str(path)]
        finished = program.run(["mechanism", *arguments, *self._options, "--", str(self._file)], own=own)
        finished.warnings = [in_the_users_words(w, own) for w in finished.warnings]
        return finished


def _solving_options(within_limits: bool = False, certify: bool = False, seed: int | None = None) -> list[str]:
    wanted = (("--within-limits", within_limits), ("--certify", certify), (f"--seed={seed}", seed is not None))
    return [option for option, is_wanted in wanted if is_wanted]


def _file_options(lock: Target | None, snap: bool) -> list[str]:
    options = [f"--lock={name}={float(value)!r}" for name, value in (lock or {}).items()]
    return options if snap else [*options, "--no-snap"]


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
    """Poses as the program reads them, and whether one alone was given; for the task "position" points, too."""
    if task == "position" and _depth(poses) == 1:
        return True, [{"position": _plain(poses)}]
    if task == "position" and _depth(poses) == 2 and all(len(point) == 3 for point in poses):
        return False, [{"position": _plain(point)} for point in poses]
    if isinstance(poses, (Mapping, Pose)) or _depth(poses) == 2:
        return True, [_pose(poses, "poses")]
    return False, [_pose(pose, f"poses[{i}]") for i, pose in enumerate(poses)]


def _depth(value: Any) -> int:
    """How deep numbers lie in lists or arrays."""
    dimensions = getattr(value, "ndim", None)
    if dimensions is not None:
        return int(dimensions)
    if isinstance(value, (str, Mapping, Pose)) or not isinstance(value, Iterable):
        return 0
    first = next(iter(value), None)
    return 1 + _depth(first)


def _pose(pose: Any, place: str) -> dict[str, Any]:
    if isinstance(pose, Pose):
        turn = {"angle": pose.angle} if pose.quaternion is None else {"quaternion": list(pose.quaternion)}
        return {"position": list(pose.position), **turn}
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
    """Lists and numbers of Python."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, (list, tuple)):
        return [_plain(part) for part in value]
    return value
