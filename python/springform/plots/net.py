"""The net coloured by force, seen from two sides."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import LogNorm, Normalize, to_rgba
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..design import Design
from ..network import Equilibrium
from ..readings import slack
from . import style
from .labels import place_labels
from .view import AXONOMETRIC, Floats, View, along_springs, axonometric, broadest

_WIDTH, _LARGEST_HEIGHT = 11.0, 9.0
_MARGIN, _HEAD, _FOOT, _BORDER = 0.4, 0.85, 1.05, 0.42


def draw_net(
    axes: Axes,
    design: Design,
    equilibrium: Equilibrium,
    *,
    view: View = AXONOMETRIC,
    norm: Normalize | None = None,
    names: bool = True,
) -> ScalarMappable:
    """Draw a net at equilibrium into axes of any figure, and return its colours for a colour bar.

    Springs are coloured by force [N] on the scale `norm` (None: over all forces); stronger ones
    are thicker, nearer ones hide farther ones where they cross. Slack ones are dashed and grey,
    rods thick and green. `names` writes the anchors' names.
    Limits that the axes were given stay; otherwise the net fills them.
    """
    springs = design.network().springs
    norm = _force_norm(design, equilibrium) if norm is None else norm
    seen = view.project(equilibrium.positions)
    rods = np.arange(len(springs)) >= design.cords.stop
    _draw_springs(axes, seen[springs.astype(np.intp)], equilibrium, rods, norm)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_axis_off()
    if axes.get_autoscale_on():
        low, high = seen[:, :2].min(axis=0), seen[:, :2].max(axis=0)
        border = 0.06 * float(np.max(high - low))
        axes.set_xlim(low[0] - border, high[0] + border)
        axes.set_ylim(low[1] - border, high[1] + border)
    _draw_anchors(axes, design, seen, names=names)
    return ScalarMappable(norm, style.FORCE_COLOURS)


def net_figure(design: Design, equilibrium: Equilibrium) -> Figure:
    """Return two views of a net at one scale, with one colour bar, one scale bar and a title."""
    positions = equilibrium.positions
    views = (axonometric(positions, design.network().springs), broadest(positions))
    spans = [_span(view.project(positions)) for view in views]
    inner = _WIDTH - 2 * _MARGIN - 4 * _BORDER
    highest = max(span[1] for span in spans)
    # Inches for a metre, so that both views fit side by side.
    scale = min(
        inner / sum(span[0] for span in spans),
        (_LARGEST_HEIGHT - _HEAD - _FOOT - 2 * _BORDER) / highest,
    )
    height = _HEAD + highest * scale + 2 * _BORDER + _FOOT
    figure = style.new_figure(_WIDTH, height)
    style.add_title(figure, design.name, _facts(design, equilibrium), margin=_MARGIN)

    norm = _force_norm(design, equilibrium)
    spare = inner - sum(span[0] for span in spans) * scale
    left = _MARGIN
    for view, span in zip(views, spans, strict=True):
        width = span[0] * scale + 2 * _BORDER + spare / 2
        axes = style.add_axes(figure, left, _FOOT, width, height - _HEAD - _FOOT)
        middle, size = span[2], np.array([width, height - _HEAD - _FOOT]) / scale
        axes.set_xlim(middle[0] - size[0] / 2, middle[0] + size[0] / 2)
        axes.set_ylim(middle[1] - size[1] / 2, middle[1] + size[1] / 2)
        draw_net(axes, design, equilibrium, view=view, norm=norm)
        _add_caption(axes, view)
        left += width
    _add_force_bar(figure, norm)
    _add_scale_bar(figure, scale)
    return figure


def _facts(design: Design, equilibrium: Equilibrium) -> str:
    measures = design.measure(equilibrium)
    differential = measures.force_differential
    words = [
        style.count(measures.springs, "spring"),
        style.count(measures.cells, "cell"),
        style.count(len(design.anchors), "anchor"),
        f"force differential {'undefined' if differential is None else style.plain(differential)}",
    ]
    if loose := int(slack(equilibrium, design.cords).sum()):
        words.append(f"{loose:,} slack (dashed)")
    if rods := len(design.network().rods):
        words.append(f"{style.count(rods, 'rod')} (green)")
    return "  ·  ".join(words if equilibrium.converged else [*words, "not in equilibrium"])


def _force_norm(design: Design, equilibrium: Equilibrium) -> Normalize:
    """Return the scale of the cords that carry force."""
    forces = equilibrium.forces[design.cords]
    return style.force_norm(forces[~slack(equilibrium, design.cords)])


def _span(seen: Floats) -> tuple[float, float, Floats]:
    low, high = seen[:, :2].min(axis=0), seen[:, :2].max(axis=0)
    width, height = np.maximum(high - low, 0.02 * max(1e-9, float(np.max(high - low))))
    return float(width), float(height), (low + high) / 2


def _draw_springs(
    axes: Axes, ends: Floats, equilibrium: Equilibrium, rods: NDArray[np.bool_], norm: Normalize
) -> None:
    forces, loose = equilibrium.forces, slack(equilibrium) & ~rods
    count = len(ends)
    middles = ends.mean(axis=1)
    depth = middles[:, 2]
    near = (depth - depth.min()) / max(float(np.ptp(depth)), 1e-12)
    order = np.argsort(depth, kind="stable")
    shade = np.ma.filled(norm(np.nan_to_num(forces)), 0.0)
    weight = float(np.clip((700 / max(count, 1)) ** 0.27, 0.58, 1.25))
    widths = weight * (0.65 + 1.0 * shade) * (0.75 + 0.4 * near)
    widths = np.where(rods, 2.4 * (0.75 + 0.4 * near), np.where(loose, 0.6 * weight, widths))
    colours = style.FORCE_COLOURS(shade)
    colours[rods], colours[loose] = to_rgba(style.ROD), to_rgba(style.SLACK)
    dashes = [(0.0, (2.2, 1.6)) if one else "solid" for one in loose[order]]
    # Far springs recede a little into the paper.
    colours[:, :3] += (1 - colours[:, :3]) * (0.25 * (1 - near))[:, None]

    # Each spring comes after a white casing that cuts what lies behind it. The casing stays clear
    # of the ends, where it would cut the springs that meet there, and short springs have little.
    flat = ends[:, :, :2]
    lengths = np.hypot(*(flat[:, 1] - flat[:, 0]).T)
    typical = max(float(np.max(np.ptp(flat.reshape(-1, 2), axis=0))) / 25, 1e-12)
    gaps = 1.0 * weight * np.minimum(lengths / typical, 1.0)
    casing = flat.mean(axis=1, keepdims=True) + 0.56 * (flat - flat.mean(axis=1, keepdims=True))
    lines = np.stack([casing, flat], axis=1)[order].reshape(2 * count, 2, 2)
    white = np.ones_like(colours)
    axes.add_collection(
        LineCollection(
            list(lines),
            colors=np.stack([white, colours], axis=1)[order].reshape(2 * count, 4),
            linewidths=np.stack([widths + gaps, widths], axis=1)[order].reshape(-1),
            linestyles=[one for dash in dashes for one in ("solid", dash)],
            capstyle="butt",
            zorder=2,
        ),
        autolim=False,
    )


def _draw_anchors(axes: Axes, design: Design, seen: Floats, *, names: bool) -> None:
    points = seen[design.anchors]
    axes.plot(
        points[:, 0],
        points[:, 1],
        linestyle="none",
        marker="o",
        markersize=3.6,
        markerfacecolor="white",
        markeredgecolor=style.INK,
        markeredgewidth=0.8,
        zorder=5,
        scalex=False,
        scaley=False,
    )
    if not names or not len(points):
        return
    # Anchors one behind the other share one label.
    close = 0.012 * max(float(np.max(np.ptp(seen[:, :2], axis=0))), 1e-12)
    groups: list[list[int]] = []
    for number, point in enumerate(points[:, :2]):
        at = (g for g in groups if np.max(np.abs(points[g[0], :2] - point)) < close)
        group = next(at, None)
        if group is None:
            groups.append([number])
        else:
            group.append(number)
    place_labels(
        axes,
        points[[group[0] for group in groups], :2],
        [", ".join(design.anchor_names[number] for number in group) for group in groups],
        crowd=along_springs(seen, design.network().springs)[:, :2],
        size=style.SMALL,
    )


def _add_caption(axes: Axes, view: View) -> None:
    """Name the view below it, with the directions of x, y and z as seen there."""
    figure = axes.figure
    assert isinstance(figure, Figure)
    across, up = figure.get_size_inches()
    place = axes.get_position()
    centre = np.array([(place.x0 + place.x1) / 2 * across, place.y0 * up - 0.08])
    directions = view.axes()[:2].T
    length, wide = 0.17, 0.55
    origin = centre + np.array([-wide, 0.0])
    figure.text(
        (centre[0] - wide + 0.3) / across,
        centre[1] / up,
        view.name,
        fontsize=style.TEXT,
        color=style.GREY,
        va="center_baseline",
    )
    triad = style.add_axes(figure, origin[0] - 0.35, origin[1] - 0.35, 0.7, 0.7)
    triad.set_xlim(-0.35, 0.35)
    triad.set_ylim(-0.35, 0.35)
    triad.set_axis_off()
    # Centred on what is seen of it, so that it stands level with the name.
    middle = (directions.min(axis=0).clip(max=0) + directions.max(axis=0).clip(min=0)) / 2 * length
    for name, direction in zip("xyz", directions, strict=True):
        tip = direction * length
        if np.hypot(*tip) < 0.3 * length:
            continue
        triad.plot(*np.stack([-middle, tip - middle], axis=1), color=style.GREY, linewidth=0.7)
        name_at = tip * (1 + 0.07 / np.hypot(*tip)) - middle
        triad.text(
            name_at[0],
            name_at[1],
            name,
            fontsize=5.5,
            color=style.GREY,
            ha="center",
            va="center",
        )


def _add_force_bar(figure: Figure, norm: Normalize) -> None:
    colours = ScalarMappable(norm, style.FORCE_COLOURS)
    log = isinstance(norm, LogNorm)
    bar_axes = style.add_axes(figure, _MARGIN, 0.5, 4.2, 0.09)
    bar = figure.colorbar(colours, cax=bar_axes, orientation="horizontal")
    bar.outline.set_visible(False)
    low, high = style.ends(norm)
    bar.minorticks_off()
    style.set_ticks(bar_axes.xaxis, low, high, log=log)
    bar_axes.tick_params(length=2.5, pad=2)
    bar_axes.set_title("spring force [N]", loc="left", fontsize=style.TEXT, pad=4)
    ends = f"{style.plain(low)} to {style.plain(high)} N"
    scale = f"{ends}, logarithmic" if log else ends
    bar_axes.set_title(scale, loc="right", fontsize=style.SMALL, color=style.GREY, pad=4)


def _add_scale_bar(figure: Figure, scale: float) -> None:
    """Draw a bar of a round length [m], about an inch and a half; `scale` is inches a metre."""
    wanted = 1.6 / scale
    decade = 10.0 ** np.floor(np.log10(wanted))
    length = max(step * decade for step in (1.0, 2.0, 5.0) if step * decade <= wanted)
    inches = length * scale
    left = _WIDTH - _MARGIN - inches
    bar = style.add_axes(figure, left, 0.5, inches, 0.09)
    bar.set_axis_off()
    bar.set_xlim(0, 2)
    bar.set_ylim(0, 1)
    bar.barh(
        [0.5, 0.5],
        [1, 1],
        left=[0, 1],
        height=0.55,
        color=[style.INK, "white"],
        edgecolor=style.INK,
        linewidth=0.7,
        clip_on=False,
    )
    bar.set_title(f"{style.plain(length)} m", loc="right", fontsize=style.TEXT, pad=4)
