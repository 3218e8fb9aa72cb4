"""What each of OMPL's planners needs in this space, and which can't work in it: found by trying them (2.0.1)."""

from typing import NamedTuple

from planners.sampling.by_name.setters import Value


class Treatment(NamedTuple):
    """How one of OMPL's planners is used; a planner that OMPL will bind one day gets the default."""

    source: str = ""
    defaults: dict[str, Value] = {}  # noqa: RUF012  a tuple's field, never changed
    """Where OMPL's or the suite's defaults do not suit; tuned on seeds from 1000 on."""
    two_trees: bool = False
    """Whether it grows a tree from the goal and checks that tree's motions outward, against time."""
    own_objective: bool = False
    """Whether it keeps OMPL's path length."""


TREATMENTS: dict[str, Treatment] = {
    "BITstar": Treatment("Gammell et al., ICRA 2015", {"samples_per_batch": 20}),
    "BKPIECE1": Treatment(
        "Sucan and Kavraki, WAFR 2008", {"detour_rad": 0.0, "attempt": 200, "iterations": 5000}, two_trees=True
    ),
    "FMT": Treatment("Janson et al., IJRR 2015", {"num_samples": 15}, own_objective=True),
    "InformedRRTstar": Treatment("Gammell et al., IROS 2014", {"goal_bias": 0.4}),
    "KPIECE1": Treatment("Sucan and Kavraki, WAFR 2008", {"goal_bias": 0.4}),
    "LBKPIECE1": Treatment(
        "Sucan and Kavraki, WAFR 2008", {"detour_rad": 0.0, "attempt": 1000, "iterations": 10_000}, two_trees=True
    ),
    "RRT": Treatment("LaValle 1998", {"goal_bias": 0.4}),
    "RRTConnect": Treatment("Kuffner and LaValle, ICRA 2000", {"detour_rad": 0.3, "attempt": 20}),
    "RRTstar": Treatment("Karaman and Frazzoli, IJRR 2011", {"goal_bias": 0.4}),
    "SORRTstar": Treatment("Gammell et al., ICRA 2015", {"goal_bias": 0.4}),
}

_THREAD = "its second thread waits for Python for ever; prm searches its roadmap in time"

REFUSED: dict[str, str] = {
    "AORRTC": "OMPL 2.0.1's can go on past any budget, and gives paths that begin at the goal",
    "BFMT": "OMPL 2.0.1's takes the process down where motions have a direction",
    "PRM": _THREAD,
    "PRMstar": _THREAD,
}
"""Planners that can't work here, and why."""

OMITTED: dict[str, str] = {
    "free_space_volume": "FMT measures it itself",
    "delay_rewiring_until_initial_solution": "OMPL says: no longer has any effect",
    "strict_queue_ordering": "OMPL says: no longer has any effect",
    "just_in_time_sampling": "OMPL does not take it",
    "nearest_k": "without it FMT looks at the last of no neighbours, and the process dies",
    "informed_sampling": "makes RRTstar an InformedRRTstar; without it SORRTstar takes the process down",
    "ordered_sampling": "makes it a SORRTstar; RRTstar takes the process down with it",
}
"""What OMPL lets one set and the suite does not, and why."""

LEAST: dict[str, float] = {
    "range": 0.01,  # RRT-Connect asks nobody between steps of this length
    "radius_multiplier": 1.0,  # with much less FMT has no neighbours, and the process dies
}
"""Least values of settings where less costs more than a search."""
