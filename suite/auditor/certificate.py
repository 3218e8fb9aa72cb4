"""The engine that proves: conservative advancement with bounded speeds (docs/audit.md)."""

import numpy as np
import numpy.typing as npt

from scenarios import Scenario
from suite.auditor import _kernels
from suite.auditor.engine import Contacts, FloatArray
from suite.auditor.truth import Truth, pack


def certified_contacts(scenario: Scenario, times_s: FloatArray, states: FloatArray, end_s: float) -> Contacts:
    """Contacts over [times_s[0], end_s]; where none is found there is none."""
    arm = scenario.arm
    found = _kernels.contacts(times_s, states, end_s, arm.section_length_m, arm.radius_m, _truth(scenario))
    return Contacts(*found)


def clearance(scenario: Scenario, q: npt.ArrayLike, time_s: float) -> float:
    """Clearance [m] of the arm at ``q`` (dof,) [rad] from the true obstacles at ``time_s`` [s], never overstated."""
    arm = scenario.arm
    state = np.ascontiguousarray(q, dtype=np.float64).reshape(1, arm.dof)
    at = np.array([time_s], dtype=np.float64)
    work = _kernels.make_work(arm.n_sections)
    return float(_kernels.look_at(at, state, at[0], arm.section_length_m, arm.radius_m, _truth(scenario), work))


def collides(scenario: Scenario, q: npt.ArrayLike, time_s: float) -> bool:
    """Whether the arm at ``q`` (dof,) [rad] touches an obstacle at ``time_s`` [s]: the per-step check by itself."""
    return clearance(scenario, q, time_s) <= 0.0


class _Latest:
    """The last scenario packed: an episode asks about the same one at every step."""

    scenario: Scenario | None = None
    truth: Truth


def _truth(scenario: Scenario) -> Truth:
    if _Latest.scenario is not scenario:
        _Latest.scenario, _Latest.truth = scenario, pack(scenario)
    return _Latest.truth
