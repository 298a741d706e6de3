"""CalculiX: every cord is a SPRINGA element with a table of force against elongation.

CalculiX (Dhondt and Wittig, calculix.de) is a program of its own, `ccx`: a deck of keywords goes
in, a listing with seven digits comes out. Its truss elements with prestrain do not converge on
nets; springs do, with the very law of our cords.
"""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

import numpy as np
from engine import Answer, NotValidatedError, lengths, require_cords

import springform as sf

BALANCE = 1e-6
"""Largest force out of balance over the largest force."""
TIME_LIMIT = 300
"""[s]."""
FAR = 100
"""Elongation over length at the end of a table, beyond which CalculiX keeps the force constant:
Newton's first steps go far."""
_HEADING = re.compile(r"^ (displacements|forces) ")


def solve(network: sf.Network, folder: Path) -> Answer:
    """Find the equilibrium near the network's positions; files go into a folder.

    A second run starts where the first one ended: its displacements are so small that the seven
    digits of the listing no longer matter. Raises `NotValidatedError`: no equilibrium found.
    """
    near, _ = _run(network, network.positions, folder / "near")
    positions, reactions = _run(network, near, folder / "exact")
    stretch = lengths(positions, network.springs) - network.rest_length
    forces = network.stiffness * np.maximum(stretch, 0.0)
    # Nodes without springs are none of CalculiX's: it would leave their loads out.
    loose = np.abs(np.where(network.fixed_axes, 0.0, reactions)).max()
    if loose > BALANCE * max(np.abs(reactions).max(), forces.max()):
        raise NotValidatedError(f"CalculiX left {loose:.3g} N out of balance")
    return Answer(positions, forces, np.where(network.fixed_axes, reactions, 0.0))


def deck(network: sf.Network, start: np.ndarray) -> str:
    """The input of CalculiX for a network, nodes and springs numbered from 1."""
    require_cords(network)
    lines = ["*NODE,NSET=NALL", *(f"{i},{_numbers(at)}" for i, at in enumerate(start, 1))]
    drawn = lengths(start, network.springs)
    springs = zip(
        network.springs + 1, drawn, drawn - network.rest_length, network.stiffness, strict=True
    )
    for number, ((first, second), length, stretch, stiffness) in enumerate(springs, 1):
        # Pairs of force and elongation from the start: slack below the unstressed length.
        table = (0.0, -stretch - length), (0.0, -stretch)
        end = (stiffness * (stretch + FAR * length), FAR * length)
        lines += [
            f"*ELEMENT,TYPE=SPRINGA,ELSET=E{number}",
            f"{number},{first},{second}",
            f"*SPRING,ELSET=E{number},NONLINEAR",
            # The empty line takes the place of degrees of freedom, which SPRINGA has none of.
            "",
            *(_numbers(pair) for pair in (*table, end)),
        ]
    if network.fixed.all():
        lines += _loose_spring(len(start), len(network.springs))
    held = np.argwhere(network.fixed_axes) + 1
    lines += ["*BOUNDARY", *(f"{node},{axis},{axis}" for node, axis in held)]
    lines += [
        "*STEP,NLGEOM,INC=1000",
        # The residual that CalculiX is content with by default leaves errors of 0.02 mm.
        "*CONTROLS,PARAMETERS=FIELD",
        "1E-6,1E-6,,,1E-6",
        "*STATIC,SOLVER=SPOOLES",
        "1.0,1.0",
    ]
    loads = np.argwhere(network.loads)
    if loads.size:
        lines += ["*CLOAD"]
        lines += [f"{n + 1},{axis + 1},{_number(network.loads[n, axis])}" for n, axis in loads]
    lines += ["*NODE PRINT,NSET=NALL", "U,RF", "*END STEP", ""]
    return "\n".join(lines)


def read(listing: str, nodes: int) -> dict[str, np.ndarray]:
    """Displacements and forces at nodes of the last increment, each (n, 3)."""
    found: dict[str, np.ndarray] = {}
    table: np.ndarray | None = None
    for line in listing.splitlines():
        if heading := _HEADING.match(line):
            table = found[heading[1]] = np.full((nodes, 3), np.nan)
        elif table is not None and line.strip():
            number, *values = line.split()
            table[int(number) - 1] = [float(value) for value in values]
    return found


def _run(network: sf.Network, start: np.ndarray, folder: Path) -> tuple[np.ndarray, np.ndarray]:
    folder.mkdir(parents=True)
    (folder / "net.inp").write_text(deck(network, start))
    try:
        done = subprocess.run(
            ["ccx", "-i", "net"], cwd=folder, capture_output=True, text=True, check=False,
            timeout=TIME_LIMIT, env=os.environ | {"OMP_NUM_THREADS": "1"},
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        raise NotValidatedError(f"CalculiX ran for more than {TIME_LIMIT} s") from None
    if done.returncode != 0 or "Job finished" not in done.stdout:
        said = [line.strip() for line in done.stdout.splitlines() if "*ERROR" in line]
        reason = said[-1] if said else f"exit code {done.returncode}"
        raise NotValidatedError(f"CalculiX found no equilibrium: {reason}")
    count = len(start)
    found = read((folder / "net.dat").read_text(), count)
    displacements, forces = found["displacements"], found["forces"]
    if not (np.isfinite(displacements).all() and np.isfinite(forces).all()):
        raise NotValidatedError("CalculiX left nodes without an answer")
    # What it prints is the force of the springs, loads at supports not taken off.
    return start + displacements, forces - network.loads


def _loose_spring(nodes: int, springs: int) -> list[str]:
    """Two nodes and a spring beside the net: CalculiX refuses to run without any equation."""
    return [
        "*NODE",
        f"{nodes + 1},0.,0.,0.",
        f"{nodes + 2},1.,0.,0.",
        f"*ELEMENT,TYPE=SPRING2,ELSET=E{springs + 1}",
        f"{springs + 1},{nodes + 1},{nodes + 2}",
        f"*SPRING,ELSET=E{springs + 1}",
        "1,1",
        "1.",
        "*BOUNDARY",
        f"{nodes + 1},1,3",
        f"{nodes + 2},2,3",
    ]


def _number(value: float) -> str:
    # CalculiX reads 20 characters of a number.
    return f"{value:.12e}"


def _numbers(values: tuple[float, ...] | np.ndarray) -> str:
    return ",".join(_number(value) for value in values)
