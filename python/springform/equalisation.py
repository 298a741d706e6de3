"""Equalising: stiffness tuned within bounds so that the forces of a given topology even out."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from . import _core
from .arrays import Floats
from .design import Design
from .errors import InputError
from .network import TOLERANCE, Equilibrium, Network, solve

BOUNDS = (0.25, 4.0)
"""Smallest and largest factor on the stiffness unless others are given."""

ITERATIONS = 5000
"""Most steps unless another number is given; nets of 2,000 springs take some 500."""


@dataclass(frozen=True)
class EqualiseStep:
    """One step, as told to `on_step`."""

    iterations: int
    """Steps made, from 1."""
    springs: int
    """Number of springs."""
    force_differential: float
    """Largest over smallest force where the steps are now."""


@dataclass(frozen=True)
class Equalised:
    """A net with tuned stiffness: m springs, links of rods among them."""

    factors: Floats
    """(m,): stiffness over stiffness before; 1 for the links of rods."""
    cords: NDArray[np.intp]
    """(c,): springs that are tuned and counted, all but the links of rods."""
    design: Design | None
    """The design with these factors in its file, if it was a design; solving it gives `after`."""
    network: Network
    """The network with these factors on its stiffness."""
    equilibrium: Equilibrium
    """Its equilibrium."""
    before: float
    """Force differential before: largest over smallest force of the cords."""
    after: float
    """Force differential now; never above that before."""
    iterations: int
    """Steps made."""
    converged: bool
    """Further steps would bring next to nothing."""
    seconds: float = field(compare=False)
    """Time taken [s]."""


def equalise(
    subject: Design | Network,
    *,
    bounds: tuple[float, float] = BOUNDS,
    values: Sequence[float] | None = None,
    iterations: int = ITERATIONS,
    on_step: Callable[[EqualiseStep], None] | None = None,
) -> Equalised:
    """Tune the stiffness of every spring of a design or network so that forces even out.

    `bounds` are the smallest and the largest factor on a spring's stiffness; `values` are the only
    factors allowed instead: (1, 2, 4) for cords laid single, doubled and fourfold. In both, 1
    stands for the stiffness as it is. Links of rods are no cords: they stay, and don't count.
    Topology, anchors, rest lengths and loads stay. The result is the same on every run. Raises
    `InputError`: factors that are not allowed; a net without an equilibrium, with a cord that does
    not pull, or with loads that follow the shape.
    """
    if iterations < 0:
        raise InputError(f"must be at least 0, not {iterations}", key="iterations")
    if values is not None and len(values) == 0:
        raise InputError("must be two different factors or more", key="values")
    began = time.perf_counter()
    network = subject.network() if isinstance(subject, Design) else subject
    cords = _cords(subject)
    if not len(cords):
        raise InputError("has no springs but the links of rods; add cords", key="network")
    low, high = map(float, bounds)
    allowed = [] if values is None else [float(value) for value in values]
    try:
        core = _core.Equalisation(network, cords.tolist(), [low, high], allowed, TOLERANCE)
    except _core.CoreError as error:
        key, problem = error.args
        raise InputError(problem, key=key) from None
    advanced = True
    # A keyboard interrupt comes through between two steps.
    while core.iterations < iterations and (advanced := core.advance()):
        if on_step is not None:
            on_step(EqualiseStep(core.iterations, len(cords), core.differential_now))
    factors = core.factors
    factors.setflags(write=False)
    tuned = network.stiffened(factors)
    return Equalised(
        factors,
        cords,
        subject.with_stiffness_factors(factors[cords]) if isinstance(subject, Design) else None,
        tuned,
        solve(tuned),
        core.before,
        core.differential,
        core.iterations,
        not advanced,
        time.perf_counter() - began,
    )


def _cords(subject: Design | Network) -> NDArray[np.intp]:
    """Return the springs that are no links of rods, (c,)."""
    if isinstance(subject, Design):
        return np.arange(subject.cords.stop)
    links = set()
    for rod in subject.rods:
        nodes = list(rod.nodes)
        following = nodes[1:] + (nodes[:1] if rod.closed else [])
        links |= {frozenset(pair) for pair in zip(nodes, following, strict=False)}
    pairs = map(frozenset, subject.springs.tolist())
    return np.flatnonzero([pair not in links for pair in pairs])
