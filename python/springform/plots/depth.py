"""The depth map: every cell where it lies in the unrolled framework, coloured by level."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from ..design import Design
from . import style
from .patterns import NULL, pattern, type_name, type_words
from .view import Floats, broadest

_LARGEST_WIDTH, _LARGEST_HEIGHT, _LEAST_WIDTH, _MARGIN = 11.0, 8.5, 6.0, 0.4
_HEAD, _FOOT, _NAME, _BESIDE = 0.9, 0.55, 0.45, 0.4
_LINE, _SWATCH, _TITLE_WIDTH = 0.27, 0.15, 0.55


@dataclass(frozen=True)
class _Entry:
    """A swatch of the legend: what it stands for, how many cells there are, and how it looks."""

    name: str
    count: int
    fill: Floats | tuple[float, float, float, float]
    kind: str

    @property
    def text(self) -> str:
        """What stands beside the swatch."""
        return f"{self.name}  ({self.count:,})"

    @property
    def width(self) -> float:
        """Room that swatch and text take [in]."""
        return _SWATCH + 0.3 + 0.063 * len(self.text)


@dataclass(frozen=True)
class _Panel:
    """A part of the framework: its name, and which cells and corners of faces belong to it."""

    name: str
    part: int
    cells: NDArray[np.intp]
    low: Floats
    size: Floats


def depth_figure(design: Design) -> Figure:
    """Return the map of a design's expressed cells, part by part.

    A cylinder or sheet is unrolled: around or across to the right, along upwards. A mesh from a
    file is seen along the axis that shows most of it, as drawn. Lines inside a cell are the
    springs of its type, turned as the cell is.
    """
    corners, parts = layout(design)
    faces = design.mesh.faces.astype(np.intp)
    squares = design.cells.squares.astype(np.intp)
    quads = _bilinear(corners[squares[:, 0]], squares, np.array([(0, 0), (1, 0), (1, 1), (0, 1)]))
    panels = _panels(design, quads, parts[squares[:, 0]])
    columns, unit = _arrangement(panels)
    rows = [panels[at : at + columns] for at in range(0, len(panels), columns)]
    tall = [max(panel.size[1] for panel in row) * unit + _NAME for row in rows]
    height = _HEAD + sum(tall) + _BESIDE * (len(rows) - 1) + _FOOT
    widest = max((float(panel.size[0]) for panel in panels), default=1.0) * unit
    column_width = widest + _BESIDE
    width = max(_LEAST_WIDTH, 2 * _MARGIN + columns * column_width - _BESIDE)
    levels = int(squares[:, 1].max(initial=0)) + 1
    # Few levels do not need the darkest shades, which would hide the lines inside cells.
    shades = style.LEVEL_COLOURS(np.arange(levels) / max(levels - 1, 4))
    lines = _legend(design, shades, width)
    height += _LINE * len(lines)
    figure = style.new_figure(width, height)
    style.add_title(figure, design.name, _facts(design, levels), margin=_MARGIN)

    top = height - _HEAD
    for row, row_height in zip(rows, tall, strict=True):
        for column, panel in enumerate(row):
            wide, high = panel.size * unit
            left = _MARGIN + column * column_width
            figure.text(
                left / width, top / height, panel.name, va="top", fontweight="bold",
                parse_math=False,
            )  # fmt: skip
            axes = style.add_axes(figure, left, top - _NAME - high, wide, high)
            axes.set_xlim(panel.low[0], panel.low[0] + panel.size[0])
            axes.set_ylim(panel.low[1], panel.low[1] + panel.size[1])
            axes.set_axis_off()
            _draw_cells(axes, design, quads, panel, shades, unit)
            _draw_anchors(axes, design, corners[parts == panel.part], faces[parts == panel.part])
        top -= row_height + _BESIDE
    _add_legend(figure, design, lines)
    return figure


def layout(design: Design) -> tuple[Floats, NDArray[np.intp]]:
    """Return the corners of every face on paper (f, 4, 2), and the face's part."""
    parts, corners = design.mesh.map
    if len(parts):
        # Half columns and half rows of a dia-grid are alike on paper.
        return corners.reshape(-1, 4, 2) / 2.0, parts.astype(np.intp)
    drawn = design.setting.drawn()
    seen = broadest(drawn).project(drawn)[:, :2]
    faces = design.mesh.faces.astype(np.intp)
    side = np.median(np.hypot(*(seen[faces[:, 1]] - seen[faces[:, 0]]).T)) if len(faces) else 1.0
    return seen[faces] / max(float(side), 1e-12), np.zeros(len(faces), dtype=np.intp)


