"""Random rigged designs, evolved: a run or one clear error, no number lost, the same bits."""

from __future__ import annotations

import math
import random
import time
from collections import Counter
from typing import Any

import numpy as np
import pytest

import springform as sf
from springform import design_file

BATCHES = 6
DESIGNS = 40
"""Designs a batch."""

SLOWEST = 20.0
"""Seconds that no run of a dozen small nets may take, on whatever machine."""

Data = dict[str, Any]

MEASURES = ("springs", "force_min", "force_max", "force_mean", "total_length", "residual")


def chance(draw: random.Random, share: float) -> bool:
    return draw.random() < share


def magnitude(draw: random.Random, least: float, most: float) -> float:
    return float(10 ** draw.uniform(math.log10(least), math.log10(most)))


def anchor(draw: random.Random, ring: str, index: int, around: int, height: float) -> Data:
    """An anchor on a circle, which may be free along some axes or slide."""
    turn, radius = 2 * math.pi * index / around, draw.uniform(0.8, 2.5)
    position = [radius * math.cos(turn), radius * math.sin(turn), height + draw.gauss(0, 0.2)]
    found: Data = {"ring": ring, "index": index, "position": position}
    way = [draw.gauss(0, 1) for _ in range(3)]
    kind = draw.choice(["held"] * 6 + ["holds", "line", "plane"])
    if kind == "holds":
        found["holds"] = draw.choice(["x", "z", "xy", "yz"])
    elif kind != "held":
        found[kind] = way
    return found


def curve(draw: random.Random, stiffness: float) -> list[list[float]]:
    """Test points of a cord that stiffens or softens, now and then with a part that pushes."""
    strain, force, points = 0.0, 0.0, [[0.0, 0.0]]
    for _ in range(draw.randint(1, 4)):
        step = draw.uniform(0.02, 0.3)
        strain, force = strain + step, force + stiffness * step * draw.uniform(0.1, 2)
        points.append([strain, force])
    return [[-0.1, -0.05 * stiffness], *points] if chance(draw, 0.3) else points


def group(draw: random.Random, stiffness: float) -> Data:
    """Springs chosen by level, boundary or not at all, under a law and sense of their own."""
    found: Data = draw.choice(
        [{}, {}, {"levels": [draw.randint(0, 2)]}, {"along": ["ring"]}, {"types": [1]}]
    ) | {"axial_stiffness": stiffness * magnitude(draw, 0.1, 10)}
    law = draw.choice(["axial", "axial", "axial", "curve", "density", "force"])
    if law != "axial":
        del found["axial_stiffness"]
    if law == "curve":
        found["curve"] = curve(draw, stiffness)
    elif law == "density":
        found["force_density"] = stiffness
    elif law == "force":
        found["force"] = draw.uniform(0.1, 1) * stiffness
    if law in ("axial", "curve"):
        # Above 1 the cords hang slack, as most of some nets do.
        found["rest_ratio"] = draw.choice([0.6, 0.9, 1.0, 1.3, [1.2, 0.7], [0.8, 1.5, 0.5]])
    found["sense"] = draw.choice(["tension", "tension", "tension", "both", "compression"])
    if chance(draw, 0.2):
        found["self_weight"] = stiffness * magnitude(draw, 1e-3, 0.3)
    if chance(draw, 0.1):
        found |= {"thermal_expansion": 1e-3, "temperature": draw.uniform(-60, 60)}
    return found


