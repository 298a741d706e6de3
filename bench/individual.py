"""Time of one individual: mutation, filters, equilibrium and measures of a net of 2,000 springs."""

from __future__ import annotations

import os
import time

import springform as sf
from springform import _core

SPRINGS = 2000
POPULATION = 500


def main() -> None:
    """Grow the three cylinders to the size of the paper's runs, then time a generation."""
    design = sf.load("three-cylinders")
    forest = _grown(design)
    for threads in sorted({1, os.cpu_count() or 1}):
        evolution = _evolution(design, forest, population=POPULATION, insertions=3, threads=threads)
        began = time.perf_counter()
        evolution.advance()
        seconds = time.perf_counter() - began
        words = "1 thread" if threads == 1 else f"{threads} threads"
        print(
            f"{evolution.measures['springs']} springs, {words}: {POPULATION / seconds:.0f} "
            f"individuals/s, {1000 * seconds / POPULATION:.2f} ms each"
        )


def _grown(design: sf.Design) -> _core.Forest:
    evolution = _evolution(design, design.forest, population=20, insertions=20, threads=1)
    while evolution.measures["springs"] < SPRINGS:
        evolution.advance()
    return evolution.forest


def _evolution(
    design: sf.Design, forest: _core.Forest, *, population: int, insertions: int, threads: int
) -> _core.Evolution:
    return _core.Evolution(
        design.setting,
        forest,
        population=population,
        seed=1,
        types=["1", "6"],
        strategy=((False, insertions), (False, 3), (False, 1), "exponential"),
        base=4.0,
        exponent=1.0,
        self_adapt=False,
        fitness="differential",
        suf_reference="start",
        niche=None,
        min_length=None,
        selection="comma",
        threads=threads,
    )


if __name__ == "__main__":
    main()
