"""Two designs side by side, and where force moved from one to the other."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from ..comparison import Comparison, compare
from ..design import Design
from ..network import Equilibrium
from . import style
from .depth import layout
from .net import draw_net
from .view import Floats, View, axonometric

_WIDTH, _MARGIN, _HEAD, _NETS, _FOOT, _NAME = 11.0, 0.4, 0.95, 5.4, 0.8, 0.35
_CHANGE_COLOURS = colormaps["RdBu_r"]


def plot_difference(first: Design, second: Design, path: str | os.PathLike[str]) -> Path:
    """Solve two designs and draw them beside each other into a .png or .svg file; return it.

    Both nets share one scale of length and of colour. On one framework, its unrolled map
    below shows by how much the inner force of every top-level cell changed. Raises `DesignError`:
    one of them gives no net; `WriteError`: the picture can't be written.
    """
    target = Path(path)
    equilibria = (first.closed.solve(), second.closed.solve())
    found = compare(first, second, equilibria)
    with style.styled():
        figure = difference_figure(first.closed, second.closed, equilibria, found)
        return style.save(figure, style.make_folder(target.parent), target.name)


def difference_figure(
    first: Design, second: Design, equilibria: tuple[Equilibrium, Equilibrium], found: Comparison
) -> Figure:
    """Return both nets and, on one framework, the map of changes."""
    corners, parts = layout(first)
    panels = [corners[parts == part] for part in np.unique(parts)] if found.same_framework else []
    spans = [np.ptp(panel.reshape(-1, 2), axis=0) for panel in panels]
    beside = min(len(panels), 3)
    rows = [list(range(at, min(at + beside, len(panels)))) for at in range(0, len(panels), 3)]
    inner = _WIDTH - 2 * _MARGIN - 0.3 * max(beside - 1, 0)
    unit = min((inner / sum(spans[at][0] for at in row) for row in rows), default=1.0)
    unit = min([unit] + [2.6 / float(span[1]) for span in spans])
    tall = [max(float(spans[at][1]) for at in row) * unit + _NAME for row in rows]
    height = _HEAD + _NETS + sum(tall) + _FOOT + (0.5 if panels else 0.0)
    figure = style.new_figure(_WIDTH, height)
    style.add_title(figure, f"{first.name}  →  {second.name}", _facts(found), margin=_MARGIN)
    norm = style.force_norm(np.concatenate([one.forces for one in equilibria]))
    view = axonometric(equilibria[0].positions, first.network().springs)
    _draw_nets(figure, (first, second), equilibria, view, norm, height)
    if panels:
        names = [part.name for part in first.file.framework.cylinders]
        names += [part.name for part in first.file.framework.sheets]
        changes = np.zeros(len(corners))
        for moved in found.moved:
            changes[moved.cell] = moved.change
        largest = float(np.abs(changes).max(initial=0.0)) or 1.0
        scale = Normalize(-largest, largest)
        top = height - _HEAD - _NETS
        for row, row_height in zip(rows, tall, strict=True):
            left = _MARGIN
            for at in row:
                wide, high = spans[at] * unit
                name = names[at] if names else "mesh"
                figure.text(left / _WIDTH, top / height, name, fontweight="bold", va="top",
                            parse_math=False)  # fmt: skip
                axes = style.add_axes(figure, left, top - _NAME - high, wide, high)
                chosen = changes[parts == np.unique(parts)[at]]
                _draw_changes(axes, panels[at], chosen, scale)
                left += wide + 0.3
            top -= row_height
        _add_bar(figure, scale, height)
    return figure


def _facts(found: Comparison) -> str:
    before, after = found.measures
    plain = [
        "undefined" if one.force_differential is None else style.plain(one.force_differential)
        for one in (before, after)
    ]
    words = [
        f"{before.springs:,} → {after.springs:,} springs",
        f"{before.cells:,} → {after.cells:,} cells",
        f"force differential {plain[0]} → {plain[1]}",
    ]
    if found.same_framework:
        words.append(f"changed in {style.count(len(found.changed), 'top-level cell')}")
    return "  ·  ".join(words)


def _draw_nets(
    figure: Figure,
    designs: tuple[Design, Design],
    equilibria: tuple[Equilibrium, Equilibrium],
    view: View,
    norm: Normalize,
    height: float,
) -> None:
    """Draw both nets at one scale of length."""
    seen = [view.project(one.positions)[:, :2] for one in equilibria]
    low = np.min([points.min(axis=0) for points in seen], axis=0)
    high = np.max([points.max(axis=0) for points in seen], axis=0)
    width = (_WIDTH - 2 * _MARGIN) / 2
    size = np.array([width, _NETS])
    middle = (low + high) / 2
    span = max((high - low) / (size - 0.7)) * size
    for at, (design, equilibrium) in enumerate(zip(designs, equilibria, strict=True)):
        axes = style.add_axes(figure, _MARGIN + at * width, height - _HEAD - _NETS, width, _NETS)
        axes.set_xlim(middle[0] - span[0] / 2, middle[0] + span[0] / 2)
        axes.set_ylim(middle[1] - span[1] / 2, middle[1] + span[1] / 2)
        draw_net(axes, design, equilibrium, view=view, norm=norm)
    colours = ScalarMappable(norm, style.FORCE_COLOURS)
    bar_axes = style.add_axes(figure, _MARGIN, 0.45, 4.2, 0.09)
    bar = figure.colorbar(colours, cax=bar_axes, orientation="horizontal")
    bar.outline.set_visible(False)
    bar.minorticks_off()
    first, last = style.ends(norm)
    style.set_ticks(bar_axes.xaxis, first, last, log=type(norm) is not Normalize)
    bar_axes.set_title("spring force [N]", loc="left", fontsize=style.TEXT, pad=4)


def _draw_changes(axes: Axes, quads: Floats, changes: Floats, scale: Normalize) -> None:
    low, high = quads.reshape(-1, 2).min(axis=0), quads.reshape(-1, 2).max(axis=0)
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_axis_off()
    axes.add_collection(
        PolyCollection(
            list(quads),
            facecolors=_CHANGE_COLOURS(scale(changes)),
            edgecolors=style.PALE,
            linewidths=0.4,
            clip_on=False,
        ),
        autolim=False,
    )


def _add_bar(figure: Figure, scale: Normalize, height: float) -> None:
    colours = ScalarMappable(scale, _CHANGE_COLOURS)
    axes = style.add_axes(figure, _WIDTH - _MARGIN - 4.2, 0.45, 4.2, 0.09)
    bar = figure.colorbar(colours, cax=axes, orientation="horizontal")
    bar.outline.set_visible(False)
    axes.set_title("change of a cell's inner force [N]", loc="left", fontsize=style.TEXT, pad=4)
