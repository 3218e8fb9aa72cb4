"""The registry: one entry per planner, and the notation in which users name them."""

import math
from collections.abc import Callable
from typing import Any, Literal, NamedTuple

from ompl import base as ob
from pydantic import BaseModel

from planners.continuous.planner import (
    LARGEST_BOUND_M,
    ClairvoyantPlanner,
    ClairvoyantSettings,
    ContinuousPlanner,
    ContinuousSettings,
)
from planners.paper.heuristics import HeuristicSettings, PurgingPlanner, PurgingSettings, WaitingPlanner
from planners.paper.potential_field import PotentialFieldPlanner, PotentialFieldSettings
from planners.paper.temporal import TemporalPlanner, TemporalSettings
from planners.problem import SpaceTimeProblem
from planners.sampling import RRTSettings, TreeSettings, build_rrt, build_rrtconnect
from planners.sampling.roadmap import PRMPlanner, PRMSettings
from planners.strrt import STRRTPlanner, STRRTSettings
from scenarios.spec import SpecError, known_name, parse_settings, parse_spec
from scenarios.spec import split_specs as split_texts

Commitment = Literal["path", "while_valid", "step"]
"""When to ask a planner again: at the end of its path (Algorithm 2), as soon as the newest prediction makes the rest
of its path invalid or that path does not lead to the goal, or at every step."""


class PlannerEntry(NamedTuple):
    """One line of the registry."""

    name: str
    summary: str
    source: str
    settings: type[BaseModel]
    build: Callable[[SpaceTimeProblem, Any], ob.Planner]
    commitment: Commitment
    horizon_s: Callable[[Any], float]
    """How far ahead its settings make it look [s]."""
    prediction_step_s: float = 1.0
    """Spacing of the predicted positions it is given [s]."""
    prediction_margin: float = 0.0
    """Obstacles are grown by this many standard deviations of their predicted position's error."""
    largest_bound_m: float = math.inf
    """Standard deviations are taken for no more than this [m]."""
    predictor: str = "cubic"
    """The predictor it works with unless a run asks for another."""
    is_bound: bool = False
    """Sees the true future: shows what is possible and is never ranked."""

    def predictor_for(self, asked: str | None) -> str:
        """Name of the predictor it works with when a run asks for ``asked``, or for each planner's own (None)."""
        return "truth" if self.is_bound else asked or self.predictor


def _replanned(
    name: str,
    summary: str,
    source: str,
    settings: type[BaseModel],
    build: Callable[[SpaceTimeProblem, Any], ob.Planner],
) -> PlannerEntry:
    """A planner of whole ways through a long prediction: asked again as soon as the newest one invalidates its path."""
    return PlannerEntry(
        name,
        summary,
        source,
        settings,
        build,
        "while_valid",
        lambda s: float(s.horizon_s),
        prediction_step_s=0.25,
        prediction_margin=1.0,
        largest_bound_m=LARGEST_BOUND_M,
        predictor="portfolio",
    )


