"""What an engine of the audit finds on its way along a motion."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from scenarios import Scenario

FloatArray = npt.NDArray[np.float64]


class Contacts(NamedTuple):
    """Contacts of a motion with its obstacles."""

    per_step_s: float
    """First whole second with a contact [s]; nan when there is none."""
    swept_s: float
    """First instant with a contact [s]; nan when there is none."""
    min_clearance_m: float
    """Smallest clearance of the whole motion [m], negative by the greatest depth; inf without obstacles."""
    obstacle: int
    """Which of the scenario's obstacles was touched at ``swept_s``; -1 when there is none."""
    section: int
    """Which of the arm's sections touched it, the one at the base being 0; -1 when there is none."""


Engine = Callable[[Scenario, FloatArray, FloatArray, float], Contacts]
"""Scenario, times (k,) [s] and configurations (k, dof) [rad] free of lies, and the instant to end at [s]."""
