"""Mechanism: arms, platforms and linkages; every posture for a pose, every position for given inputs."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from . import program
from .branches import FollowedPath
from .errors import CognateWarning, InputError, in_the_users_words, not_settled, warn
from .picture import Picture
from .positions import Positions, as_poses, positions_of
from .served import ServedMechanism
from .system import System

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
