"""Nets to check by finite elements: their form, the forces claimed in it, and loads."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from engine import lengths

import springform as sf

HYPAR = Path(__file__).parents[1] / "benchmarks" / "hypar20_selfweight_wind.json"
HYPAR_WEIGHT = 4.0
"""Weight of the hypar's cords [N/m], unstressed; the file's other loads are 500 Pa of wind."""

CORD_DIAMETER = 2.5e-3
CORD_MODULUS = 2e6
"""[Pa]: natural rubber has 1.5 to 2.5 MPa (Ashby, "Materials Selection in Mechanical Design", 2011,
appendix A), here over the whole section. A plausible cord, not a measured one: the paper's Fig. 5
measures a cord of polyester and elastane, but we have no numbers of it."""
CORD_DENSITY = 1000.0
"""[kg/m3]: rubber and polyester with the air in the braid."""
CORD_STRAIN = 0.5
"""Strain of the cord that carries most; such elastic cords stretch to about twice their length."""
GRAVITY = 9.81

AIR_DENSITY = 1.25
DRAG = 1.2
"""Drag coefficient of a long round cylinder across the wind below the critical Reynolds number."""
WIND = np.array([8.0, 3.0, 0.0])
"""[m/s]."""
STORM = 2 * WIND
"""Strong enough for some cords to go slack."""


@dataclass(frozen=True)
class FormFound:
    """A net of elastic cords in the form that it was designed in: n nodes, m springs."""

    network: sf.Network
    """Without loads; its positions are the form."""
    claimed: np.ndarray
    """(m,) [N]: forces that the design claims in that form."""
    loads: dict[str, np.ndarray]
    """Loads of the form by name, each (n, 3) [N]; they don't follow the moving net."""

    @property
    def span(self) -> float:
        """Largest extent along an axis [m]."""
        return float(np.ptp(self.network.positions, axis=0).max())

    def under(self, loads: str) -> sf.Network:
        """The network in its form, under some of its loads."""
        return _like(self.network, loads=self.loads[loads])

    def frozen(self, claimed: np.ndarray) -> sf.Network:
        """The network with all nodes held in its form and cords cut for the forces claimed."""
        net = self.network
        axial_stiffness = net.stiffness * net.rest_length
        cut = lengths(net.positions, net.springs) / (1 + claimed / axial_stiffness)
        return _like(net, fixed=np.ones(len(net.fixed), dtype=bool), rest_length=cut)


def hypar() -> FormFound:
    """The published hypar of 840 steel cords, at rest where springFORM finds it without loads."""
    case = json.loads(HYPAR.read_text())
    springs = np.array([[member["i"], member["j"]] for member in case["members"]])
    cord = {
        "axial_stiffness": [member["EA"] for member in case["members"]],
        "rest_length": [member["L0"] for member in case["members"]],
        "sense": "tension",
    }
    form = sf.solve(sf.Network(case["nodes"], springs, case["fixed"], **cord))
    assert form.converged, form.reason
    network = sf.Network(form.positions, springs, case["fixed"], **cord)
    loads = np.zeros(form.positions.shape)
    for node, *load in case["loads"]:
        loads[node] += load
    by_name = {"self-weight": lumped_weight(network, HYPAR_WEIGHT), "self-weight and wind": loads}
    return FormFound(network, form.forces, by_name)


def evolved() -> sf.Design:
    """The three-cylinder net after a few generations: uneven, two levels deep."""
    return sf.evolve(
        sf.load("three-cylinders"), seed=1, population=10, until_springs=1500, types=(1, 6)
    ).best


def cord_net(design: sf.Design) -> FormFound:
    """A design cut from one elastic cord: a factor on its forces gives newtons."""
    form = design.solve()
    assert form.converged, form.reason
    axial_stiffness = CORD_MODULUS * np.pi * CORD_DIAMETER**2 / 4
    forces = form.forces * (CORD_STRAIN * axial_stiffness / form.forces.max())
    drawn = design.network()
    network = sf.Network(
        form.positions, drawn.springs, drawn.fixed, axial_stiffness=axial_stiffness,
        rest_length=lengths(form.positions, drawn.springs) / (1 + forces / axial_stiffness),
        sense="tension",
    )  # fmt: skip
    weight = lumped_weight(network, CORD_DENSITY * GRAVITY * np.pi * CORD_DIAMETER**2 / 4)
    loads = {
        "self-weight": weight,
        "self-weight and wind": weight + wind_on_cords(network, WIND),
        "self-weight and storm": weight + wind_on_cords(network, STORM),
    }
    return FormFound(network, forces, loads)


def from_start(network: sf.Network, positions: np.ndarray) -> sf.Network:
    """The same cords and supports from another start; supports stay where they are."""
    return _like(network, positions=np.where(network.fixed[:, None], network.positions, positions))


def lumped_weight(network: sf.Network, weight: float) -> np.ndarray:
    """Weight of cords [N/m], by unstressed length, half to either end, (n, 3) [N]."""
    halves = np.zeros((len(network.springs), 3))
    halves[:, 2] = -weight * network.rest_length / 2
    return at_ends(network, halves)


def wind_on_cords(network: sf.Network, wind: np.ndarray) -> np.ndarray:
    """Drag of the wind [m/s] across every cord, half to either end, (n, 3) [N].

    Half the air's density times v |v|, drag coefficient, diameter and length, where v is what of
    the wind blows across the cord (the cross-flow principle; Hoerner, "Fluid-Dynamic Drag", 1965).
    """
    ends = network.positions[network.springs]
    along = ends[:, 1] - ends[:, 0]
    size = np.linalg.norm(along, axis=1, keepdims=True)
    across = wind - along * (along @ wind)[:, None] / size**2
    speed = np.linalg.norm(across, axis=1, keepdims=True)
    drag = AIR_DENSITY / 2 * DRAG * CORD_DIAMETER * size * speed * across
    return at_ends(network, drag / 2)


def at_ends(network: sf.Network, loads: np.ndarray) -> np.ndarray:
    """Sum of loads on springs, applied at both their ends, (n, 3) [N]."""
    total = np.zeros(network.positions.shape)
    np.add.at(total, network.springs[:, 0], loads)
    np.add.at(total, network.springs[:, 1], loads)
    return total


def _like(network: sf.Network, **changes: Any) -> sf.Network:
    same = {
        "positions": network.positions,
        "fixed": network.fixed,
        "axial_stiffness": network.stiffness * network.rest_length,
        "rest_length": network.rest_length,
        "sense": "tension",
    }
    return sf.Network(springs=network.springs, **(same | changes))
