"""Readings: what one spring does at equilibrium, as numbers with unit and formula, for people."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .errors import InputError
from .network import Equilibrium, Network
from .spring_laws import LAWS

VANISHING = 1e-12
"""A spring below this share of the largest force counts as slack."""


@dataclass(frozen=True)
class Reading:
    """One number about a spring."""

    name: str
    """Such as "force"."""
    value: float
    """In `unit`; NaN where the spring has none."""
    unit: str
    """Empty for a pure number."""
    formula: str
    """How it comes about, such as "F = EA (L − L0)/L0, EA of the unstressed length L0"."""

    @property
    def text(self) -> str:
        """The number with its unit, such as "2.41 N"."""
        if math.isnan(self.value):
            return "none"
        return f"{self.value:.6g} {self.unit}".rstrip()


def read_spring(network: Network, equilibrium: Equilibrium, spring: int) -> list[Reading]:
    """Return force, strain, stress, lengths, energy and law of a spring, ready to be shown.

    Raises `InputError`: no such spring, or an equilibrium of another network.
    """
    count = len(network.springs)
    if len(equilibrium.forces) != count:
        raise InputError("is that of another network", key="equilibrium")
    if not 0 <= spring < count:
        raise InputError(f"there is no spring {spring}; there are {count}, from 0", key="spring")
    law = LAWS[network.law[spring]]
    rest, rate = float(network.rest_length[spring]), float(network.stiffness[spring])
    sense = {1: "pulls only", 0: "pulls and pushes", -1: "pushes only"}[int(network.sense[spring])]
    elastic = rest > 0
    if law == "stiffness":
        formula = "F = k (L − L0)" if elastic else "F = k L"
        constant = Reading("stiffness", rate, "N/m", "k")
    elif law == "axial_stiffness":
        formula = "F = EA (L − L0)/L0, EA of the unstressed length L0"
        constant = Reading("axial stiffness", rate * rest, "N", "EA, of the unstressed length L0")
    elif law == "force_density":
        formula, constant = "F = q L", Reading("force density", rate, "N/m", "q")
    elif law == "force":
        formula = "F = T, whatever the length"
        constant = Reading("constant force", float(network.force[spring]), "N", "T")
    else:
        formula = "F = g((L − L0)/L0), g the measured curve"
        constant = Reading(
            "axial stiffness",
            rate * rest,
            "N",
            "EA of the unstressed length, at the last test point",
        )
    return [
        Reading("force", float(equilibrium.forces[spring]), "N", f"{formula}; {sense}"),
        constant,
        Reading("length", float(equilibrium.lengths[spring]), "m", "L, at equilibrium"),
        Reading(
            "unstressed length",
            rest if elastic else math.nan,
            "m",
            "L0, at the spring's temperature" if elastic else "this law has none",
        ),
        Reading("strain", float(equilibrium.strains[spring]), "", "ε = (L − L0)/L0"),
        Reading(
            "stress", float(equilibrium.stresses[spring]), "Pa", "σ = F/A, A the cross-section"
        ),
        Reading(
            "energy",
            float(equilibrium.spring_energies[spring]),
            "J",
            "E = F L" if law == "force" else "E = ∫ F dL",
        ),
    ]


def slack(equilibrium: Equilibrium, springs: slice = slice(None)) -> NDArray[np.bool_]:
    """Return which springs carry next to nothing."""
    forces = np.abs(equilibrium.forces)
    loose: NDArray[np.bool_] = forces[springs] <= VANISHING * forces.max(initial=0.0)
    return loose
