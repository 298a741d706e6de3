"""Graft: evolve, lift the anchor that is resolved best, set it on all anchors (the paper, 4.3).

Pictures go into a folder that may be named; by default runs/graft.
"""

import sys
from pathlib import Path

import springform as sf
from springform.plots import plot_design, plot_difference

folder = Path(sys.argv[1] if len(sys.argv) > 1 else "runs/graft")
base = sf.load("three-cylinders")
setting = {"population": 60, "generations": 60, "types": (1, 6), "insertions": 2}


def describe(name: str, design: sf.Design) -> str:
    """Say what a design has come to."""
    measures = design.measure(design.solve())
    return f"{name}: {measures.springs} springs, differential {measures.force_differential:.1f}"


# One evolved individual resolves each anchor in another way (Fig. 22, left).
run = sf.evolve(base, seed=1, until_springs=2000, **setting)
evolved = run.best.renamed("evolved")
print(describe("evolved", evolved))
peaks = sf.anchor_peaks(evolved, evolved.solve())
best = min(peaks, key=peaks.get)
worst = max(peaks, key=peaks.get)
print(f"largest over mean force: {peaks[best]:.2f} at {best}, {peaks[worst]:.2f} at {worst}")

# The designer picks the best one and repeats it on all twelve anchors (Fig. 22, right).
crown = sf.lift(evolved, anchor=best, rings=2, name="crown").patch
grafted = sf.graft(evolved, crown, anchors=True)
everywhere = grafted.design.renamed("its best anchor everywhere")
print(f"set on {len(grafted.placed)} anchors, {len(grafted.skipped)} cells skipped")
print(describe("grafted", everywhere))

# Patches from two runs, onto a fresh base (Fig. 23): crowns on the trunk and on the branches.
other = sf.evolve(base, seed=2, until_springs=2000, **setting).best
second = sf.lift(other, anchor=sf.best_anchor(other), rings=2, name="second").patch
trunk, branches = base.anchor_names[:4], base.anchor_names[4:]
fresh = sf.graft(base, crown, anchors=trunk).design
fresh = sf.graft(fresh, second, anchors=branches).design.renamed("two patches on a fresh base")

plot_difference(base.renamed("base"), evolved, folder / "evolved.png")
plot_difference(evolved, everywhere, folder / "grafted.png")
plot_difference(base.renamed("base"), fresh, folder / "fresh.png")
plot_design(fresh, folder / "fresh")
sf.save_patch(crown, folder / "crown.toml")
print(describe("fresh base with patches of two runs", fresh))
