"""Branches of positions along a path of targets: the answer of `Mechanism.follow`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .positions import Position

if TYPE_CHECKING:
    import numpy
    from numpy.typing import NDArray


@dataclass(frozen=True, repr=False)
class Branch:
    """Positions that are connected from sample to sample, with proof.

    `first`: the branch's first sample, counted from 0. `begins`, `ends`: "path" (with the path), "fold" (where it
    meets another branch) or "unknown" (in doubt). `within_limits`: all its positions are within the limits.
    """

    first: int
    begins: str
    ends: str
    within_limits: bool
    positions: tuple[Position, ...]

    def __repr__(self) -> str:
        """First and last sample."""
        last = self.first + len(self.positions) - 1
        return f"<Branch: samples {self.first} to {last}, from {self.begins} to {self.ends}>"

    def __len__(self) -> int:
        """Number of samples."""
        return len(self.positions)

    def array(self, names: Sequence[str] | None = None) -> NDArray[numpy.float64]:
        """Values of the joints as an array of shape (samples, joints); `names` chooses joints and their order."""
        import numpy

        chosen = tuple(self.positions[0].joints) if names is None else tuple(names)
        return numpy.array([[position.joints[name] for name in chosen] for position in self.positions])


@dataclass(frozen=True)
class Fold:
    """The meeting of two branches. `at`: number of the sample before it, plus its fraction of the way to the next.
    `error`: bound on the error of `at`, None if the fold is not proved. `kind`: "vanish" or "appear", along the path.
    """

    at: float
    error: float | None
    branches: tuple[int, ...]
    kind: str


@dataclass(frozen=True, repr=False)
class FollowedPath:
    """All branches along a path of targets, their folds, and `settled`: nothing is in doubt.

    `changes`: pairs of postures, by their numbers at the first sample. A closed path leads from the first posture of
    a pair to the second without a fold (a cuspidal arm).
    """

    branches: tuple[Branch, ...]
    folds: tuple[Fold, ...]
    changes: tuple[tuple[int, int], ...]
    samples: int
    settled: bool

    def __repr__(self) -> str:
        """Counts in one line."""
        doubt = "" if self.settled else ", not settled"
        return f"<FollowedPath: {len(self.branches)} branches, {len(self.folds)} folds, {self.samples} samples{doubt}>"

    @classmethod
    def from_json(cls, found: Mapping[str, Any]) -> FollowedPath:
        """A path as the program writes it."""
        return cls(
            branches=tuple(_branch(branch) for branch in found["branches"]),
            folds=tuple(
                Fold(
                    at=float(fold["at_sample"]),
                    error=fold["error"],
                    branches=tuple(int(number) - 1 for number in fold["branches"]),
                    kind=str(fold["kind"]),
                )
                for fold in found["folds"]
            ),
            changes=tuple((int(start), int(end)) for start, end in found["posture_changes"]),
            samples=len(found["samples"]),
            settled=bool(found["settled"]),
        )


def _branch(found: Mapping[str, Any]) -> Branch:
    return Branch(
        first=int(found["from"]["sample"]),
        begins=str(found["from"]["kind"]),
        ends=str(found["to"]["kind"]),
        within_limits=bool(found["within_limits"]),
        positions=tuple(Position.from_json(position) for position in found["solutions"]),
    )
