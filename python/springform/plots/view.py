"""Views: directions in which a net is looked at, and parallel projection onto paper."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class View:
    """A direction to look at a net from: lengths across it are true, so one scale bar holds."""

    name: str
    """As it stands under the picture."""
    azimuth: float
    """Of the eye, in degrees from the x-axis towards the y-axis."""
    elevation: float
    """Of the eye above the xy-plane, in degrees."""

    def axes(self) -> Floats:
        """Return unit vectors to the right, up and towards the eye, as rows."""
        azimuth, elevation = np.radians((self.azimuth, self.elevation))
        towards = np.array(
            [
                np.cos(elevation) * np.cos(azimuth),
                np.cos(elevation) * np.sin(azimuth),
                np.sin(elevation),
            ]
        )
        right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
        axes = np.stack([right, np.cross(towards, right), towards])
        return np.where(np.abs(axes) < 1e-12, 0.0, axes)

    def project(self, positions: Floats) -> Floats:
        """Return positions (n, 3) as seen: to the right, up and towards the eye [m]."""
        # A matrix product may sum in another order on another machine.
        return np.stack([(positions * axis).sum(axis=1) for axis in self.axes()], axis=1)


AXONOMETRIC = View("axonometric", -62.0, 22.0)
"""From the front, the right and above."""

PLAN = View("plan", -90.0, 90.0)
"""From above: x to the right, y up."""

FRONT = View("front elevation", -90.0, 0.0)
"""Along the y-axis: x to the right, z up."""

SIDE = View("side elevation", 0.0, 0.0)
"""Against the x-axis: y to the right, z up."""


def broadest(positions: Floats) -> View:
    """Return the view along an axis in which positions (n, 3) take the largest rectangle."""
    sizes = np.ptp(positions, axis=0) if len(positions) else np.zeros(3)
    areas = {PLAN: sizes[0] * sizes[1], FRONT: sizes[0] * sizes[2], SIDE: sizes[1] * sizes[2]}
    return max(areas, key=lambda view: areas[view])
