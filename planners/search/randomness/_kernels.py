"""A generator whose state is one array, so that a compiled search can be gone on with; the same on every machine."""

import math

import numpy as np

from scenarios.kernels.jit import bare_kernel


@bare_kernel
def uniform(rng):
    """Next number in [0, 1) of the splitmix64 generator whose state is ``rng`` (1,) uint64 (Steele et al. 2014)."""
    rng[0] += np.uint64(0x9E3779B97F4A7C15)
    z = rng[0]
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    z = z ^ (z >> np.uint64(31))
    return float(z >> np.uint64(11)) * (1.0 / 9007199254740992.0)


@bare_kernel
def random_posture(rng, max_bend, out):
    """A configuration uniform over each section's disc of bends into ``out`` (2n,) [rad]."""
    for i in range(0, out.shape[0], 2):
        bend, plane = max_bend * math.sqrt(uniform(rng)), 2.0 * math.pi * uniform(rng)
        out[i], out[i + 1] = bend * math.cos(plane), bend * math.sin(plane)
