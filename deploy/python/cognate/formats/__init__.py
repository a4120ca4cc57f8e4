"""Files and objects of other programs: read and written.

Systems of Bertini and PHCpack are read and written by `System`, which the program does. Here are their lists of
solutions, phcpy's strings and dictionaries, and the text of HomotopyContinuation.jl.
"""

from . import bertini, homotopy_continuation, phcpack, phcpy

__all__ = ["bertini", "homotopy_continuation", "phcpack", "phcpy"]
