"""Figures of a net, as windows are told of them."""

from __future__ import annotations

from .message_base import Message


class Figures(Message):
    """Measures of the net at equilibrium."""

    springs: int
    nodes: int
    cells: int
    force_differential: float | None
    force_min: float
    force_max: float
    force_mean: float
    total_length: float
    area: float
    shortest_spring: float
    converged: bool
    reason: str