def _bilinear(corners: Floats, squares: NDArray[np.intp], points: NDArray[np.float64]) -> Floats:
    """Return points (p, 2) of the unit square inside every cell (c, p, 2), on paper."""
    side = 0.5 ** squares[:, 1, None]
    u = (squares[:, 2, None] + points[None, :, 0]) * side
    v = (squares[:, 3, None] + points[None, :, 1]) * side
    return _inside(corners, np.stack([u, v], axis=2))


def _inside(corners: Floats, places: Floats) -> Floats:
    """Return places (c, p, 2) of the unit square inside quads (c, 4, 2)."""
    u, v = places[..., 0], places[..., 1]
    weights = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v], axis=-1)
    inside: Floats = (weights[..., None] * corners[:, None]).sum(axis=2)
    return inside


def _panels(design: Design, quads: Floats, parts: NDArray[np.intp]) -> list[_Panel]:
    framework = design.file.framework
    names = [cylinder.name for cylinder in framework.cylinders]
    names += [sheet.name for sheet in framework.sheets]
    panels = []
    for number, name in enumerate(names or ["mesh"]):
        cells = np.flatnonzero(parts == number)
        if len(cells):
            points = quads[cells].reshape(-1, 2)
            panels.append(_Panel(name, number, cells, points.min(axis=0), np.ptp(points, axis=0)))
    return panels


def _arrangement(panels: list[_Panel]) -> tuple[int, float]:
    """Return a number of columns that shows the parts large, and inches for a unit."""
    widest = max(float(panel.size[0]) for panel in panels)
    units = []
    for columns in range(1, len(panels) + 1):
        rows = [panels[at : at + columns] for at in range(0, len(panels), columns)]
        tall = sum(max(float(panel.size[1]) for panel in row) for row in rows)
        wide = (_LARGEST_WIDTH - 2 * _MARGIN - _BESIDE * (columns - 1)) / columns
        high = _LARGEST_HEIGHT - _HEAD - _FOOT - 2 * _LINE
        high -= len(rows) * _NAME + _BESIDE * (len(rows) - 1)
        units.append(min(max(wide, 0.1) / max(widest, 1e-9), max(high, 1.0) / max(tall, 1e-9)))
    # Twice the columns on half the paper are worth a little size.
    columns = max(at for at, unit in enumerate(units, start=1) if unit >= 0.85 * max(units))
    return columns, units[columns - 1]


def _facts(design: Design, levels: int) -> str:
    framework = design.file.framework
    sideways = "around" if framework.cylinders else "across"
    words = [
        f"{style.count(len(design.cells.addresses), 'cell')} by level, deepest {levels - 1}",
        "as drawn" if framework.mesh else f"unrolled: {sideways} to the right, along upwards",
    ]
    return "  ·  ".join(words)


def _draw_cells(
    axes: Axes, design: Design, quads: Floats, panel: _Panel, shades: Floats, unit: float
) -> None:
    squares, types = design.cells.squares.astype(np.intp), design.cells.types
    levels = squares[panel.cells, 1]
    empty = np.array([types[cell] == NULL for cell in panel.cells])
    fills = shades[levels].copy()
    fills[empty] = 1.0
    edges = np.ones_like(fills)
    edges[empty] = to_rgba(style.PALE)
    sides = np.hypot(*(quads[panel.cells, 1] - quads[panel.cells, 0]).T) * unit * 72
    fine = np.clip(sides / 14, 0.15, 0.8)
    axes.add_collection(
        PolyCollection(
            list(quads[panel.cells]),
            facecolors=fills,
            edgecolors=edges,
            linewidths=fine,
            joinstyle="round",
            clip_on=False,
        ),
        autolim=False,
    )
    _draw_patterns(axes, design, quads[panel.cells], panel, shades[levels], sides)


