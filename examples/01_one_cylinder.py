"""One cylinder: load a scene, find its equilibrium, read forces, measures and apertures."""

import springform as sf

design = sf.load("one-cylinder")
network = design.network()
equilibrium = design.solve()
measures = design.measure(equilibrium)

print(f"{measures.springs} springs between {measures.nodes} nodes, {len(design.anchors)} anchors")
print(f"forces {measures.force_min:.3f} to {measures.force_max:.3f} N")
print(f"shortest spring {measures.shortest_spring:.3f} m")
for aperture in measures.apertures:
    print(f"{aperture.ring}: perimeter {aperture.perimeter:.2f} m, area {aperture.area:.2f} m²")

strongest = int(equilibrium.forces.argmax())
ends = [design.nodes[node] for node in network.springs[strongest]]
print(f"the strongest spring joins {ends[0]} and {ends[1]}")
print(f"force differential {measures.force_differential:.1f}")
