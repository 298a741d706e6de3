"""Sensitivity: derivatives of an equilibrium by the adjoint of its tangent stiffness."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from .arrays import Floats, numbers
from .errors import InputError
from .network import Equilibrium, Network


@dataclass(frozen=True)
class Gradient:
    """Gradient of a scalar J of positions and spring forces: n nodes, m springs; J in [J]."""

    stiffness: Floats
    """(m,) dJ/dk [J per N/m] at constant rest lengths; `gradient.stiffness / rest_length` is that
    by EA, dJ/dEA [J per N]."""
    rest_length: Floats
    """(m,) dJ/dr [J per m] at constant k; at constant EA = k r it is `gradient.rest_length -
    gradient.stiffness * stiffness / rest_length`."""
    force: Floats
    """(m,) dJ/dT [J per N], T the constant force."""
    loads: Floats
    """(n, 3) [J per N], by dead loads; zero where a node is held."""
    supports: Floats
    """(n, 3) [J per m], by the positions of held nodes; zero along the ways that are free."""


@dataclass(frozen=True)
class Response:
    """First-order change of an equilibrium: n nodes, m springs."""

    positions: Floats
    """(n, 3) [m]."""
    forces: Floats
    """(m,) [N]."""


class Sensitivity:
    """The factored tangent stiffness of a network at its equilibrium; see `sensitivity`."""

    def __init__(self, network: Network, equilibrium: Equilibrium) -> None:
        if equilibrium.positions.shape != network.positions.shape:
            raise InputError("is the result of another network", key="equilibrium")
        if not equilibrium.converged:
            raise InputError(
                f"has no derivatives, as it did not converge: {equilibrium.reason}",
                key="equilibrium",
            )
        self._nodes, self._springs = len(network.positions), len(network.springs)
        try:
            self._core = _core.Sensitivity(network, np.ascontiguousarray(equilibrium.positions))
        except _core.CoreError as error:
            key, problem = error.args
            raise InputError(problem, key=key) from None

    def gradient(
        self, *, positions: ArrayLike | None = None, forces: ArrayLike | None = None
    ) -> Gradient:
        """Return the gradient of a scalar J(x, F) by every parameter, for one solve.

        `positions` are dJ/dx at the equilibrium, (n, 3) [J per m], `forces` dJ/dF, (m,) [J per N];
        either is zero unless given. Raises `InputError`: another shape.
        """
        return Gradient(
            **self._core.gradient(
                self._of_nodes("positions", positions), self._of_springs("forces", forces)
            )
        )

    def response(
        self,
        *,
        stiffness: ArrayLike | None = None,
        rest_length: ArrayLike | None = None,
        force: ArrayLike | None = None,
        loads: ArrayLike | None = None,
        supports: ArrayLike | None = None,
    ) -> Response:
        """Return how positions and forces change with small changes of parameters, for one solve.

        `stiffness` (m,) [N/m] at constant rest lengths, `rest_length` (m,) [m] at constant
        stiffness, `force` (m,) [N], `loads` (n, 3) [N], `supports` (n, 3) [m], of which the part
        along free ways means nothing. Raises `InputError`: another shape.
        """
        return Response(
            **self._core.response(
                self._of_springs("stiffness", stiffness),
                self._of_springs("rest_length", rest_length),
                self._of_springs("force", force),
                self._of_nodes("loads", loads),
                self._of_nodes("supports", supports),
            )
        )

    def _of_nodes(self, name: str, values: ArrayLike | None) -> Floats:
        return numbers(name, 0.0 if values is None else values, (self._nodes, 3))

    def _of_springs(self, name: str, values: ArrayLike | None) -> Floats:
        return numbers(name, 0.0 if values is None else values, (self._springs,))


def sensitivity(network: Network, equilibrium: Equilibrium) -> Sensitivity:
    """Factor the tangent stiffness of a network at its equilibrium, for derivatives.

    Holds for springs of every law, rods, supports along single axes and nodes that slide; a spring
    that is slack stays so. Loads that follow the shape (pressure, weight by length) are refused.
    Raises `InputError`: such a load, an equilibrium that did not converge or is not stable, or a
    node that nothing holds along some way, as slack springs leave it.
    """
    return Sensitivity(network, equilibrium)
