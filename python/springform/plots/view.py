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


_AZIMUTHS = (-62.0, -50.0, -38.0, -26.0, -74.0)


def axonometric(positions: Floats, springs: NDArray[np.uint32]) -> View:
    """Return a view from the front, the right and above that shows much of the net.

    Flat nets are seen from higher up. `positions` (n, 3), `springs` (m, 2) node numbers.
    """
    points = along_springs(positions, springs)
    if not len(points):
        return AXONOMETRIC
    sizes = np.ptp(positions, axis=0)
    flatness = 1 - float(sizes[2]) / max(float(np.max(sizes)), 1e-12)
    elevation = AXONOMETRIC.elevation + round(18 * flatness)
    best, best_seen = AXONOMETRIC, 0.0
    for azimuth in _AZIMUTHS:
        view = View(AXONOMETRIC.name, azimuth, elevation)
        # What is seen: squares of paper, a fiftieth of the net wide, that springs cross.
        squares = np.floor(view.project(points)[:, :2] * (50 / max(float(np.max(sizes)), 1e-12)))
        seen = float(len(np.unique(squares, axis=0)))
        # The first is usual; another must be clearly better.
        if seen > best_seen * 1.06:
            best, best_seen = view, seen
    return best


def along_springs(positions: Floats, springs: NDArray[np.uint32]) -> Floats:
    """Return five points along every spring, (5 m, 3) for positions (n, 3)."""
    ends = positions[springs.astype(np.intp)]
    shares = np.linspace(0, 1, 5)[:, None, None]
    points: Floats = (ends[:, 0] + shares * (ends[:, 1] - ends[:, 0])).reshape(-1, 3)
    return points


def broadest(positions: Floats) -> View:
    """Return the view along an axis in which positions (n, 3) take the largest rectangle."""
    sizes = np.ptp(positions, axis=0) if len(positions) else np.zeros(3)
    areas = {PLAN: sizes[0] * sizes[1], FRONT: sizes[0] * sizes[2], SIDE: sizes[1] * sizes[2]}
    return max(areas, key=lambda view: areas[view])
