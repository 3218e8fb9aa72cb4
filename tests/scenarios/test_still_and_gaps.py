import json

import numpy as np
import pytest
from pydantic import ValidationError

from scenarios import Obstacle, Scenario, Still, Track
from suite.auditor import audit

POINT = (0.05, 0.0, 0.3)
TRACK = Track(times_s=(0.0, 1.0, 4.0, 5.0), positions_m=(POINT,) * 4, gaps_s=((1.0, 4.0), (4.0, 4.5)))


def scenario_of(motion: Still | Track) -> Scenario:
    obstacle = Obstacle(radius_m=0.02, motion=motion)
    return Scenario(id="one", start_rad=(0.0,) * 6, goal_m=(0.3, 0.0, 0.2), obstacles=(obstacle,))


def test_a_gap_does_not_hold_its_ends() -> None:
    times = np.array([-1.0, 0.0, 1.0, 1.01, 2.0, 4.0, 4.2, 4.5, 5.0, 9.0])
    assert TRACK.unseen(times).tolist() == [False, False, False, True, True, False, True, False, False, False]


@pytest.mark.parametrize("gaps", [((2.0, 1.0),), ((1.0, 1.0),), ((1.0, 3.0), (2.0, 4.0)), ((3.0, 4.0), (1.0, 2.0))])
def test_gaps_are_intervals_in_order(gaps: tuple[tuple[float, float], ...]) -> None:
    with pytest.raises(ValidationError, match="gaps_s must be intervals"):
        Track(times_s=(0.0, 5.0), positions_m=(POINT, POINT), gaps_s=gaps)


def test_a_track_without_gaps_is_what_it_was_before_there_were_gaps() -> None:
    whole = TRACK.model_copy(update={"gaps_s": ()})
    assert set(json.loads(whole.model_dump_json())) == {"kind", "times_s", "positions_m"}
    hashes = {scenario_of(motion).content_hash for motion in (TRACK, whole)}
    assert len(hashes) == 2
    assert scenario_of(whole).content_hash == "84558809d07f2198"


def test_what_stands_still_is_judged_as_a_track_of_one_point() -> None:
    still, point = Still(point_m=POINT), Track(times_s=(0.0,), positions_m=(POINT,))
    rng = np.random.default_rng(0)
    times, states = np.arange(10.0), np.cumsum(rng.normal(scale=0.05, size=(10, 6)), axis=0)
    states -= states[0]
    one, other = (audit(scenario_of(motion), times, states) for motion in (still, point))
    assert one.min_clearance_m == pytest.approx(other.min_clearance_m, abs=1e-12)
    assert one.swept.violation_kind == other.swept.violation_kind
    assert Scenario.model_validate_json(scenario_of(still).model_dump_json()) == scenario_of(still)
