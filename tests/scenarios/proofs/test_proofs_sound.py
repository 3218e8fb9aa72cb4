"""What somebody has solved is never proven impossible, and the tubes hold every motion that solves a scenario."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from just_missed import OVER, Solved, just_missed, random_arm
from strategies import ARM, seeds

from scenarios import ContinuumArm, Scenario
from scenarios.proofs import Bound, prove, section, sections
from scenarios.proofs.allowance import Allowance
from scenarios.proofs.cells import cells_of
from scenarios.proofs.hulls import pack_hulls
from scenarios.proofs.section import SectionTube
from scenarios.proofs.sections import SectionsTube
from suite.auditor import audit

NOTHING = Bound(0.0, np.inf)


def assert_allowed(bound: Bound, arrival_s: float) -> None:
    assert bound.outcome != "impossible", bound
    assert bound.earliest_s <= arrival_s < bound.latest_s, bound


def assert_held(solved: Solved, per_radius: int, spread: float) -> None:
    """The tube of section 1 holds the motion at each of its steps until arrival."""
    scenario, arrival_s = solved.scenario, solved.judged.arrival_time_s
    arm = scenario.arm
    cells = cells_of(arm.section_length_m, arm.max_bend_rad, per_radius)
    hulls = pack_hulls(scenario.obstacles, arm.radius_m, scenario.time_limit_s)
    step_s = spread * cells.edge_rad / Allowance.of(arm).rate_rad_s
    tube = SectionTube(scenario, hulls, NOTHING, cells, step_s)
    while True:
        bend = solved.at(np.array([tube.time_s]))[0, :2]
        assert (tube.alive & cells.around(bend)).any(), tube.time_s
        if tube.time_s + tube.step_s > arrival_s:
            assert tube.may_arrive
            break
        tube.advance()


@settings(max_examples=8)
@given(seeds, st.integers(1, 14), st.booleans(), st.sampled_from([0.0, 0.3, 0.9]))
def test_a_motion_at_the_limits_that_just_misses_everything_is_allowed(
    seed: int, n: int, shapes: bool, hold: float
) -> None:
    rng = np.random.default_rng(seed)
    solved = just_missed(rng, random_arm(rng), n, shapes, hold)
    if solved is None:
        return
    proof = prove(solved.scenario)
    assert_allowed(proof.executable, solved.judged.arrival_time_s)
    assert_allowed(proof.swept, solved.judged.arrival_time_s)
    assert_held(solved, int(rng.choice([10, 30])), float(rng.choice([0.3, 1.0, 2.5, 20.0])))


def test_the_draw_of_such_motions_puts_the_proofs_to_the_test() -> None:
    rng = np.random.default_rng(1)
    drawn = [just_missed(rng, ARM, 12) for _ in range(60)]
    proofs = [prove(solved.scenario) for solved in drawn if solved]
    assert len(proofs) > 40
    assert sum(proof.executable.outcome == "deadline" or proof.executable.earliest_s > 0.5 for proof in proofs) > 20


@pytest.mark.parametrize("seed", range(8))
def test_the_tube_of_two_sections_holds_such_motions(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sections, "PER_RADIUS", 6)
    rng = np.random.default_rng(seed)
    solved = None
    while solved is None:
        arm = random_arm(rng).model_copy(update={"n_sections": int(rng.integers(2, 5))})
        solved = just_missed(rng, arm, 8, shapes=seed == 0)
    scenario, arrival_s = solved.scenario, solved.judged.arrival_time_s
    hulls = pack_hulls(scenario.obstacles, scenario.arm.radius_m, scenario.time_limit_s)
    tube = SectionsTube(scenario, hulls, NOTHING)
    while True:
        row, column = tube.pairs_of(solved.at(np.array([tube.time_s]))[0, :4])
        assert tube.alive[row, column], tube.time_s
        if tube.time_s + tube.step_s > arrival_s:
            assert tube.may_arrive
            break
        tube.advance()
    assert_allowed(sections.tighten_by_sections(scenario, hulls, NOTHING), arrival_s)


def test_fine_cells_are_as_sound(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(section, "LITTLE", 10**9)  # every scenario counts as narrow
    rng = np.random.default_rng(3)
    for _ in range(12):
        solved = just_missed(rng, ARM, 10)
        if solved:
            assert_allowed(prove(solved.scenario).executable, solved.judged.arrival_time_s)


def test_a_tip_that_goes_nearly_straight_as_fast_as_the_audit_lets_it_is_in_time() -> None:
    ends = np.array([[-0.05, 0.0], [0.05, 0.0]])
    arm = ContinuumArm(n_sections=1, section_length_m=0.4)
    start, goal = arm.tips(ends)
    middle = arm.tips([[-1e-4, 0.0], [1e-4, 0.0]])  # where it is fastest
    arrival_s = 1.0
    speed = np.linalg.norm(middle[1] - middle[0]) / (2e-4 / 0.1) / arrival_s
    limited = arm.model_copy(update={"max_tip_speed_m_s": float(speed / OVER)})
    scenario = Scenario(
        id="straight",
        arm=limited,
        start_rad=tuple(ends[0]),
        goal_m=tuple(goal),
        goal_tolerance_m=1e-6,
        time_limit_s=1.0,
    )
    judged = audit(scenario, [0.0, arrival_s], ends)
    assert judged.executable.success
    assert arrival_s < (np.linalg.norm(goal - start) - 1e-6) / limited.max_tip_speed_m_s  # not without the slack
    assert_allowed(prove(scenario).executable, judged.arrival_time_s)
