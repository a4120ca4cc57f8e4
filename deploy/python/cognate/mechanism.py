"""Mechanism: arms, platforms and linkages; all postures for a pose, all positions for given inputs."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, overload

from . import program
from .branches import FollowedPath
from .command_line import option_words
from .components import _place
from .errors import CognateWarning, InputError, in_the_users_words, not_settled, warn
from .exceptional_sets import ExceptionalMechanisms
from .motions import LocalMobility, Motion, Place, as_configurations, numbers
from .picture import Picture
from .positions import Position, Positions, as_poses, positions_of
from .progress import Bar, Wanted
from .served import ServedMechanism
from .singularities import Singularities, SingularityAt
from .system import System
from .workspaces import Workspace, as_points

if TYPE_CHECKING:
    import numpy
    from numpy.typing import NDArray

    from .service import Service

Target = Mapping[str, float]
"""Values of inputs by name: radians, and the file's length."""


class Mechanism:
    """Links and joints. Angles are always radians here, also if the file has degrees.

    `from_json`, `from_dh`, `from_urdf` and `read` make it.

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
        self._options = [*options, *option_words(angles="rad")]
        # A temporary folder. It is removed with this object.
        self._kept = kept

    @classmethod
    def read(cls, file: str | os.PathLike[str], *, lock: Target | None = None, snap: bool = True) -> Mechanism:
        """A mechanism from a file: JSON, TOML, URDF, or CSV with Denavit-Hartenberg rows. The content shows the format.

        `lock`: joints that are held at a value. `snap`: read rounded right angles, such as 1.5708, as right angles.
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
                options += option_words(**{name: link})
        return cls(Path(file), options)

    @classmethod
    def from_json(
        cls,
        mechanism: str | os.PathLike[str] | Mapping[str, Any],
        *,
        lock: Target | None = None,
        snap: bool = True,
    ) -> Mechanism:
        """A mechanism from our JSON: a file's path, or the object that `json.loads` returns."""
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
        """An arm from its Denavit-Hartenberg rows (theta, d, a, alpha), angles in radians.

        `theta`: angle of a revolute joint at 0. `d`: place of a prismatic joint at 0. `convention`: "standard", or
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

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the joints or legs that drive the mechanism, in the order of the file."""
        return tuple(str(name) for name in self.info()["inputs"] or ())

    def __repr__(self) -> str:
        """The name of the file, or of the mechanism."""
        if self._kept is None:
            return f"<Mechanism: {self._file.name}>"
        return f"<Mechanism: {json.loads(self._file.read_text(encoding='utf-8')).get('name') or self._file.stem}>"

    def to_json(self) -> dict[str, Any]:
        """The mechanism as our JSON; `from_json` reads it."""
        converted: dict[str, Any] = self._run(["convert", *option_words(to="mechanism.json")])
        return converted

    def to_table(self) -> str:
        """An arm as a Denavit-Hartenberg table in CSV."""
        with program.Folder() as folder:
            return self._call(["convert", *option_words(to="dh.csv")], folder, {}).output

    def info(self) -> dict[str, Any]:
        """Links, joints, freedoms, the family and its number of positions: `cognate mechanism info`."""
        found: dict[str, Any] = self._run(["info", *option_words(format="json")])
        return found

    def equations(self, problem: str = "forward") -> System:
        """The equations of a problem: `forward`, `inverse` or `motion`."""
        with program.Folder() as folder:
            finished = self._call(["equations", *option_words(problem=problem, to="json")], folder, {})
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
        """Every real posture for a pose of the output, as `Positions`; for many poses a list of `Positions`.

        A pose: a homogeneous matrix (4 by 4, in the plane 3 by 3), a `Pose`, or a mapping with `position` and
        `quaternion`, `rotation`, `rpy` or `angle`. Many poses: a list, or an array of shape (n, 4, 4).
        `near`: values of all joints by name; the nearest postures come first.

        `task`: the part of a pose that is given: "position" (points are enough: three numbers, or an array of shape
        (n, 3)), "pointing" (origin and z axis: a mapping with `position` and `direction`), "xyz-yaw" (`position` and
        `yaw`), "planar" (`position` and `angle`).

        `sweep`: a joint of a redundant arm that is held at `samples` values between its limits, or over a full turn.
        The answer for each pose is a list of `Positions`, one for each value.

        >>> import cognate as cg
        >>> leg = cg.Mechanism.from_dh([(0, 0.1, 0.05, 1.5707963267948966), (0, 0, 0.3, 0), (0, 0.02, 0.28, 0)])
        >>> len(leg.inverse([0.25, 0.1, 0.3], task="position"))
        4
        """
        one, listed = as_poses(poses, task)
        options, each = [*self._near(near), *option_words(task=task)], 1
        if sweep is not None:
            each = int(samples)
            options += option_words(sweep=sweep, samples=each)
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
        near: Target | None = None,
        within_limits: bool = False,
        seed: int | None = None,
        strict: bool = False,
    ) -> FollowedPath:
        """Branches of real positions along a path through poses of the output, or through values of the inputs.

        Each branch is proved from sample to sample. It ends where two branches meet at a fold. `samples`: least number;
        by default neighbours are within 0.1 radians and a hundredth of the size. `near`: values of all joints by name;
        only the branch with the nearest start is listed.

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
        if (poses is None) == (inputs is None):
            raise TypeError("expected poses or inputs")
        arguments = ["follow", *option_words(format="json"), *_solving_options(within_limits=within_limits, seed=seed)]
        arguments += self._near(near, "seed-angles")
        arguments += option_words(samples=None if samples is None else int(samples))
        if inputs and self._needs(inputs[0]):
            arguments += option_words(input=list(inputs[0]))
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

    def _near(self, near: Target | None, option: str = "near") -> list[str]:
        if near is None:
            return []
        kinds = self.info()["joints"]
        unknown = sorted(set(near) ^ {str(joint["name"]) for joint in kinds})
        if unknown:
            raise InputError(
                f"expected a value for each joint; there is not one, or no joint, for {unknown[0]}", field="near"
            )
        values = [f"{float(near[joint['name']])!r}" + ("rad" if joint["type"] == "R" else "") for joint in kinds]
        return option_words(**{option: ",".join(values)})

    def served(
        self,
        *,
        within_limits: bool = False,
        near: Target | None = None,
        certify: bool = False,
        seed: int | None = None,
        task: str = "pose",
        forward: bool = False,
        inputs: Sequence[str] = (),
    ) -> ServedMechanism:
        """The same mechanism with a process that stays open. An answer for a pose then takes milliseconds.

        `near` and `task`: as for `inverse`. `forward`: the targets are values of inputs instead of poses, by default of
        the file's inputs.

        >>> import cognate as cg
        >>> dyad = cg.Mechanism.from_json({"space": "planar", "platform": {
        ...     "base": {"A": [0, 0], "B": [4, 0], "C": [2, 3]}, "moving": {"P": [0, 0], "Q": [1, 0], "R": [0.5, 0.8]},
        ...     "legs": [{"name": name, "from": a, "to": b, "type": "RPR"} for name, a, b in ["1AP", "2BQ", "3CR"]]}})
        >>> with dyad.served(forward=True) as served:
        ...     [len(served.forward({"1": 2, "2": length, "3": 1.5})) for length in (2.2, 2.3)]
        [2, 2]
        """
        arguments = [*self._near(near), *_solving_options(within_limits, certify, seed)]
        arguments += option_words(forward=True, input=list(inputs)) if forward else option_words(task=task)
        own: program.Own = {} if self._kept is None else {str(self._file): None}
        driven = (tuple(inputs) or self.inputs) if forward else None
        return ServedMechanism([*arguments, *self._options, "--", str(self._file)], own, task, driven)

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
        """Every real position for values of the inputs, as `Positions`; for a list of values a list of `Positions`.

        The values are given by name, as a mapping or as keywords. A structure without inputs needs none. If the
        file names other inputs, the names of the first values are the inputs.
        """
        if inputs is not None and values:
            raise TypeError("expected values as a mapping or as keywords, found both")
        one = inputs is None or isinstance(inputs, Mapping)
        given: list[Target] = [values if inputs is None else inputs] if one else list(inputs)  # type: ignore
        for i, target in enumerate(given):
            if not isinstance(target, Mapping):
                raise InputError(f"expected values by name, found {target!r}", field=f"inputs[{i}]")
        listed = [{name: float(value) for name, value in target.items()} for target in given]
        driven = option_words(input=list(listed[0])) if listed and self._needs(listed[0]) else []
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
        """A page with a view of the real positions for poses of the output or values of the inputs. The view turns.

        `follow`: shows branches along two or more targets instead, with a slider for each branch; `samples`: number of
        samples. Notebooks show the page; `save` writes it.
        """
        if (poses is None) == (inputs is None) and poses is not None:
            raise TypeError("expected poses or inputs, found both")
        problem, option = ("inverse", "poses") if poses is not None else ("forward", "inputs")
        more = option_words(certify=bool(certify))
        if poses is not None:
            targets: list[Any] = as_poses(poses)[1]
        else:
            given = [inputs] if inputs is None or isinstance(inputs, Mapping) else list(inputs)
            targets = [{name: float(x) for name, x in (values or {}).items()} for values in given]
            if targets[0] and self._needs(targets[0]):
                more += option_words(input=list(targets[0]))
        if follow:
            problem = "follow"
            more += option_words(samples=samples)
        files = {option: json.dumps(targets)} if targets != [{}] else {}
        with program.Folder() as folder:
            page = folder.path / "page"
            finished = self._call([problem, *option_words(format="json", output=page), *more], folder, files)
            html = (page / "page.html").read_text(encoding="utf-8")
        for warning in finished.warnings:
            warn(warning, CognateWarning)
        return Picture(f"{self._file.stem}: {'branches' if follow else 'positions'}", html=html)

    def jacobian(self, values: Target | Position) -> NDArray[numpy.float64]:
        """The Jacobian of an arm in space: an array of shape (6, joints).

        Rows: velocity of the output's origin (x, y, z), then angular velocity (x, y, z), both in the frame of the
        ground, for rate 1 of each joint. Columns: the joints in the order of `values`. Units are radians and the file's
        length. A mechanism with loops raises `InputError`.

        >>> import cognate as cg
        >>> arm = cg.Mechanism.from_dh([(0, 0, 0.4, 0), (0, 0, 0.3, 0)])
        >>> (arm.jacobian({"q1": 0, "q2": 0}) + 0.0).round(12)[[1, 5]].tolist()
        [[0.7, 0.3], [1.0, 1.0]]
        """
        import numpy

        given = dict(values.joints) if isinstance(values, Position) else {name: float(x) for name, x in values.items()}
        described = self.info()
        if described["loops"]:
            raise InputError("expected an arm, a chain without loops; this mechanism has loops", field="values")
        turning = {str(joint["name"]): joint["type"] == "R" for joint in described["joints"]}
        # A quarter turn to either side, or a shift by 1, gives the exact velocity without a difference error.
        targets = [dict(given)]
        for name in given:
            step = math.pi / 2 if turning.get(name, True) else 1.0
            targets += [{**given, name: given[name] + sign * step} for sign in (1.0, -1.0)]
        outputs = [positions[0].output for positions in self.forward(targets)]
        if outputs[0] is None or outputs[0].quaternion is None:
            raise InputError("expected an arm in space with an output", field="values")
        here, *others = (output.matrix() for output in outputs)
        columns = []
        for name, plus, minus in zip(given, others[::2], others[1::2], strict=True):
            turn = (plus[:3, :3] - minus[:3, :3]) / 2 @ here[:3, :3].T
            spin = [turn[2, 1], turn[0, 2], turn[1, 0]] if turning[name] else [0.0, 0.0, 0.0]
            columns.append([*(plus[:3, 3] - minus[:3, 3]) / 2, *spin])
        return numpy.array(columns, dtype=numpy.float64).T

    def motion(
        self,
        *,
        real: bool = False,
        path: str | tuple[str, Sequence[float]] | None = None,
        seed: int | None = None,
        preset: str | None = None,
        service: Service | None = None,
        workers: int | None = None,
        threads: int | None = None,
        progress: Wanted = None,
        strict: bool = False,
    ) -> Motion:
        """All modes of motion with dimension and degree, their common positions, and the rigid positions.

        `real`: also the circuits, connected pieces of the real positions. `path`: also the degree of a point's path.
        The point is "output" or a link with the point's home coordinates, such as ("coupler", (2, 3.5)).
        Exact numbers of the file stay exact. `service`, `workers`, `threads`, `progress`: as for `solve`.

        Warns with `UnsettledWarning` if something is in doubt; `strict` raises `Unsettled` instead.

        >>> import cognate as cg
        >>> bars = [(0, 0), (0, 1), (4, 1), (4, 0)]
        >>> links = ["ground", "crank", "coupler", "rocker", "ground"]
        >>> parallelogram = cg.Mechanism.from_json({"space": "planar", "links": links[:4], "joints": [
        ...     {"name": name, "type": "R", "links": links[k:k + 2], "point": bars[k]}
        ...     for k, name in enumerate(["A0", "A", "B", "B0"])]})
        >>> motion = parallelogram.motion(workers=1)
        >>> [(mode.dimension, mode.degree, mode.home) for mode in motion], len(motion.meetings[0].real)
        ([(1, 4, False), (1, 2, True)], 2)
        """
        arguments = ["motion", *option_words(format="json", real=bool(real))]
        if path is not None:
            link_point = path if isinstance(path, str) else " ".join([path[0], *(str(numbers(x)) for x in path[1])])
            arguments += option_words(path=link_point)
        arguments += _decomposing_options(seed, preset, service, workers, threads)
        answer, said = self._answer(arguments, {}, progress)
        motion = Motion.from_json(answer)
        _said(said, answer, motion.open_questions, motion, strict)
        return motion

    def motions(
        self,
        values: Iterable[Mapping[str, Any]],
        *,
        seed: int | None = None,
        preset: str | None = None,
        service: Service | None = None,
        workers: int | None = None,
        threads: int | None = None,
        progress: Wanted = None,
        strict: bool = False,
    ) -> list[Motion]:
        """The motion at each of many values of the numbers that the file leaves open with "?".

        `values`: values of all open numbers, by name; a fraction stays exact. The modes are listed without their
        meetings. The other arguments are those of `motion`.
        """
        listed = [numbers(given) for given in values]
        arguments = [
            "motion",
            *option_words(format="json"),
            *_decomposing_options(seed, preset, service, workers, threads),
        ]
        answer, said = self._answer(arguments, {"sweep": json.dumps(listed)}, progress)
        motions = [Motion.from_json(each) for each in answer["values"]]
        doubts = [f"values {i}: {doubt}" for i, motion in enumerate(motions) for doubt in motion.open_questions]
        _said(said, answer, doubts, motions, strict)
        return motions

    def exceptional(
        self,
        *,
        seed: int | None = None,
        preset: str | None = None,
        service: Service | None = None,
        workers: int | None = None,
        threads: int | None = None,
        progress: Wanted = None,
        strict: bool = False,
    ) -> ExceptionalMechanisms:
        """Values of the numbers that the file leaves open with "?" for which the mechanism moves more than in general.

        The arguments are those of `motion`. For systems of equations see `cognate.exceptional`.
        """
        arguments = [
            "exceptional",
            *option_words(format="json"),
            *_decomposing_options(seed, preset, service, workers, threads),
        ]
        answer, said = self._answer(arguments, {}, progress)
        exceptional = ExceptionalMechanisms.from_json(answer)
        _said(said, {}, exceptional.open_questions, exceptional, strict)
        return exceptional

    @overload
    def mobility(
        self,
        at: Place | Literal["home"] = "home",
        *,
        why: bool = False,
        seed: int | None = None,
        strict: bool = False,
    ) -> LocalMobility: ...

    @overload
    def mobility(
        self, at: Sequence[Place], *, why: bool = False, seed: int | None = None, strict: bool = False
    ) -> list[LocalMobility]: ...

    def mobility(self, at: Any = "home", *, why: bool = False, seed: int | None = None, strict: bool = False) -> Any:
        """Freedoms at a configuration, to first order and truly; for many configurations a list.

        `at`: "home", the position of the file; values of all joints by name (radians and the file's length, fractions
        are exact, an angle also as a pair of cosine and sine); {"points": {..}} for a framework; a `Pose` for a
        platform; or an answer: a `Position`, a `Configuration`. A configuration that does not close raises
        `InputError`. `why`: also the effect of a small change of each number of the file on the freedoms there.

        >>> import cognate as cg
        >>> shaky = cg.Mechanism.from_json({"space": "planar", "framework": {
        ...     "points": ["A", "B", "C"], "fixed": ["A", "B"], "bars": [
        ...         {"between": ["A", "B"], "length": 2}, {"between": ["A", "C"], "length": 1},
        ...         {"between": ["B", "C"], "length": 1}]}})
        >>> there = shaky.mobility({"points": {"A": [0, 0], "B": [2, 0], "C": [1, 0]}})
        >>> there.infinitesimal, there.local, there.multiplicity
        (1, 0, 2)
        """
        one, listed = as_configurations(at)
        arguments, files = _at(["mobility", *option_words(format="json")], listed)
        arguments += option_words(seed=seed, why=why)
        answer, said = self._answer(arguments, files)
        freedoms = [LocalMobility.from_json(fields) for fields in answer["points"]]
        doubts = [f"configuration {each.index}: {doubt}" for each in freedoms for doubt in each.doubts()]
        result = freedoms[0] if one else freedoms
        _said(said, answer, doubts, result, strict)
        return result

    @overload
    def singularities(
        self,
        kind: str = "inputs",
        *,
        inputs: Sequence[str] = (),
        orientation: float | None = None,
        seed: int | None = None,
        preset: str | None = None,
        service: Service | None = None,
        workers: int | None = None,
        threads: int | None = None,
        progress: Wanted = None,
        strict: bool = False,
    ) -> Singularities: ...

    @overload
    def singularities(
        self,
        kind: str = "inputs",
        *,
        at: Place | Literal["home"],
        inputs: Sequence[str] = (),
        seed: int | None = None,
        strict: bool = False,
    ) -> SingularityAt: ...

    @overload
    def singularities(
        self,
        kind: str = "inputs",
        *,
        at: Sequence[Place],
        inputs: Sequence[str] = (),
        seed: int | None = None,
        strict: bool = False,
    ) -> list[SingularityAt]: ...

    def singularities(
        self,
        kind: str = "inputs",
        *,
        at: Any = None,
        inputs: Sequence[str] = (),
        orientation: float | None = None,
        seed: int | None = None,
        preset: str | None = None,
        service: Service | None = None,
        workers: int | None = None,
        threads: int | None = None,
        progress: Wanted = None,
        strict: bool = False,
    ) -> Any:
        """All singular positions; with `at`, a test of configurations for singularity.

        `kind`: "inputs" (something moves while all inputs are held) or "outputs" (the output has lost a direction).
        `inputs`: the driving joints, instead of the file's. `orientation`: the fixed angle of a planar platform, in
        radians. All positions are found for planar linkages and for planar platforms on three driven legs.
        `at`: configurations as for `mobility`, of any mechanism. The answer is a `SingularityAt`, or a list for many.
        The other arguments are those of `motion`.

        >>> import cognate as cg
        >>> arm = cg.Mechanism.from_json({"space": "planar", "links": ["ground", "upper", "lower"],
        ...     "joints": [{"name": "q1", "type": "R", "links": ["ground", "upper"], "point": [0, 0]},
        ...                {"name": "q2", "type": "R", "links": ["upper", "lower"], "point": [2, 0]}],
        ...     "inputs": ["q1", "q2"], "output": {"link": "lower", "point": [3, 0]}})
        >>> [there.singular for there in arm.singularities("outputs", at=[{"q1": 0.3, "q2": 0}, {"q1": 0.3, "q2": 1}])]
        [True, False]
        """
        if kind not in ("inputs", "outputs"):
            raise InputError(f"expected inputs or outputs, found {kind!r}", field="kind")
        arguments = ["singularities", *option_words(format="json", **{kind: True}, input=list(inputs))]
        if at is None:
            if orientation is not None:
                arguments += option_words(orientation=float(orientation))
            arguments += _decomposing_options(seed, preset, service, workers, threads)
            answer, said = self._answer(arguments, {}, progress)
            locus = Singularities.from_json(answer)
            _said(said, answer, locus.open_questions, locus, strict)
            return locus
        one, listed = as_configurations(at)
        arguments, files = _at(arguments, listed)
        arguments += option_words(seed=seed)
        answer, said = self._answer(arguments, files)
        verdicts = [SingularityAt.from_json(fields) for fields in answer["points"]]
        doubts = [f"configuration {each.index}: {each.reason}" for each in verdicts if each.reason is not None]
        result = verdicts[0] if one else verdicts
        _said(said, answer, doubts, result, strict)
        return result

    def workspace(
        self,
        points: Any = None,
        *,
        orientation: float | None = None,
        within_limits: bool = False,
        certify: bool = False,
        seed: int | None = None,
        strict: bool = False,
    ) -> Workspace:
        """Points that the output can reach, their numbers of postures, and the boundary of the reachable points.

        `points`: an array of shape (n, 2), in space (n, 3), or a list of points, in the file's length. Without points,
        only `boundary`, `area` and `max_postures` are computed. `orientation`: the fixed angle of a planar platform, in
        radians. `within_limits`: a point is reachable only if a posture is within all limits. Points are supported for
        planar linkages, chains of three joints, and platforms with fixed orientation. Boundaries are supported for
        planar chains of revolute joints, five-bars whose output is the joint between the rods, and planar platforms.

        >>> import cognate as cg
        >>> arm = cg.Mechanism.from_json({"space": "planar", "angles": "rad", "links": ["ground", "upper", "lower"],
        ...     "joints": [{"name": "q1", "type": "R", "links": ["ground", "upper"], "point": [0, 0]},
        ...                {"name": "q2", "type": "R", "links": ["upper", "lower"], "point": [2, 0]}],
        ...     "inputs": ["q1", "q2"], "output": {"link": "lower", "point": [3, 0]}})
        >>> found = arm.workspace([[1.5, 0.5], [0.2, 0.1]])
        >>> found.reachable().tolist(), found.postures().tolist()
        ([True, False], [2.0, 0.0])
        >>> [curve.radius for curve in found.boundary], round(found.area, 6), found.max_postures
        ([3.0, 1.0], 25.132741, 2)
        """
        listed = [] if points is None else as_points(points)
        arguments = ["workspace", *option_words(format="json"), *_solving_options(within_limits, certify, seed)]
        if orientation is not None:
            arguments += option_words(orientation=float(orientation))
        files = {}
        if points is not None:
            files["points"] = json.dumps([{"position": point} for point in listed])
        answer, said = self._answer(arguments, files)
        workspace = Workspace.from_json(answer, listed, within_limits)
        doubts = [f"point {i}: {point.reason}" for i, point in enumerate(workspace) if point.reason is not None]
        of_boundary = {f"area: {workspace.area_reason}", f"no boundary: {workspace.boundary_reason}"}
        doubts += [warning for warning in said if warning in of_boundary]
        _said(said, answer, doubts, workspace, strict)
        return workspace

    def _needs(self, values: Target) -> bool:
        """True if the given inputs differ from the file's inputs."""
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
        arguments = [problem, *option_words(format="json"), *more, *_solving_options(within_limits, certify, seed)]
        # A structure has no targets.
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
        # The answer also contains warnings about the given poses.
        for warning in dict.fromkeys([*finished.warnings, *answer["warnings"]]):
            warn(warning, CognateWarning)
        return found

    def _answer(
        self, arguments: list[str], files: Mapping[str, str], progress: Wanted = False
    ) -> tuple[dict[str, Any], list[str]]:
        """The JSON answer of a question, and its warnings."""
        with program.Folder() as folder, Bar(progress) as bar:
            if bar.watcher is not None:
                arguments = [*arguments, *option_words(progress="json")]
            finished = self._call(arguments, folder, files, bar.watcher)
        answer: dict[str, Any] = json.loads(finished.output)
        return answer, finished.warnings

    def _run(self, arguments: list[str]) -> Any:
        with program.Folder() as folder:
            return json.loads(self._call(arguments, folder, {}).output)

    def _call(
        self,
        arguments: list[str],
        folder: program.Folder,
        files: Mapping[str, str],
        watcher: program.Watcher | None = None,
    ) -> program.Finished:
        own: program.Own = {} if self._kept is None else {str(self._file): None}
        for name, text in files.items():
            path = folder.write(name, text)
            own[str(path)] = name
            arguments = [*arguments, *option_words(**{name: path})]
        command = ["mechanism", *arguments, *self._options, "--", str(self._file)]
        finished = program.run(command, own=own, watcher=watcher)
        finished.warnings = [in_the_users_words(w, own) for w in finished.warnings]
        return finished


