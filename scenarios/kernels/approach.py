"""How fast the surfaces of sampled spheres move."""

import math

from scenarios.kernels.jit import kernel


@kernel
def fastest_approach(centers, radii):
    """Fastest approach of any surface [m per sample]; nan when a number is not finite.

    Args:
        centers: Sampled centres, shape (T, m, 3), [m].
        radii: Sampled radii, shape (T, m), [m]; growth is approach, shrinking is not.
    """
    fastest = 0.0
    for k in range(centers.shape[0]):
        for j in range(centers.shape[1]):
            x, y, z, radius = centers[k, j, 0], centers[k, j, 1], centers[k, j, 2], radii[k, j]
            if not math.isfinite(x + y + z + radius):
                return math.nan
            if k > 0:
                dx, dy, dz = x - centers[k - 1, j, 0], y - centers[k - 1, j, 1], z - centers[k - 1, j, 2]
                grown = max(radius - radii[k - 1, j], 0.0)
                fastest = max(fastest, math.sqrt(dx * dx + dy * dy + dz * dz) + grown)
    return fastest
