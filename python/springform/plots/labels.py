"""Names beside points, placed so that they hide neither each other nor the drawing."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib.patheffects as effects
import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from .style import INK

_TURNS = np.radians([0, 20, -20, 40, -40, 65, -65, 90, -90, 120, -120, 150, -150, 180])
_MISSING = 1e9


def place_labels(
    axes: Axes,
    points: NDArray[np.float64],
    texts: Sequence[str],
    *,
    crowd: NDArray[np.float64],
    size: float,
    gap: float = 6.0,
) -> None:
    """Write texts beside points (n, 2), away from the middle of `crowd` and of what is there.

    `crowd` (k, 2) are points of the drawing; all are in data coordinates. `size` is that of the
    type, `gap` the distance from a point to its text [pt]. The axes' limits must be set.
    """
    axes.apply_aspect()
    figure = axes.figure
    to_points = 72.0 / figure.dpi
    targets = axes.transData.transform(points) * to_points
    around = axes.transData.transform(crowd) * to_points
    frame = axes.get_window_extent()
    low, high = np.array([frame.p0, frame.p1]) * to_points
    middle = (around.min(axis=0) + around.max(axis=0)) / 2
    taken, taken_half = np.empty((0, 2)), np.empty((0, 2))
    for point, target, text in zip(points, targets, texts, strict=True):
        outward = target - middle
        heading = np.arctan2(outward[1], outward[0]) if np.any(outward) else np.pi / 2
        half = np.array([0.28 * size * len(text), 0.55 * size])
        near = around[np.all(np.abs(around - target) < 2 * half + gap + 8, axis=1)]
        best, best_cost = np.zeros(2), np.inf
        for reach in (gap, 1.4 * gap, 1.9 * gap, 3.0 * gap):
            for turn in _TURNS:
                way = np.array([np.cos(heading + turn), np.sin(heading + turn)])
                # Beside the point a text starts or ends there; above and below it is centred.
                middle_of_text = target + way * reach + half * np.clip(1.5 * way, -1, 1)
                cost = 0.6 * abs(turn) + 0.12 * reach
                cost += 0.35 * np.sum(np.all(np.abs(near - middle_of_text) < half + 0.5, axis=1))
                apart = half + taken_half
                cost += 200.0 * np.sum(np.all(np.abs(taken - middle_of_text) < apart, axis=1))
                cost += 200.0 * np.sum(np.all(np.abs(targets - middle_of_text) < half + 2, axis=1))
                outside = np.any(middle_of_text - half < low) or np.any(
                    middle_of_text + half > high
                )
                cost += _MISSING * bool(outside)
                if cost < best_cost:
                    best, best_cost = middle_of_text, cost
        taken, taken_half = np.vstack([taken, best]), np.vstack([taken_half, half])
        written = axes.annotate(
            text,
            (point[0], point[1]),
            xytext=(best[0] - target[0], best[1] - target[1]),
            textcoords="offset points",
            ha="center",
            va="center_baseline",
            fontsize=size,
            color=INK,
            zorder=10,
            parse_math=False,
        )
        written.set_path_effects([effects.withStroke(linewidth=2.0, foreground="white")])
