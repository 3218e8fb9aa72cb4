"""Scenarios of which it is plain why, and from when on, nobody can solve them."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenarios import Box, Capsule, ContinuumArm, Cylinder, Line, Mesh, Obstacle, Scenario, ScenarioError, Track
from scenarios.proofs import Bound, Proof, Reason, allowance, prove
from scenarios.proofs.allowance import Allowance
from suite.auditor import _kernels as audit_kernels
from suite.auditor.motion import _kernels as motion_kernels

ARM = ContinuumArm()
STRAIGHT = (0.0,) * 6
TIP_M = (0.0, 0.0, 0.45)
SPEED_M_S = ARM.max_tip_speed_m_s


def scenario(*obstacles: Obstacle, goal: tuple[float, float, float] = (0.3, 0.0, 0.2), **fields: object) -> Scenario:
    return Scenario(**({"id": "known", "start_rad": STRAIGHT, "goal_m": goal, "obstacles": obstacles} | fields))


def resting(radius: float, *at: float) -> Obstacle:
    return Obstacle(radius_m=radius, motion=Line(point_m=at, velocity_m_s=(0.0, 0.0, 0.0)))


def straight_s(goal: tuple[float, float, float]) -> float:
    return (math.dist(TIP_M, goal) - 0.01) / SPEED_M_S


def test_nothing_is_proven_where_there_is_no_obstacle() -> None:
    proof = prove(scenario(), "base")
    for bound in proof:
        assert (bound.outcome, bound.latest_s, bound.reason) == ("nothing", math.inf, None)
    assert proof.swept.earliest_s == 0.0
    assert straight_s((0.3, 0.0, 0.2)) * (1 - 3e-3) < proof.executable.earliest_s < straight_s((0.3, 0.0, 0.2))
    assert prove(scenario()) == proof


SHAPES = {  # each reaches 3 cm from its centre towards -x
    "sphere": {"radius_m": 0.03},
    "box": {"shape": Box(size_m=(0.06, 0.02, 0.02))},
    "capsule": {"shape": Capsule(radius_m=0.01, length_m=0.04, rotation_rad=(0.0, math.pi / 2, 0.0))},
    "cylinder": {"shape": Cylinder(radius_m=0.01, length_m=0.06, rotation_rad=(0.0, math.pi / 2, 0.0))},
    "mesh": {"shape": Mesh(vertices_m=((-0.03, 0, 0), (0.03, 0.02, 0), (0.03, -0.02, 0), (0.0, 0.0, 0.02)))},
}


@pytest.mark.parametrize("kind", SHAPES)
@pytest.mark.parametrize("speed", [0.005, 0.02])
def test_what_runs_over_the_base_ends_it(kind: str, speed: float) -> None:
    motion = Line(point_m=(0.12, 0.0, 0.0), velocity_m_s=(-speed, 0.0, 0.0))
    hit_s = (0.12 - 0.03 - ARM.radius_m) / speed
    proof = prove(scenario(Obstacle(motion=motion, **SHAPES[kind])), "base")
    is_late = hit_s > straight_s((0.3, 0.0, 0.2))
    assert proof.executable.outcome == ("deadline" if is_late else "impossible")
    assert proof.swept.outcome == "deadline"
    for bound in proof:
        assert bound.reason == Reason.BASE
        assert hit_s - 1e-9 <= bound.latest_s < hit_s + 1.1e-3 / speed


def test_a_touch_of_the_base_between_two_points_of_a_track_counts() -> None:
    motion = Track(times_s=(0.0, 2.0, 4.0), positions_m=((0.2, 0.0, 0.0), (0.0, 0.0, 0.0), (0.2, 0.0, 0.0)))
    bound = prove(scenario(Obstacle(radius_m=0.02, motion=motion)), "base").executable
    assert (bound.outcome, bound.reason) == ("impossible", Reason.BASE)
    assert bound.latest_s == pytest.approx(2.0 * (0.2 - 0.02 - ARM.radius_m) / 0.2, abs=120 / 20_000 + 1e-3)


def test_a_goal_beyond_the_arms_length_is_out_of_reach_of_any_motion() -> None:
    assert [bound.outcome for bound in prove(scenario(goal=(0.0, 0.0, 0.4599)))] == ["nothing"] * 2
    for bound in prove(scenario(goal=(0.0, 0.0, 0.4601))):
        assert (bound.outcome, bound.reason) == ("impossible", Reason.REACH)


def test_a_goal_farther_than_the_tip_goes_by_the_time_limit_is_no_matter_to_the_swept_verdict() -> None:
    proof = prove(scenario(time_limit_s=20.0))
    assert (proof.executable.outcome, proof.executable.reason) == ("impossible", Reason.WAY)
    assert proof.swept.outcome == "nothing"


@pytest.mark.parametrize(("spare_m", "outcome"), [(1e-4, "impossible"), (-1e-4, "nothing")])
def test_an_obstacle_that_rests_on_all_of_the_goals_ball_ends_it_for_any_motion(spare_m: float, outcome: str) -> None:
    covering = resting(0.03, 0.3, 0.0, 0.2 + 0.03 + ARM.radius_m - 0.01 - spare_m)
    for bound in prove(scenario(covering), "base"):
        assert bound.outcome == outcome


def test_an_obstacle_that_leaves_the_goal_delays_arrival() -> None:
    motion = Line(point_m=(0.3, 0.0, 0.2), velocity_m_s=(0.0, 0.001, 0.0))
    # A tip may stray by 0.0135 mm from what rates allow.
    leaves_s = (0.03 + ARM.radius_m - 0.01) / 0.001
    proof = prove(scenario(Obstacle(radius_m=0.03, motion=motion)), "base")
    assert proof.swept.earliest_s == pytest.approx(leaves_s, abs=0.02)
    assert leaves_s - 0.02 < proof.executable.earliest_s


def test_a_block_on_the_straight_way_delays_a_tip_that_has_no_time_to_go_round_it() -> None:
    goal = (0.3, 0.0, 0.2)
    halfway = resting(0.06, *(np.add(TIP_M, goal) / 2))
    earliest_s = prove(scenario(halfway, goal=goal), "base").executable.earliest_s
    assert earliest_s > straight_s(goal) + 0.5
    # Round a ball as large as both: no longer than the two legs that touch it at a right angle to the straight way.
    legs_m = 2 * math.hypot(math.dist(TIP_M, goal) / 2, 0.06 + ARM.radius_m) - 0.01
    assert earliest_s <= legs_m / SPEED_M_S


def test_a_ceiling_that_comes_down_leaves_section_1_nowhere_to_go_before_it_is_at_the_base() -> None:
    # However a section bends, some point of it is L / pi high; the ceiling is at 0.5 m - 0.01 m/s * t.
    down = Line(point_m=(0.0, 0.0, 9.5), velocity_m_s=(0.0, 0.0, -0.01))
    ceiling = Obstacle(radius_m=9.0, motion=down)
    bound = prove(scenario(ceiling, goal=(0.0, 0.0, 0.1))).executable
    too_low_s = (0.5 - ARM.section_length_m / math.pi - ARM.radius_m) / 0.01
    at_base_s = (0.5 - ARM.radius_m) / 0.01
    assert bound.reason == Reason.SECTION
    assert too_low_s - 0.5 < bound.latest_s < too_low_s + 0.5 < at_base_s


@pytest.mark.parametrize("n_sections", [1, 2, 4])
def test_two_sections_prove_no_less_than_one(n_sections: int, monkeypatch: pytest.MonkeyPatch) -> None:
    from scenarios.proofs import sections

    monkeypatch.setattr(sections, "PER_RADIUS", 10)
    arm = ContinuumArm(n_sections=n_sections, max_bend_rate_rad_s=2.0)
    down = Line(point_m=(0.0, 0.0, 2.0 + arm.length_m), velocity_m_s=(0.0, 0.0, -0.1))
    low = scenario(
        Obstacle(radius_m=1.9, motion=down), arm=arm, start_rad=(0.0,) * arm.dof, goal=(0.0, 0.0, 0.9 * arm.length_m)
    )
    one, two = prove(low, "section").executable, prove(low, "sections").executable
    assert one.latest_s < math.inf
    assert two.earliest_s >= one.earliest_s
    assert two.latest_s <= one.latest_s


def test_another_effort_is_refused() -> None:
    with pytest.raises(ScenarioError, match="effort: found 'much', allowed base, section, sections"):
        prove(scenario(), "much")  # type: ignore[arg-type]


def test_what_the_audit_lets_pass_is_allowed_for() -> None:
    assert allowance.RATE_SLACK >= motion_kernels.LIMIT_SLACK
    assert allowance.SPEED_SLACK >= 2 * motion_kernels.LIMIT_SLACK
    assert allowance.ARRIVAL_SLACK_M > motion_kernels.ARRIVAL_SLACK_M
    assert allowance.LATE_S > motion_kernels.SAME_TIME_S
    steps = 10_000 * math.sqrt(2) * motion_kernels.SAME_CONFIGURATION_RAD
    start = math.sqrt(2) * motion_kernels.SAME_START_RAD
    assert steps + start + motion_kernels.BEND_SLACK_RAD <= allowance.STRAY_RAD
    # Proofs count contact from clearance 0 on; the audit lets nothing pass that is nearer than this.
    assert audit_kernels.KEPT_SHARE * audit_kernels.CONTACT_M > 7e-5


def test_a_tip_is_no_faster_than_bending_makes_it() -> None:
    slow = Allowance.of(ContinuumArm(max_bend_rate_rad_s=0.001))
    assert slow.tip_speed_m_s == pytest.approx(1.001 * 0.001 * 0.15 * (0.5 + 1.5 + 2.5), rel=1e-6)
    assert Allowance.of(ARM).tip_speed_m_s == pytest.approx(1.002 * SPEED_M_S, rel=1e-6)


times = st.floats(0.0, 200.0)


@given(times, st.one_of(times, st.just(math.inf)), times, times)
def test_a_bound_only_ever_gets_tighter_and_says_why(earliest: float, latest: float, more: float, less: float) -> None:
    before = Bound(earliest, latest, None if latest == math.inf else Reason.BASE)
    after = before.tightened(Reason.SECTION, more, less)
    assert (after.earliest_s, after.latest_s) == (max(earliest, more), min(latest, less))
    assert (after.outcome == "impossible") == (after.earliest_s >= after.latest_s)
    assert (after.outcome == "nothing") == (after.reason is None and after.earliest_s < after.latest_s)
    if less < latest or (after.outcome == "impossible" and before.outcome != "impossible"):
        assert after.reason == Reason.SECTION
    else:
        assert after.reason == before.reason


def test_a_proof_says_which_verdict_it_is_about() -> None:
    assert Proof._fields == ("executable", "swept")
