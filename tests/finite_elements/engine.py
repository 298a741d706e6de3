"""What the finite element programs have in common: an answer, or the reason why there is none."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import springform as sf


class NotValidatedError(Exception):
    """The program found no equilibrium, so nothing was checked."""


@dataclass(frozen=True)
class Answer:
    """What a program found for a network: n nodes, m springs."""

    positions: np.ndarray
    """(n, 3) [m]."""
    forces: np.ndarray
    """(m,) [N], tension positive."""
    reactions: np.ndarray
    """(n, 3) [N]: what holds the nodes; zero along free axes."""


def lengths(positions: np.ndarray, springs: np.ndarray) -> np.ndarray:
    """Lengths of springs between positions, (m,) [m]."""
    ends = positions[springs]
    return np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)


def require_cords(network: sf.Network) -> None:
    """Refuse springs that the programs are not told how to model: cords only, slack if short."""
    cords = (network.sense == 1) & (network.rest_length > 0) & (network.force == 0)
    if not cords.all():
        raise ValueError(f"spring {np.flatnonzero(~cords)[0]} is no tension-only elastic cord")
