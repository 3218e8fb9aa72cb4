"""The registry: the house's planners, one class each."""

from planners.base import ArmPlanner
from planners.continuous.planner import ClairvoyantPlanner, ContinuousPlanner
from planners.paper.heuristics import PurgingPlanner, WaitingPlanner
from planners.paper.potential_field import PotentialFieldPlanner
from planners.paper.temporal import TemporalPlanner
from planners.sampling import PRMPlanner, RRTConnectPlanner, RRTPlanner
from planners.strrt import STRRTPlanner

HOUSE: tuple[type[ArmPlanner], ...] = (
    TemporalPlanner,
    PurgingPlanner,
    WaitingPlanner,
    RRTPlanner,
    RRTConnectPlanner,
    STRRTPlanner,
    PRMPlanner,
    PotentialFieldPlanner,
    ContinuousPlanner,
    ClairvoyantPlanner,
)

PLANNERS: dict[str, type[ArmPlanner]] = {planner.known_as(): planner for planner in HOUSE}

ALIASES: dict[str, tuple[str, dict[str, str]]] = {
    "t2": ("temporal", {"horizon": "2"}),
    "t3": ("temporal", {"horizon": "3"}),
    "temporal-best": ("temporal", {"transitions": "chained", "target": "reachable"}),
}
"""Names of a planner with settings: the paper's, and its idea at its best."""


def is_bound(label: str) -> bool:
    """Whether a planner, named as in a table (``clairvoyant[restarts=3]``), is a bound and no competitor."""
    planner = PLANNERS.get(label.partition("[")[0])
    return planner is not None and planner.is_bound
