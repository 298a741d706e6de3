"""Pictures of designs and runs: what people show of a net.

Every picture is drawn without a display and without global settings; the same input gives the same
bytes.
"""

from __future__ import annotations

import os
from pathlib import Path

from ..design import Design
from ..run import Run
from . import style
from .depth import depth_figure
from .difference import plot_difference
from .forces import forces_figure
from .generations import generations_figure
from .net import draw_net, net_figure
from .pareto import pareto_figure
from .view import AXONOMETRIC, FRONT, PLAN, SIDE, View

__all__ = [
    "AXONOMETRIC",
    "FRONT",
    "PLAN",
    "SIDE",
    "View",
    "draw_net",
    "plot_design",
    "plot_difference",
    "plot_run",
]


def plot_design(design: Design, folder: str | os.PathLike[str]) -> list[Path]:
    """Solve a design and draw it into a folder, which is made if need be; return the files.

    net.png and net.svg: two views of the net, coloured by force. forces.png: histogram of forces.
    depth.png: map of the cells by level and type. Raises `DesignError`: no net is left after
    filtering. `WriteError`: a picture can't be written.
    """
    equilibrium = design.solve()
    folder = style.make_folder(folder)
    with style.styled():
        net = net_figure(design, equilibrium)
        return [
            style.save(net, folder, "net.png"),
            style.save(net, folder, "net.svg"),
            style.save(forces_figure(design, equilibrium), folder, "forces.png"),
            style.save(depth_figure(design), folder, "depth.png"),
        ]


def plot_run(run: Run, folder: str | os.PathLike[str]) -> list[Path]:
    """Draw a run into a folder, which is made if need be; return the files.

    The final parent as `plot_design` does; fitness.png: springs, force differential and SUF by
    generation, of the parents and with the spread of the population; pareto.png: springs against
    force differential of all individuals. Raises as `plot_design`, and `RunError`: the table of
    measures is broken.
    """
    files = plot_design(run.best, folder)
    with style.styled():
        return [
            *files,
            style.save(generations_figure(run), Path(folder), "fitness.png"),
            style.save(pareto_figure(run), Path(folder), "pareto.png"),
        ]
