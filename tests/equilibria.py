"""What tests of nets share: solves whose reactions are checked, chains, grids, observed orders."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

import springform as sf

UP = np.array([0.0, 0.0, 1.0])


def solved(network: sf.Network, *, least: float = 0.0, **arguments: Any) -> sf.Equilibrium:
    """The equilibrium, whose reactions balance the loads as forces and as moments.

    `least` [N] is what forces are measured by where springs carry next to none.
    """
    result = sf.solve(network, **arguments)
    assert result.converged, result.reason
    outer = result.loads + result.reactions
    scale = max(np.abs(result.forces).max(), np.abs(result.loads).max(), least)
    allowed = 1e-9 * scale * len(outer)
    assert np.abs(outer.sum(axis=0)).max() <= allowed
    reach = np.abs(result.positions).max()
    moment = np.cross(result.positions, outer).sum(axis=0)
    assert np.abs(moment).max() <= allowed * reach
    return result


def chain(
    start: np.ndarray, end: np.ndarray, count: int, *, sag: float = 0.0, **arguments: Any
) -> sf.Network:
    """Springs one after the other between two fixed points, drawn as a line or a parabola."""
    share = np.linspace(0, 1, count + 1)[:, None]
    positions = start + share * (end - start) - 4 * sag * share * (1 - share) * UP
    return sf.Network(positions, list(pairwise(range(count + 1))), [0, count], **arguments)


def tube(along: int, around: int) -> tuple[np.ndarray, np.ndarray]:
    """Springs along the lines and around the rings of a tube of nodes numbered ring by ring."""
    number = np.arange((along + 1) * around).reshape(along + 1, around)
    lines = np.column_stack([number[:-1].ravel(), number[1:].ravel()])
    rings = np.column_stack([number.ravel(), np.roll(number, -1, axis=1).ravel()])
    return lines, rings


def assert_order(
    errors: Sequence[float], record_property: Any, name: str, order: float = 2.0
) -> None:
    """Print the observed orders of errors at ever twice as many pieces; all but the first fit."""
    found = np.log2(np.divide(errors[:-1], errors[1:]))
    record_property(f"{name} errors", str(list(errors)))
    record_property(f"{name} order", str(list(found)))
    print(f"{name}: errors {np.array(errors)}, observed orders {found}")
    assert np.abs(found[1:] - order).max() < 0.1, found
