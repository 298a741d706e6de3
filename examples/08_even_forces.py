"""Even forces: tune stiffness at a given topology, freely and with one, two or four strands."""

import numpy as np

import springform as sf

design = sf.load("three-cylinders")
network, equilibrium = design.network(), design.solve()

# How does the smallest force change with every stiffness? One solve tells for all springs.
weakest = int(np.argmin(equilibrium.forces))
by_forces = np.zeros(len(network.springs))
by_forces[weakest] = 1.0
gradient = sf.sensitivity(network, equilibrium).gradient(forces=by_forces)
print(f"its force grows by {gradient.stiffness[weakest]:.3f} N for each N/m of its own")
others = np.delete(gradient.stiffness, weakest)
print(f"and by {others.max():.3f} N for each N/m of the spring that helps it most")

free = sf.equalise(design, bounds=(0.25, 4))
print(f"between 1/4 and 4: force differential {free.before:.2f}, then {free.after:.2f}")
assert free.design is not None
again = free.design.measure(free.design.solve()).force_differential
print(f"the design that holds these factors, solved anew: {again:.2f}")
laid = sf.equalise(design, values=(1, 2, 4))
counts = {factor: int((laid.factors == factor).sum()) for factor in (1, 2, 4)}
print(f"cords by number of strands: {counts}")
print(f"of 1, 2 or 4 strands: {laid.before:.2f}, then {laid.after:.2f}")
