"""Real cords: a rope between two supports, straight and unstressed, under a load in its middle."""

import numpy as np

import springform as sf

count, span, load = 21, 10.0, 500.0
positions = np.zeros((count, 3))
positions[:, 0] = np.linspace(0, span, count)
springs = np.column_stack([np.arange(count - 1), np.arange(1, count)])
loads = np.zeros((count, 3))
loads[count // 2, 2] = -load

rope = sf.Network(
    positions,
    springs,
    fixed=[0, count - 1],
    axial_stiffness=50_000.0,  # EA [N], of the unstressed length
    sense="tension",
    loads=loads,
)
equilibrium = sf.solve(rope)
print(f"{equilibrium.iterations} iterations, residual {equilibrium.residual:.1e}")
print(f"the middle sinks by {-equilibrium.positions[count // 2, 2]:.3f} m")
print(f"the rope pulls with {equilibrium.forces.max():.0f} N")

# Statics: the two halves hold the load, V = 2 F sin(angle).
half = equilibrium.positions[count // 2]
sine = -half[2] / np.hypot(half[0], half[2])
print(f"held: {2 * equilibrium.forces[0] * sine:.1f} N of {load:.1f} N")