PLANNERS: dict[str, PlannerEntry] = {
    entry.name: entry
    for entry in (
        PlannerEntry(
            "temporal",
            "temporal cubes-graph and layered graph of configurations",
            "Meng et al., ICRA 2021, Algorithms 1 and 2",
            TemporalSettings,
            TemporalPlanner,
            "path",
            lambda s: float(s.horizon),
        ),
        PlannerEntry(
            "h",
            "static cube path, recomputed without the cubes found blocked",
            "first heuristic: paper, section IV-A",
            PurgingSettings,
            PurgingPlanner,
            "path",
            lambda _: 1.0,
        ),
        PlannerEntry(
            "hs",
            "static cube path, waiting while the next cube is blocked",
            "second heuristic: paper, section IV-B",
            HeuristicSettings,
            WaitingPlanner,
            "path",
            lambda _: 1.0,
        ),
        _replanned(
            "rrt",
            "OMPL's RRT in space-time, replanned when the prediction invalidates the path",
            "LaValle 1998",
            RRTSettings,
            build_rrt,
        ),
        _replanned(
            "rrtconnect",
            "OMPL's RRT-Connect in space-time, replanned when the prediction invalidates the path",
            "Kuffner and LaValle, ICRA 2000",
            TreeSettings,
            build_rrtconnect,
        ),
        _replanned(
            "strrt",
            "ST-RRT* in space-time, replanned when the prediction invalidates the path",
            "Grothe et al., ICRA 2022",
            STRRTSettings,
            STRRTPlanner,
        ),
        _replanned(
            "prm",
            "OMPL's roadmap, searched for the earliest arrival among the predicted obstacles",
            "Kavraki et al. 1996; van den Berg et al. 2006",
            PRMSettings,
            PRMPlanner,
        ),
        PlannerEntry(
            "pf",
            "potential field on the arm's body",
            "Godage et al., ICMA 2012; Ataka et al., ICRA 2016; paper, section IV-C",
            PotentialFieldSettings,
            PotentialFieldPlanner,
            "step",
            lambda _: 1.0,
        ),
        _replanned(
            "temporal-ct",
            "space-time tree of steered runs, valid at every instant, repaired when the prediction changes",
            "this suite: docs/temporal-ct.md",
            ContinuousSettings,
            ContinuousPlanner,
        ),
        PlannerEntry(
            "clairvoyant",
            "the same search with the true motion, a large budget and restarts",
            "this suite: docs/temporal-ct.md",
            ClairvoyantSettings,
            ClairvoyantPlanner,
            "path",
            lambda s: float(s.horizon_s),
            prediction_step_s=0.25,
            is_bound=True,
        ),
    )
}

ALIASES: dict[str, tuple[str, dict[str, str]]] = {
    "t2": ("temporal", {"horizon": "2"}),
    "t3": ("temporal", {"horizon": "3"}),
    "temporal-best": ("temporal", {"transitions": "chained", "target": "reachable"}),
}
"""Names of a planner with settings: the paper's, and its idea at its best."""


def is_bound(label: str) -> bool:
    """Whether a planner, named as in a table (``clairvoyant[restarts=3]``), is a bound and no competitor."""
    entry = PLANNERS.get(label.partition("[")[0])
    return entry is not None and entry.is_bound


class PlannerSpec(NamedTuple):
    """A planner with its settings, as a user names it; can be sent to another process."""

    label: str
    """As typed, without blanks; it names the planner in every table."""
    name: str
    """Key of ``PLANNERS``."""
    settings: BaseModel

    def __str__(self) -> str:
        """The label, from which ``parse_planner`` makes the same spec."""
        return self.label


def parse_planner(text: str) -> PlannerSpec:
    """Read ``temporal[horizon=3]``, ``t2`` or ``rrt``.

    Raises:
        SpecError: Unknown planner or setting, or a value out of range; the message lists what is allowed.
    """
    typed, values = parse_spec(text)
    known_name("planner", typed, [*PLANNERS, *ALIASES])
    name, preset = ALIASES.get(typed, (typed, {}))
    fixed = [key for key in values if key in preset]
    if fixed:
        raise SpecError(f"{typed}: found setting {fixed[0]!r}, allowed on {name}[{fixed[0]}=...] only")
    settings = parse_settings(typed, PLANNERS[name].settings, {**preset, **values})
    return PlannerSpec("".join(text.split()), name, settings)


def split_specs(text: str) -> list[PlannerSpec]:
    """Read a comma-separated list of planners.

    Raises:
        SpecError: As ``parse_planner``, or the same planner stands twice.
    """
    specs = [parse_planner(part) for part in split_texts(text)]
    labels = [spec.label for spec in specs]
    if len(set(labels)) < len(labels):
        twice = next(label for label in labels if labels.count(label) > 1)
        raise SpecError(f"planners: found {twice!r} twice, allowed once")
    return specs
