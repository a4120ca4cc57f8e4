"""Drawings by matplotlib, if it is installed: axes with the same scale in both directions."""

from __future__ import annotations

from typing import Any


def plane_axes(axes: Any = None) -> Any:
    """The given axes, or axes of a new figure, with equal scales and names."""
    if axes is None:
        try:
            from matplotlib import pyplot
        except ImportError as missing:
            raise ImportError("plots need matplotlib: pip install matplotlib") from missing
        _, axes = pyplot.subplots()
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("x")
    axes.set_ylabel("y")
    return axes
