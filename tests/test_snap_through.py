"""Shallow trusses and arches under a load at the crown hold below the snap load, and not above."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import brentq

import springform as sf
from equilibria import solved

AXIAL = 1e3


def truss(height: float, load: float) -> sf.Network:
    """Two bars between (-1, 0, 0), (1, 0, 0) and a loaded crown, unstressed as drawn."""
    return sf.Network(
        [[-1, 0, 0], [1, 0, 0], [0, 0, height]], [(0, 2), (1, 2)], [0, 1], axial_stiffness=AXIAL,
        rest_length=np.hypot(1, height), sense="both",
        loads=[[0, 0, 0], [0, 0, 0], [0, 0, -load]], fixed_axes=[(2, "y")],
    )  # fmt: skip


@pytest.mark.parametrize("height", [0.02, 0.1, 0.3, 0.8])
@pytest.mark.parametrize("share", [0.1, 0.9, 0.999, 0.9999, 1.0001, 1.001, 1.1, 10.0])
def test_a_shallow_truss_snaps_at_its_limit_load(height: float, share: float) -> None:
    """Mises, "Über die Stabilitätsprobleme der Elastizitätstheorie", 1923.

    A crown at z carries P = 2 EA z (1/L - 1/L0), most where the bars are L = L0^(1/3) long.
    """
    rest = np.hypot(1, height)

    def carried(z: float) -> float:
        return float(2 * AXIAL * z * (1 / np.hypot(1, z) - 1 / rest))

    crest = float(np.sqrt(rest ** (2 / 3) - 1))
    load = share * carried(crest)
    reach = (crest, height) if share < 1 else (-50 * height - 5, -height)
    crown = brentq(lambda z: carried(z) - load, *reach, xtol=1e-15)
    result = solved(truss(height, load))
    # Near its limit the truss has little stiffness left, and rests as exactly as that allows.
    np.testing.assert_allclose(result.positions[2], [0, 0, crown], atol=1e-6 * height)


def arch(count: int, rise: float, load: float, axial: float) -> sf.Network:
    """A rod of length 1 and EI = 1 buckled up to a rise between pins, loaded at its middle."""
    span = 1 - np.pi**2 * rise**2 / 4
    share = np.linspace(0, 1, count + 1)
    positions = np.column_stack([span * share, 0 * share, rise * np.sin(np.pi * share)])
    loads = np.zeros((count + 1, 3))
    loads[count // 2, 2] = -load
    return sf.Network(
        positions, list(pairwise(range(count + 1))), [0, count], axial_stiffness=axial,
        rest_length=1 / count, loads=loads,
        rods=[sf.Rod(range(count + 1), 1.0, lengths=[1 / count] * count)],
        fixed_axes=[(node, "y") for node in range(count + 1)],
    )  # fmt: skip


def snap_load(rise: float, axial: float) -> float:
    """Load at which a shallow buckled rod of length 1 and EI = 1 goes over, by its second mode.

    Camescasse, Fernandes & Pouget, "Bistable buckled beam: elastica modeling and analysis of
    static actuation", 2013: it does when the thrust reaches 4 π². The half of w'' + k² w = F x/2
    with k = 2 π then slopes by F (1 + cos k x)/2 k², which shortens the rod by 3 F²/16 k⁴; without
    load it was shortened by π² rise²/4, less what the thrust takes along the axis.
    """
    thrust = 4 * np.pi**2
    shortened = np.pi**2 * rise**2 / 4 - thrust / axial
    return float(4 * thrust * np.sqrt(shortened / 3))


@pytest.mark.parametrize(("count", "axial"), [(32, 1e6), (64, 1e6), (64, 1e8), (128, 1e8)])
@pytest.mark.parametrize("rise", [0.1, 0.05, 0.025])
def test_a_shallow_arch_snaps_at_its_limit_load(count: int, axial: float, rise: float) -> None:
    published = snap_load(rise, axial)
    # Both pieces and shallowness of the closed form are good to the second order.
    inexact = 1.5 * rise**2 + 6 / count**2
    low, high = 0.9, 1.1
    while high - low > 2e-4:
        share = 0.5 * (low + high)
        network = arch(count, rise, share * published, axial)
        heights = solved(network).positions[:, 2]
        if heights[count // 2] > 0:
            low = share
            np.testing.assert_allclose(heights, heights[::-1], atol=1e-3 * rise)
        else:
            high = share
    assert abs(low - 1) < inexact


def test_a_shallow_arch_does_not_creep_off_its_saddle() -> None:
    """Just above the snap load, and far above it in a stiff rod, a damped step goes no distance."""
    most = 0
    for count, rise, axial, share in [
        (16, 0.1, 1e5, 1.015), (16, 0.2, 1e6, 1.03), (16, 0.2, 1e8, 1.4), (32, 0.1, 1e8, 1.3),
        (32, 0.2, 1e8, 1.5), (64, 0.1, 1e5, 1.02), (64, 0.1, 1e6, 1.02), (64, 0.2, 1e6, 1.07),
    ]:  # fmt: skip
        network = arch(count, rise, share * snap_load(rise, axial), axial)
        result = solved(network)
        assert result.positions[count // 2, 2] < 0
        most = max(most, result.iterations)
    assert most < 150
