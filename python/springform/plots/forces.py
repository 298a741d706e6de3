"""How the forces of a net are distributed."""

from __future__ import annotations

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from ..design import Design
from ..network import Equilibrium
from ..readings import slack
from . import style

_WIDTH, _HEIGHT = 7.0, 4.0


def forces_figure(design: Design, equilibrium: Equilibrium) -> Figure:
    """Return a histogram of forces of cords that are not slack [N], with its ends and mean."""
    cords = equilibrium.forces[design.cords]
    forces = cords[~slack(equilibrium, design.cords)]
    if not forces.size:
        forces = cords
    norm = style.force_norm(forces)
    log = isinstance(norm, LogNorm)
    low, high = style.ends(norm)
    count = int(np.clip(round(2 * len(forces) ** (1 / 3)), 8, 48))
    edges = np.geomspace(low, high, count + 1) if log else np.linspace(low, high, count + 1)
    tall, _ = np.histogram(np.clip(forces, low, high), edges)
    middles = np.sqrt(edges[1:] * edges[:-1]) if log else (edges[1:] + edges[:-1]) / 2

    lost = int(np.count_nonzero(forces < low))
    figure = style.new_figure(_WIDTH, _HEIGHT)
    words = [f"{style.count(len(forces), 'spring')} by force"]
    if len(forces) < len(cords):
        words.append(f"{len(cords) - len(forces):,} slack and left out")
    if log:
        words.append("logarithmic scale")
    if lost:
        words.append(f"{lost:,} too weak for it in the first bar")
    facts = ", ".join(words)
    style.add_title(figure, design.name, facts)
    axes = style.add_axes(figure, 0.75, 0.6, _WIDTH - 1.1, _HEIGHT - 1.7)
    if log:
        axes.set_xscale("log")
    axes.bar(
        edges[:-1],
        tall,
        np.diff(edges),
        align="edge",
        color=style.FORCE_COLOURS(np.ma.filled(norm(middles), 0.0)),
        edgecolor="white",
        linewidth=0.6,
    )
    axes.set_xlim(low, high)
    axes.set_ylim(0, max(1, int(tall.max())) * 1.02)
    style.set_ticks(axes.xaxis, low, high, log=log, count=8)
    axes.yaxis.set_major_locator(MaxNLocator(5, integer=True))
    axes.grid(axis="y", color=style.PALE, linewidth=0.5)
    axes.spines["left"].set_visible(False)
    axes.tick_params(axis="y", length=0)
    axes.set_xlabel("spring force [N]")
    axes.set_ylabel("springs")

    marks = [
        ("smallest", float(forces.min()), "left"),
        ("mean", float(forces.mean()), "center"),
        ("largest", float(forces.max()), "right"),
    ]
    for name, value, side in marks:
        place = float(np.clip(value, low, high))
        share = np.log(place / low) / np.log(high / low) if log else (place - low) / (high - low)
        axes.plot(
            [place, place], [0, 1.04], color=style.INK, linewidth=0.8, clip_on=False,
            transform=axes.get_xaxis_transform(), scalex=False, scaley=False,
            linestyle=(0, (4, 2)) if name == "mean" else "-",
        )  # fmt: skip
        axes.text(
            # The mean keeps clear of the names at both ends.
            float(np.clip(share, 0.22, 0.78)) if name == "mean" else share,
            1.055,
            f"{name} {style.plain(value)} N",
            transform=axes.transAxes,
            ha=side,
            fontsize=style.SMALL,
        )
    return figure
