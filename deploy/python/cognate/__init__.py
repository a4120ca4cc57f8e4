"""All isolated solutions of systems of polynomial equations, by following paths (homotopy continuation).

Every path is accounted for, and the counts add up, or a warning says what is not settled.

>>> import cognate as cg
>>> found = cg.solve(["x^2 + y^2 - 4", "x*y - 1"])
>>> len(found.solutions), len(found.real), found.settled
(4, 4, True)

In reading order: `solve` and `System`; `Options`; `Result`, `Solution` and `Certificate`; `Service` and `Job`
for coordinators; `formats` for the files of other programs; errors and warnings.
"""

from . import formats
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
from .options import Options
from .program import Progress
from .result import PathCounts, Result, SolutionCounts, TargetResult
from .service import Job, Service
from .solution import Box, Certificate, Solution
from .solving import solve, solve_async
from .system import System

__version__ = "0.1.0"

__all__ = [
    "Box",
    "Cancelled",
    "Certificate",
    "CognateError",
    "CognateWarning",
    "InputError",
    "Job",
    "NotKnown",
    "Options",
    "PathCounts",
    "ProgramNotFound",
    "Progress",
    "Result",
    "RoundedWarning",
    "Service",
    "ServiceError",
    "Solution",
    "SolutionCounts",
    "System",
    "TargetResult",
    "Unreachable",
    "Unsettled",
    "UnsettledWarning",
    "formats",
    "solve",
    "solve_async",
]
