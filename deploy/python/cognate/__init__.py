"""All isolated solutions of systems of polynomial equations, by path tracking (homotopy continuation).

Every path is in exactly one count. A warning names every result that is not settled.

>>> import cognate as cg
>>> found = cg.solve(["x^2 + y^2 - 4", "x*y - 1"])
>>> len(found.solutions), len(found.real), found.settled
(4, 4, True)

In reading order: `solve` and `System`; `Options`; `Result`, `Solution` and `Certificate`; `sweep`; `decompose` and
`Decomposition` for components, `exceptional` for families; `Mechanism`, `synthesize` and `synthesize_approximately` for
arms, platforms and linkages; `Service` and `Job` for coordinators; `formats` for the files of other programs; errors
and warnings.
"""

from . import formats
from .answers import Image, Multidegree, PointMobility, Proofs, RealPoints
from .approximation import Approximation, Dyad, FunctionGenerator, PathLinkage, synthesize_approximately
from .branches import Branch, Fold, FollowedPath
from .components import Component, Decomposition, Membership, RealPart, Sample, decompose
from .errors import (
    Cancelled,
    CognateError,
    CognateWarning,
    InputError,
    NotKnown,
    ProgramNotFound,
    RoundedWarning,
    ServiceError,
    Unreachable,
    Unsettled,
    UnsettledWarning,
)
from .exceptional_sets import ExceptionalMechanisms, ExceptionalSet, ExceptionalSets, MovingValues, exceptional
from .mechanism import Mechanism
from .motions import Configuration, LocalMobility, Meeting, Mode, Motion, NumberEffect
from .options import Options
from .picture import Picture
from .positions import Pose, Position, Positions, PostureSet
from .program import Progress
from .result import PathCounts, Result, SolutionCounts, TargetResult
from .served import ServedMechanism
from .service import Job, Service
from .singularities import SingularComponent, SingularCurve, Singularities, SingularityAt
from .solution import Box, Certificate, Solution
from .solving import solve, solve_async
from .sweeps import Sweep, SweepTarget, sweep
from .synthesis import Linkage, SpatialDyad, SpatialSynthesis, Synthesis, synthesize, synthesize_spatial
from .system import System
from .workspaces import BoundaryCurve, ReachedPoint, Workspace

__version__ = "0.1.0"

__all__ = [
    "Approximation",
    "BoundaryCurve",
    "Box",
    "Branch",
    "Cancelled",
    "Certificate",
    "CognateError",
    "CognateWarning",
    "Component",
    "Configuration",
    "Decomposition",
    "Dyad",
    "ExceptionalMechanisms",
    "ExceptionalSet",
    "ExceptionalSets",
    "Fold",
    "FollowedPath",
    "FunctionGenerator",
    "Image",
    "InputError",
    "Job",
    "Linkage",
    "LocalMobility",
    "Mechanism",
    "Meeting",
    "Membership",
    "Mode",
    "Motion",
    "MovingValues",
    "Multidegree",
    "NotKnown",
    "NumberEffect",
    "Options",
    "PathCounts",
    "PathLinkage",
    "Picture",
    "PointMobility",
    "Pose",
    "Position",
    "Positions",
    "PostureSet",
    "ProgramNotFound",
    "Progress",
    "Proofs",
    "ReachedPoint",
    "RealPart",
    "RealPoints",
    "Result",
    "RoundedWarning",
    "Sample",
    "ServedMechanism",
    "Service",
    "ServiceError",
    "SingularComponent",
    "SingularCurve",
    "Singularities",
    "SingularityAt",
    "Solution",
    "SolutionCounts",
    "SpatialDyad",
    "SpatialSynthesis",
    "Sweep",
    "SweepTarget",
    "Synthesis",
    "System",
    "TargetResult",
    "Unreachable",
    "Unsettled",
    "UnsettledWarning",
    "Workspace",
    "decompose",
    "exceptional",
    "formats",
    "solve",
    "solve_async",
    "sweep",
    "synthesize",
    "synthesize_approximately",
    "synthesize_spatial",
]
