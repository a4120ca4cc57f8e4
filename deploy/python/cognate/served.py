"""Mechanisms that stay prepared: one `cognate mechanism serve` process answers target after target in milliseconds."""

from __future__ import annotations

import asyncio
import contextlib
import json
import subprocess
import tempfile
import threading
from collections.abc import Mapping, Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Any

from . import program
from .errors import CognateWarning, InputError, ServiceError, error_of, not_settled, warn
from .positions import Positions, as_poses, positions_of

if TYPE_CHECKING:
    import numpy
    from numpy.typing import NDArray

LINES_AT_ONCE = 128
"""Lines that are written before their answers are read. Their bytes fit into a pipe, so neither side waits."""


class ServedMechanism:
    """A mechanism whose process stays open between calls; use it in a `with` block, from any thread.

    >>> import cognate as cg
    >>> rows = [(0, 0.2, 0, 1.5707963267948966), (0, 0, 0.5, 0), (0, 0, 0.4, 0), (0, 0.1, 0, 1.5707963267948966),
    ...         (0, 0.1, 0, -1.5707963267948966), (0, 0.08, 0, 0)]
    >>> arm = cg.Mechanism.from_dh(rows)
    >>> pose = arm.forward(dict(zip(arm.joints, [0.3, -0.4, 0.9, 0.2, 0.7, -0.5])))[0].output
    >>> with arm.served() as served:
    ...     found = served.inverse(pose)
    ...     values, offsets = served.inverse_array([pose.matrix(), pose.matrix()])
    >>> offsets.tolist() == [0, len(found), 2 * len(found)], values.shape[1]
    (True, 6)
    """

    def __init__(
        self, arguments: Sequence[str], own: program.Own, task: str = "pose", inputs: Sequence[str] | None = None
    ) -> None:
        self._own = own
        self._task = task
        # The inputs whose values are the targets; None if the targets are poses.
        self._inputs = inputs
        self._lock = threading.Lock()
        self._errors = tempfile.TemporaryFile(mode="w+", encoding="utf-8", errors="replace")
        self._process = subprocess.Popen(
            [program.find(), "mechanism", "serve", *arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            encoding="utf-8",
        )

    def __enter__(self) -> ServedMechanism:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Ends the process. Later calls fail."""
        assert self._process.stdin is not None and self._process.stdout is not None, "pipes were asked for"
        with contextlib.suppress(BrokenPipeError):
            self._process.stdin.close()
        try:
            self._process.wait(program.STOP_SECONDS)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._process.stdout.close()
        self._errors.close()

    def inverse(self, poses: Any, *, strict: bool = False) -> Any:
        """The same as `Mechanism.inverse`: `Positions` for a pose, a list of `Positions` for many."""
        if self._inputs is not None:
            raise ServiceError("it was opened for values of inputs: served(forward=True); open another for poses")
        one, listed = as_poses(poses, self._task)
        answered = self._positions(listed, one, "poses", strict)
        return answered[0] if one else answered

    async def inverse_async(self, poses: Any, *, strict: bool = False) -> Any:
        """The same as `inverse`, for `await`."""
        return await asyncio.to_thread(self.inverse, poses, strict=strict)

    def forward(self, inputs: Mapping[str, float] | Sequence[Mapping[str, float]], *, strict: bool = False) -> Any:
        """The same as `Mechanism.forward`: `Positions` for values of the inputs, a list of `Positions` for many.

        The mechanism must be opened by `served(forward=True)`.
        """
        if self._inputs is None:
            raise ServiceError("it was opened for poses; served(forward=True) is for values of inputs")
        one = isinstance(inputs, Mapping)
        given: list[Any] = [inputs] if one else list(inputs)
        listed = []
        for i, values in enumerate(given):
            if not isinstance(values, Mapping):
                raise InputError(f"expected values by name, found {values!r}", field=f"inputs[{i}]")
            listed.append({name: float(value) for name, value in values.items()})
        answered = self._positions(listed, one, "inputs", strict)
        return answered[0] if one else answered

    async def forward_async(
        self, inputs: Mapping[str, float] | Sequence[Mapping[str, float]], *, strict: bool = False
    ) -> Any:
        """The same as `forward`, for `await`."""
        return await asyncio.to_thread(self.forward, inputs, strict=strict)

    def inverse_array(self, poses: Any, *, strict: bool = False) -> tuple[NDArray[numpy.float64], NDArray[numpy.int64]]:
        """All real postures of many poses as an array of shape (postures, joints), and offsets of shape (poses + 1,):
        the postures of pose k are rows offsets[k] to offsets[k + 1]. A set of postures gives one row.
        """
        import numpy

        found: list[Positions] = self.inverse(list(poses), strict=strict)
        offsets = numpy.zeros(len(found) + 1, dtype=numpy.int64)
        offsets[1:] = numpy.cumsum([len(positions) for positions in found])
        rows = [positions.array() for positions in found if len(positions)]
        return (numpy.concatenate(rows) if rows else numpy.zeros((0, 0))), offsets

    def _positions(self, targets: Sequence[Mapping[str, Any]], one: bool, called: str, strict: bool) -> list[Positions]:
        """The answers for targets; `called` is the user's word for them, poses or inputs."""
        answers = self._answers(targets, called)
        for number, answer in enumerate(answers):
            for warning in answer["warnings"]:
                warn(warning if one else f"{called} {number}: {warning}", CognateWarning)
        answered = [positions_of(answer, None) for answer in answers]
        unsettled = [str(number) for number, positions in enumerate(answered) if not positions.settled]
        if unsettled:
            not_settled(f"not settled: {called} {', '.join(unsettled)}", answered, strict)
        return answered

    def _answers(self, targets: Sequence[Mapping[str, Any]], called: str) -> list[dict[str, Any]]:
        answers: list[dict[str, Any]] = []
        if self._errors.closed:
            raise ServiceError("the served mechanism is closed")
        with self._lock:
            for first in range(0, len(targets), LINES_AT_ONCE):
                answers.extend(self._exchange(targets[first : first + LINES_AT_ONCE]))
        for number, answer in enumerate(answers):
            if "error" in answer:
                raise InputError(str(answer["error"]), field=f"{called}[{number}]")
        return answers

    def _exchange(self, targets: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
        """Writes lines, and reads the same number of answers."""
        assert self._process.stdin is not None and self._process.stdout is not None, "pipes were asked for"
        try:
            self._process.stdin.writelines(json.dumps(target) + "\n" for target in targets)
            self._process.stdin.flush()
            lines = [self._process.stdout.readline() for _ in targets]
        except (BrokenPipeError, ValueError):
            lines = [""]
        if not all(line.endswith("\n") for line in lines):
            raise error_of(self._process.wait(), self._said(), own=self._own)
        return [json.loads(line) for line in lines]

    def _said(self) -> str:
        """The messages of the process before its end."""
        listener = program.Listener()
        self._errors.seek(0)
        for line in self._errors:
            listener.line(line)
        return listener.message()
