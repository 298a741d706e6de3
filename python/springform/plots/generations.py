"""A run by generation: springs, force differential and spring utilization factor."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from ..run import Run
from . import style
from .view import Floats

_WIDTH, _HEIGHT = 8.5, 7.6
_LEFT, _RIGHT, _HEAD, _FOOT, _BETWEEN = 0.95, 0.4, 1.15, 0.6, 0.36
_SHARES = (5, 25, 50, 75, 95)

_PANELS = (
    ("springs", "springs"),
    ("force_differential", "force differential"),
    ("suf", "spring utilization factor"),
)


def generations_figure(run: Run) -> Figure:
    """Return springs, force differential and SUF of parents and population by generation."""
    figure = style.new_figure(_WIDTH, _HEIGHT)
    table = run.table
    individuals = len(table["springs"]) if table else 0
    generations = style.count(run.generations, "generation")
    facts = f"{generations}  ·  {style.count(individuals, 'individual')}"
    style.add_title(figure, run.design.name, facts)
    _add_legend(figure)
    tall = (_HEIGHT - _HEAD - _FOOT - 2 * _BETWEEN) / 3
    for number, (column, name) in enumerate(_PANELS):
        bottom = _FOOT + (2 - number) * (tall + _BETWEEN)
        axes = style.add_axes(figure, _LEFT, bottom, _WIDTH - _LEFT - _RIGHT, tall)
        last = number == len(_PANELS) - 1
        start = run.start.get(column)
        line = parent_values(run, column, np.nan if start is None else float(start))
        bands = spread(table, column, run.generations)
        _draw_panel(axes, line, bands)
        axes.set_title(name, loc="left", fontsize=style.TEXT, fontweight="bold", pad=5)
        axes.set_xlim(0, max(run.generations, 1))
        axes.xaxis.set_major_locator(MaxNLocator(8, integer=True, steps=[1, 2, 5, 10]))
        axes.tick_params(axis="x", labelbottom=last)
        if last:
            axes.set_xlabel("generation")
    return figure


def parent_values(run: Run, column: str, start: float) -> Floats:
    """Return a measure of the parent after every generation, (generations + 1,); first the start.

    NaN is undefined.
    """
    values = np.full(run.generations + 1, np.nan)
    values[0] = start
    generations, individuals = run.table.get("generation"), run.table.get("individual")
    for generation, winner in enumerate(run.parents, start=1):
        values[generation] = values[generation - 1]
        if winner is not None and generations is not None and individuals is not None:
            row = np.flatnonzero((generations == generation) & (individuals == winner))[0]
            values[generation] = run.table[column][row]
    return values


def spread(table: Mapping[str, NDArray[Any]], column: str, generations: int) -> Floats:
    """Return the 5, 25, 50, 75 and 95 % quantiles of every generation, (5, generations).

    Undefined individuals do not count; a generation of nothing else is NaN.
    """
    quantiles = np.full((len(_SHARES), generations), np.nan)
    if not table:
        return quantiles
    values = table[column].astype(np.float64)
    if "valid" in table:
        values = np.where(table["valid"].astype(bool), values, np.nan)
    ends = np.searchsorted(table["generation"], np.arange(generations + 1), side="right")
    for generation, (first, last) in enumerate(pairwise(ends)):
        defined = values[first:last]
        defined = defined[np.isfinite(defined)]
        if len(defined):
            quantiles[:, generation] = np.percentile(defined, _SHARES)
    return quantiles


def _draw_panel(axes: Axes, parents: Floats, bands: Floats) -> None:
    generations = np.arange(1, bands.shape[1] + 1)
    if len(generations) == 1:
        # One generation has no width: its band is drawn as wide as it stands for.
        generations, bands = np.array([0.9, 1.1]), np.repeat(bands, 2, axis=1)
    for outer, inner, shade in ((0, 4, 0.18), (1, 3, 0.32)):
        axes.fill_between(
            generations, bands[outer], bands[inner], color=style.SPREAD, alpha=shade, linewidth=0
        )
    axes.plot(generations, bands[2], color=style.SPREAD, linewidth=0.9)
    few = len(parents) <= 30
    axes.plot(
        np.arange(len(parents)), parents, color=style.ACCENT, linewidth=1.3,
        marker="o" if few else "", markersize=2.5, clip_on=False, zorder=3,
    )  # fmt: skip
    axes.grid(axis="y", color=style.PALE, linewidth=0.5)
    axes.spines["left"].set_visible(False)
    axes.tick_params(axis="y", length=0)
    _set_limits(axes, np.concatenate([bands.ravel(), parents]))


def _set_limits(axes: Axes, values: Floats) -> None:
    """Fit the vertical axis to what is shown, on a log scale if it spans more than a decade."""
    values = values[np.isfinite(values)]
    if not len(values):
        axes.set_ylim(0, 1)
        axes.set_yticks([])
        axes.text(0.5, 0.5, "undefined", transform=axes.transAxes, ha="center", color=style.GREY)
        return
    low, high = float(values.min()), float(values.max())
    if low > 0 and high > 10 * low:
        axes.set_yscale("log")
        low, high = low / 1.15, high * 1.15
        style.set_ticks(axes.yaxis, low, high, log=True)
    else:
        # A few extreme generations must not flatten all others.
        least, most = (float(value) for value in np.percentile(values, (0.5, 99.5)))
        border = 0.08 * (most - least) or 0.1 * abs(most) or 1.0
        low, high = max(low, least - 3 * border) - border, min(high, most + 3 * border) + border
        style.set_ticks(axes.yaxis, low, high, log=False)
    axes.set_ylim(low, high)


def _add_legend(figure: Figure) -> None:
    entries = [
        Line2D([], [], color=style.ACCENT, linewidth=1.3, label="parent"),
        Line2D([], [], color=style.SPREAD, linewidth=0.9, label="population: median"),
        Patch(facecolor=style.SPREAD, alpha=0.45, label="middle half"),
        Patch(facecolor=style.SPREAD, alpha=0.18, label="5 to 95 %"),
    ]
    figure.legend(
        handles=entries, ncols=4, loc="upper right", handlelength=1.5, columnspacing=1.4,
        bbox_to_anchor=(1 - _RIGHT / _WIDTH, 1 - 0.46 / _HEIGHT), borderpad=0, borderaxespad=0,
    )  # fmt: skip
