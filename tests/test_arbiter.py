"""The planners' kernels give the answers of the shared checker and validator, over whole trials: a short share.

All of it is ``python -m tests.arbiter`` (docs/arbiter.md); here nothing is compiled for the questions.
"""

import pytest
from arbiter import BothWays, both_ways

from planners.problem import _kernels as shared
from planners.sampling.roadmap import _kernels as roadmap
from planners.strrt.region import _kernels as region
from planners.strrt.trees import _kernels as trees


@pytest.mark.parametrize(("planner", "obstacles"), [("t3", (1, 5)), ("h", (1,)), ("pf", (1,)), ("temporal-ct", (1,))])
def test_rows_are_those_of_a_trial_that_asks_the_arbiter(planner: str, obstacles: tuple[int, ...]) -> None:
    found = both_ways(planner, 1, 1000, obstacles, interpreted=True)
    assert found.is_kept, str(found)
    assert found.different == 0
    assert found.asked > 10


def test_strrt_and_prm_call_the_kernels_of_checker_and_validator_themselves() -> None:
    assert trees.motion_valid is roadmap.motion_valid is shared.motion_valid
    assert region.clearance is shared.clearance


def test_a_kernel_that_calls_a_blocked_motion_free_breaks_the_promise() -> None:
    kept = BothWays(4, different=0, solves=40, through_ompl=40, asked=1000, unsafe=0, cautious=0, allowed=0.0)
    assert kept.is_kept
    assert not kept._replace(unsafe=1).is_kept
    assert not kept._replace(different=1).is_kept
    assert not kept._replace(asked=0).is_kept
    assert not kept._replace(allowed=0.001, cautious=2).is_kept
    assert kept._replace(allowed=0.001, cautious=1, different=1).is_kept