def _draw_patterns(
    axes: Axes, design: Design, quads: Floats, panel: _Panel, fills: Floats, sides: Floats
) -> None:
    """Draw the springs inside the cells of a part; `sides` are the lengths of sides [pt]."""
    segments, colours, widths = [], [], []
    words = np.array(type_words(design, panel.cells))
    for word in np.unique(words):
        drawn = pattern(design, str(word))
        if not len(drawn):
            continue
        chosen = np.flatnonzero(words == word)
        places = np.broadcast_to(drawn.reshape(-1, 2), (len(chosen), 2 * len(drawn), 2))
        segments.append(_inside(quads[chosen], places).reshape(-1, 2, 2))
        # Dark lines on light shades and the other way round.
        light = fills[chosen, :3].mean(axis=1) > 0.55
        ink = np.where(light[:, None], to_rgba(style.INK), to_rgba("white"))
        colours.append(np.repeat(ink, len(drawn), axis=0))
        widths.append(np.repeat(np.clip(sides[chosen] / 32, 0.15, 0.6), len(drawn)))
    if segments:
        axes.add_collection(
            LineCollection(
                list(np.concatenate(segments)),
                colors=np.concatenate(colours),
                linewidths=np.concatenate(widths),
                capstyle="round",
            ),
            autolim=False,
        )


def _draw_anchors(axes: Axes, design: Design, corners: Floats, faces: NDArray[np.intp]) -> None:
    """Mark the anchors where corners (f, 4, 2) of faces (f, 4) lie on them; name each once."""
    points: list[Floats] = []
    names: list[str] = []
    for anchor, name in zip(design.anchors, design.anchor_names, strict=True):
        key = design.nodes[anchor]
        places = np.unique(corners[faces == int(key[1:])], axis=0)
        points.extend(places)
        # An anchor on the cut of a cylinder shows at both ends.
        names.extend([name] * len(places))
    if not points:
        return
    at = np.array(points)
    axes.plot(
        at[:, 0], at[:, 1], linestyle="none", marker="o", markersize=3.6, clip_on=False,
        markerfacecolor="white", markeredgecolor=style.INK, markeredgewidth=0.8, zorder=5,
        scalex=False, scaley=False,
    )  # fmt: skip
    middle = float(np.mean(axes.get_ylim()))
    for (x, y), name in zip(at, names, strict=True):
        upwards = y >= middle
        axes.annotate(
            name, (x, y), xytext=(0, 5 if upwards else -5), textcoords="offset points",
            ha="center", va="bottom" if upwards else "top", fontsize=style.SMALL,
            parse_math=False,
        )  # fmt: skip


def _legend(design: Design, shades: Floats, width: float) -> list[tuple[str, list[_Entry]]]:
    """Return the lines of the legend: their title and entries, no wider than a width [in]."""
    levels = Counter(int(level) for level in design.cells.squares[:, 1])
    types = Counter(design.cells.types)
    blank = {kind: to_rgba("white") if kind == NULL else shades[0] for kind in types}
    rows = [
        ("level", [_Entry(str(at), n, shades[at], "") for at, n in sorted(levels.items())]),
        ("type", [_Entry(type_name(k), n, blank[k], k) for k, n in sorted(types.items())]),
    ]
    lines: list[tuple[str, list[_Entry]]] = []
    for title, entries in rows:
        lines.append((title, []))
        used = 0.0
        for entry in entries:
            if lines[-1][1] and used + entry.width > width - 2 * _MARGIN - _TITLE_WIDTH:
                lines.append(("", []))
                used = 0.0
            lines[-1][1].append(entry)
            used += entry.width
    return lines


def _add_legend(figure: Figure, design: Design, lines: list[tuple[str, list[_Entry]]]) -> None:
    """Name levels and types below the map, each with its swatch and its number of cells."""
    across, _ = figure.get_size_inches()
    height = _FOOT + _LINE * len(lines)
    axes = style.add_axes(figure, 0, 0, across, height)
    axes.set_xlim(0, across)
    axes.set_ylim(0, height)
    axes.set_axis_off()
    for number, (title, entries) in enumerate(lines, start=1):
        left, bottom = _MARGIN, 0.3 + _LINE * (len(lines) - number)
        middle = bottom + _SWATCH / 2
        axes.text(left, middle, title, va="center_baseline", fontweight="bold")
        left += _TITLE_WIDTH
        for entry in entries:
            edge = style.GREY if entry.kind else "none"
            axes.add_patch(
                Rectangle((left, bottom), _SWATCH, _SWATCH, fc=entry.fill, ec=edge, lw=0.5)
            )
            inside = pattern(design, entry.kind) * _SWATCH + np.array([left, bottom])
            axes.add_collection(
                LineCollection(list(inside), colors=style.INK, linewidths=0.5), autolim=False
            )
            place = left + _SWATCH + 0.07
            axes.text(place, middle, entry.text, va="center_baseline", parse_math=False)
            left += entry.width
