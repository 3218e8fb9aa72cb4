"""The base: it cannot get out of an obstacle's way, so nobody arrives once one has run over it."""

import numpy as np

from scenarios.proofs import _kernels
from scenarios.proofs.hulls import Hulls
from scenarios.scenario import Scenario

_STEP_M = 1e-4  # an obstacle moves no farther from one look to the next
_MAX_LOOKS = 20_000


def base_hit_s(scenario: Scenario, hulls: Hulls) -> float:
    """An early instant in [0, time limit] at which an obstacle is over the base [s]; inf when none is found.

    It is looked for every 0.1 mm of an obstacle's way, or every 20,000th of the time where that is longer. A look that
    finds contact is a proof; what passes between two is missed.
    """
    base, earliest = np.zeros(3), np.inf
    for j, obstacle in enumerate(scenario.obstacles):
        end_s = min(earliest, scenario.time_limit_s)
        looks = int(np.clip(np.ceil(hulls.speeds_m_s[j] * end_s / _STEP_M), 1, _MAX_LOOKS)) + 1
        times = np.linspace(0.0, end_s, looks)
        first = _kernels.first_near(base, obstacle.position(times), j, hulls)
        if first >= 0:
            earliest = float(times[first])
    return earliest
