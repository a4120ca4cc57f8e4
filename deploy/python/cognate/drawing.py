"""Drawings by matplotlib, where it is installed: axes in which both directions have the same scale."""

from __future__ import annotations

from typing import Any


def plane_axes(axes: Any = None) -> Any:
    """The axes that are given, or those of a new figure, with equal scales and names."""
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
