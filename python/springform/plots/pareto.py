"""All individuals of a run: springs against force differential, and the Pareto set."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from ..run import Run
from . import style
from .labels import place_labels
from .view import Floats

_WIDTH, _HEIGHT = 8.5, 6.2
_LEFT, _RIGHT, _HEAD, _FOOT = 0.95, 0.4, 1.25, 0.65


def pareto_figure(run: Run) -> Figure:
    """Return springs against force differential of all individuals, coloured by generation."""
    table = run.table
    points = np.empty((0, 2))
    generations = np.empty(0)
    front = np.empty((0, 2))
    if table:
        everyone = np.stack([table["springs"], table["force_differential"]], axis=1)
        shown = np.isfinite(everyone[:, 1])
        points, generations = everyone[shown], table["generation"][shown]
        front = everyone[run.pareto()]
    lost = (len(table["springs"]) if table else 0) - len(points)

    figure = style.new_figure(_WIDTH, _HEIGHT)
    words = [style.count(len(points), "individual"), f"{len(front):,} in the Pareto set"]
    if lost:
        words.append(f"{lost:,} undefined, not shown")
    style.add_title(figure, run.design.name, "  ·  ".join(words))
    axes = style.add_axes(figure, _LEFT, _FOOT, _WIDTH - _LEFT - _RIGHT, _HEIGHT - _HEAD - _FOOT)
    axes.set_xlabel("springs")
    axes.set_title("force differential", loc="left", fontsize=style.TEXT, fontweight="bold", pad=6)
    axes.grid(color=style.PALE, linewidth=0.5)
    norm = Normalize(1, max(run.generations, 2))
    axes.scatter(
        points[:, 0], points[:, 1], c=style.GENERATION_COLOURS(norm(generations)),
        s=float(np.clip(30000 / max(len(points), 1), 2, 14)), linewidths=0, alpha=0.75,
        rasterized=True, zorder=2,
    )  # fmt: skip
    marks = _marks(run)
    everything = np.concatenate([points, marks[0]])
    if not len(everything):
        axes.text(0.5, 0.5, "undefined", transform=axes.transAxes, ha="center", color=style.GREY)
        return figure
    _set_limits(axes, everything)
    _draw_front(axes, front)
    sample = everything[:: max(1, len(everything) // 4000)]
    # Text may lie on a few points, but not on the front.
    crowd = np.concatenate([sample, _along_front(axes, front)])
    _draw_marks(axes, *marks, crowd=crowd)
    if run.generations > 1:
        _add_generations(figure, run.generations)
    return figure


def _marks(run: Run) -> tuple[Floats, list[str], list[str]]:
    """Return where start, best and lowest lie, what they are called, and their markers."""
    standings: list[tuple[str, str, Mapping[str, Any] | None]] = [
        ("start", "s", run.start),
        ("best", "o", run.final if run.generations else None),
        ("lowest", "D", run.lowest_standing),
    ]
    at: list[tuple[float, float]] = []
    names: list[str] = []
    markers: list[str] = []
    for name, marker, standing in standings:
        if standing is None or standing["force_differential"] is None:
            continue
        springs, differential = standing["springs"], standing["force_differential"]
        if (springs, differential) in at:
            # The best may be the lowest too.
            same = at.index((springs, differential))
            names[same] = f"{name}, {names[same]}"
            continue
        at.append((springs, differential))
        words = style.count(springs, "spring")
        names.append(f"{name}: {words}, differential {style.plain(differential)}")
        markers.append(marker)
    return np.array(at, dtype=np.float64).reshape(-1, 2), names, markers


def _set_limits(axes: Axes, points: Floats) -> None:
    low, high = points.min(axis=0), points.max(axis=0)
    border = 0.05 * (high[0] - low[0]) or 1.0
    axes.set_xlim(low[0] - border, high[0] + border)
    axes.xaxis.set_major_locator(MaxNLocator(8, integer=True, steps=[1, 2, 5, 10]))
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:,.0f}")
    if low[1] > 0 and high[1] > 6 * low[1]:
        axes.set_yscale("log")
        stretch = (high[1] / low[1]) ** 0.06
        axes.set_ylim(low[1] / stretch, high[1] * stretch)
        style.set_ticks(axes.yaxis, *axes.get_ylim(), log=True)
    else:
        border = 0.08 * (high[1] - low[1]) or 0.1 * abs(high[1]) or 1.0
        axes.set_ylim(low[1] - border, high[1] + border)
        style.set_ticks(axes.yaxis, *axes.get_ylim(), log=False, count=6)


def _draw_front(axes: Axes, front: Floats) -> None:
    if not len(front):
        return
    # Up to the next member's springs, the best with at least so many springs is that next member.
    stairs = np.concatenate([[(axes.get_xlim()[0], front[0, 1])], front])
    for colour, width, order in (("white", 2.6, 3), (style.ACCENT, 1.1, 4)):
        axes.plot(
            *stairs.T, color=colour, drawstyle="steps-pre", linewidth=width, zorder=order,
            scalex=False, scaley=False,
        )  # fmt: skip
    low, high = axes.get_xlim()
    middle = low + 0.55 * (high - low)
    at = min(int(np.searchsorted(front[:, 0], middle)), len(front) - 1)
    axes.annotate(
        "Pareto set", (min(middle, front[-1, 0]), front[at, 1]), xytext=(0, -7),
        textcoords="offset points", ha="center", va="top", fontsize=style.SMALL,
        color=style.ACCENT,
    )  # fmt: skip


def _along_front(axes: Axes, front: Floats) -> Floats:
    if not len(front):
        return front
    springs = np.linspace(axes.get_xlim()[0], front[-1, 0], 400)
    return np.stack([springs, front[np.searchsorted(front[:, 0], springs), 1]], axis=1)


def _draw_marks(
    axes: Axes, at: Floats, names: list[str], markers: list[str], *, crowd: Floats
) -> None:
    for point, marker in zip(at, markers, strict=True):
        axes.plot(
            *point, marker=marker, markersize=6, markerfacecolor=style.ACCENT, zorder=6,
            markeredgecolor="white", markeredgewidth=1.0, scalex=False, scaley=False,
        )  # fmt: skip
    if len(at):
        place_labels(axes, at, names, crowd=crowd, size=style.TEXT, gap=8.0)


def _add_generations(figure: Figure, generations: int) -> None:
    colours = ScalarMappable(Normalize(1, generations), style.GENERATION_COLOURS)
    bar_axes = style.add_axes(figure, _WIDTH - _RIGHT - 2.2, _HEIGHT - 0.72, 2.2, 0.08)
    bar = figure.colorbar(colours, cax=bar_axes, orientation="horizontal")
    bar.outline.set_visible(False)
    bar_axes.xaxis.set_major_locator(MaxNLocator(4, integer=True, steps=[1, 2, 5, 10]))
    bar_axes.tick_params(length=2.5, pad=2)
    bar_axes.set_title("generation", loc="left", fontsize=style.SMALL, color=style.GREY, pad=3)
