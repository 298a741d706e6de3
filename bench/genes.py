"""Do genes help? Ten seeds evolve with and without a gene library distilled from another run.

The source has five times the population; the ten seeds make the same number of individuals each,
with and without. What counts is the lowest force differential among those of 2,000 springs or
more. Prints a line a seed and the medians.
"""

from __future__ import annotations

import statistics
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

import springform as sf

SEEDS = range(1, 11)
SPRINGS = 2000
SETTING: dict[str, Any] = {"population": 30, "generations": 90, "types": (1, 6), "insertions": 2}


def lowest(run: sf.Run) -> float:
    """Return the lowest differential at the number of springs that counts."""
    table = run.table
    dense = table["springs"] >= SPRINGS
    return float(np.nanmin(np.where(dense, table["force_differential"], np.inf)))


def main(scene: str) -> None:
    """Compare on one scene."""
    design = sf.load(scene)
    with tempfile.TemporaryDirectory() as folder:
        large = SETTING | {"population": 150, "generations": 60}
        source = sf.evolve(design, out=Path(folder) / "source", seed=100, **large)
        patches = [one.patch for one in sf.distil(source, seams=False, count=6)]
        print(f"{scene}: source {lowest(source):.1f}, {len(patches)} genes")
        plain, bred = [], []
        for seed in SEEDS:
            plain.append(lowest(sf.evolve(design, seed=seed, **SETTING)))
            bred.append(lowest(sf.evolve(design, seed=seed, genes=patches, **SETTING)))
            print(f"seed {seed:2}: without {plain[-1]:6.1f}, with genes {bred[-1]:6.1f}")
        print(f"median: without {statistics.median(plain):.1f}, with {statistics.median(bred):.1f}")


main(sys.argv[1] if len(sys.argv) > 1 else "three-cylinders")