def rigged(draw: random.Random) -> Data:
    """A cylinder of few cells with groups of springs, rods, loads and supports of all kinds."""
    around, along = draw.randint(3, 8), draw.randint(2, 4)
    rings = [
        (ring, index, height)
        for height, ring in enumerate(("tube.start", "tube.end"))
        for index in sorted(draw.sample(range(around), draw.randint(2, min(around, 5))))
    ]
    stiffness = magnitude(draw, 0.1, 1e4)
    pressure = stiffness * magnitude(draw, 1e-3, 1)
    loads: Data = {"nodes": [], "pressures": []}
    taken = {(ring, index) for ring, index, _ in rings}
    free = [place for place in ((r, i) for r in ("tube.start", "tube.end") for i in range(around))
            if place not in taken]  # fmt: skip
    for ring, index in draw.sample(free, min(len(free), draw.randint(0, 2))):
        force = [draw.gauss(0, 0.3 * stiffness) for _ in range(3)]
        loads["nodes"].append({"ring": ring, "index": index, "force": force})
    if chance(draw, 0.4):
        follower = {"pressure": draw.choice([1, -1]) * pressure, "follower": chance(draw, 0.7)}
        loads["pressures"].append(follower)
    rods = [
        {
            "along": ring,
            "bending_stiffness": stiffness * magnitude(draw, 1e-3, 1),
            "axial_stiffness": stiffness * magnitude(draw, 10, 1e7),
        }
        | draw.choice([{}, {"length": draw.uniform(4, 14)}])
        for ring in draw.choice([[], ["tube.start"], ["tube.end"], ["tube.start", "tube.end"]])
    ]
    method = draw.choice(["dynamic", "dynamic", "recursive", "extensible"])
    inner = {"dynamic": "6", "recursive": "1", "extensible": "3@1"}[method]
    notation = draw.choice(["{0}", "1(1 {0} 1 1)", "1(1 1 1(1 1 {0} 1) 1)"])
    return {
        "springform": 1,
        "name": "rigged",
        "method": method,
        "framework": {
            "grid": draw.choice(["quad", "dia"]),
            "cylinders": [{"name": "tube", "around": around, "along": along}],
            "anchors": [anchor(draw, ring, index, around, float(2 * height))
                        for ring, index, height in rings],
        },
        "forest": {"type": 1, "cells": {str(draw.randrange(around)): notation.format(inner)}},
        "springs": {"groups": [group(draw, stiffness) for _ in range(draw.randint(1, 3))]},
        "rods": rods,
        "loads": loads,
    }  # fmt: skip


def check(run: sf.Run) -> Counter[str]:
    """What holds of the individuals of every run, solved or not."""
    table = run.table
    valid = table["valid"].astype(bool)
    for name in MEASURES:
        assert np.isfinite(table[name][valid].astype(float)).all(), name
    assert (table["residual"][valid] <= 1e-9).all()
    for name in ("force_differential", "suf", "force_max"):
        assert np.isnan(table[name][~valid].astype(float)).all(), name
    # An individual without equilibrium is no parent, not even where there is no other.
    for generation, parent in enumerate(run.parents, start=1):
        row = (table["generation"] == generation) & (table["individual"] == parent)
        assert parent is None or valid[row].all()
    return Counter(valid=int(valid.sum()), invalid=int((~valid).sum()))


@pytest.mark.parametrize("batch", range(BATCHES))
def test_rigged_designs_evolve_or_say_why(batch: int) -> None:
    ends: Counter[str] = Counter()
    for number in range(DESIGNS):
        draw = random.Random(f"evolve {batch} {number}")
        data = rigged(draw)
        parameters: Data = {
            "population": 4, "generations": 3, "seed": number,
            "fitness": draw.choice(["suf", "differential"]),
        }  # fmt: skip
        began = time.monotonic()
        try:
            design = sf.Design(design_file.from_data(data))
            runs = [sf.evolve(design, threads=threads, **parameters) for threads in (1, 2)]
        except sf.SpringformError as error:
            ends["refused" if str(error).isprintable() else "refused in a mess"] += 1
            continue
        except BaseException as error:
            # A panic of the core is no Exception.
            raise AssertionError(f"batch {batch}, design {number}:\n{data}") from error
        assert time.monotonic() - began < SLOWEST, f"batch {batch}, design {number}:\n{data}"
        ends["evolved"] += 1
        ends += check(runs[0])
        assert runs[0].digest() == runs[1].digest()
        for name, column in runs[0].table.items():
            np.testing.assert_array_equal(column, runs[1].table[name], err_msg=name)
    assert ends["refused in a mess"] == 0
    assert ends["evolved"] > 0.3 * DESIGNS, ends
    assert ends["valid"] > ends["invalid"] > 0, ends
