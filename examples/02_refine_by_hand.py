"""Refining by hand: at one anchor after another, as in Fig. 8 of the paper; then undone."""

import springform as sf


def differential(design: sf.Design) -> float:
    """Largest over smallest spring force."""
    value = design.measure(design.solve()).force_differential
    assert value is not None
    return value


start = sf.load("one-cylinder-quad").with_method("extensible")
print(f"start: {differential(start):.1f}")

design, journal = start, []
for name, anchor in zip(start.anchor_names, start.anchors, strict=True):
    node = start.nodes[anchor]
    edits = [f"{cell} subdivide 2 2 2 2" for cell in design.cells_at(node)]
    design = design.edited(edits)
    journal += edits
    print(f"{name} refined: {differential(design):.1f}")

undone = design.edited(design.inverse(journal))
print(f"undone: {differential(undone):.1f}")
