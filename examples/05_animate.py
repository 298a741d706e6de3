"""Animate: scatter the nodes of a net and let implicit Euler steps pull it into shape."""

import numpy as np

import springform as sf

network = sf.load("three-cylinders").network()
scattered = np.where(
    network.fixed[:, None],
    network.positions,
    np.random.default_rng(1).normal(size=network.positions.shape),
)
moving = sf.Network(scattered, network.springs, network.fixed, stiffness=network.stiffness)

states = list(sf.animate(moving, step=1.0, tolerance=1e-6))
for number in (0, len(states) // 2, len(states) - 1):
    print(f"step {number + 1}: residual {states[number].residual:.1e}")
print(f"converged: {states[-1].converged}")