def _solving_options(within_limits: bool = False, certify: bool = False, seed: int | None = None) -> list[str]:
    return option_words(within_limits=bool(within_limits), certify=bool(certify), seed=seed)


def _file_options(lock: Target | None, snap: bool) -> list[str]:
    locks = [f"{name}={float(value)!r}" for name, value in (lock or {}).items()]
    return option_words(lock=locks, no_snap=not snap)


def _decomposing_options(
    seed: int | None, preset: str | None, service: Service | None, workers: int | None, threads: int | None
) -> list[str]:
    return [*_place(service, workers, threads), *option_words(seed=seed, preset=preset)]


def _at(arguments: list[str], configurations: list[dict[str, Any]] | None) -> tuple[list[str], dict[str, str]]:
    """Arguments and files for a question about configurations; None is home."""
    if configurations is None:
        return [*arguments, *option_words(at="home")], {}
    return arguments, {"at": json.dumps(configurations)}


def _said(
    warnings: Sequence[str], answer: Mapping[str, Any], doubts: Sequence[str], result: object, strict: bool
) -> None:
    """Issues an answer's warnings. Its doubts are one more warning, or raise `Unsettled` if `strict`."""
    for warning in dict.fromkeys([*warnings, *answer.get("warnings", [])]):
        if warning not in doubts:
            warn(warning, CognateWarning)
    if doubts:
        not_settled("not settled: " + "; ".join(doubts), result, strict)
