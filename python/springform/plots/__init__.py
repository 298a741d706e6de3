"""Pictures of designs and runs."""

from __future__ import annotations

from pathlib import Path

from ..design import Design
from . import style
from .net import draw_net, net_figure
from .view import AXONOMETRIC, FRONT, PLAN, SIDE, View

__all__ = ["AXONOMETRIC", "FRONT", "PLAN", "SIDE", "View", "draw_net", "plot_design"]


def plot_design(design: Design, folder: str | Path) -> list[Path]:
    """x."""
    equilibrium = design.solve()
    folder = style.make_folder(folder)
    with style.styled():
        net = net_figure(design, equilibrium)
        return [style.save(net, folder, "net.png"), style.save(net, folder, "net.svg")]
