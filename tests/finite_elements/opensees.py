"""OpenSees: every cord is a corotational truss whose initial strain carries its unstressed length.

OpenSees (McKenna, "OpenSees: a framework for earthquake engineering simulation", 2011) is called
through OpenSeesPy, whose licence keeps it out of springFORM's dependencies: whoever has it
installed gets these checks as well.
"""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from engine import Answer, NotValidatedError, lengths, require_cords

import springform as sf

SLACK = 1e-9
"""Share of its stiffness that a slack cord keeps, as OpenSees wants some."""
ROUND_OFF = 1e-11
"""Residual over the axial stiffness at which a net counts as solved."""
ITERATIONS = 60


def is_there() -> bool:
    """Whether OpenSeesPy is installed."""
    return find_spec("openseespy") is not None


def solve(network: sf.Network, _: Path) -> Answer:
    """Find the equilibrium near the network's positions; needs no files.

    Raises `NotValidatedError`: no equilibrium found.
    """
    import openseespy.opensees as ops

    require_cords(network)
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 3)
    for node, (at, held) in enumerate(zip(network.positions, network.fixed_axes, strict=True)):
        ops.node(node, *map(float, at))
        ops.fix(node, *map(int, held))
    drawn = lengths(network.positions, network.springs)
    for spring, (first, second) in enumerate(network.springs.tolist()):
        # OpenSees strains its elements from the drawn length; this makes it k (L - r).
        modulus = float(network.stiffness[spring] * drawn[spring])
        strain = float(1 - network.rest_length[spring] / drawn[spring])
        ops.uniaxialMaterial("Elastic", 2 * spring, modulus, 0.0, SLACK * modulus)
        ops.uniaxialMaterial("InitStrainMaterial", 2 * spring + 1, 2 * spring, strain)
        ops.element("CorotTruss", spring, first, second, 1.0, 2 * spring + 1)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    for node in np.flatnonzero(network.loads.any(axis=1)).tolist():
        ops.load(node, *map(float, network.loads[node]))
    code = _analyze(ops, network)
    if code != 0:
        raise NotValidatedError(f"OpenSees found no equilibrium: code {code}")
    ops.reactions()
    nodes, springs = range(len(network.positions)), range(len(network.springs))
    moved = np.array([ops.nodeDisp(node) for node in nodes])
    reactions = np.array([ops.nodeReaction(node) for node in nodes])
    forces = np.array([ops.eleResponse(spring, "axialForce")[0] for spring in springs])
    ops.wipe()
    if not np.isfinite(moved).all():
        raise NotValidatedError("OpenSees left nodes without an answer")
    return Answer(network.positions + moved, forces, np.where(network.fixed_axes, reactions, 0.0))


def _analyze(ops: Any, network: sf.Network) -> int:
    if network.fixed.all():
        return 0  # There is nothing to solve, and OpenSees refuses a system without equations.
    axial_stiffness = float((network.stiffness * network.rest_length).mean())
    ops.constraints("Plain")
    ops.numberer("RCM")
    ops.system("UmfPack")
    # The residual allowed is a force; round-off grows with the axial stiffness.
    ops.test("NormUnbalance", ROUND_OFF * axial_stiffness, ITERATIONS)
    ops.algorithm("Newton")
    ops.integrator("LoadControl", 1.0)
    ops.analysis("Static")
    return int(ops.analyze(1))
