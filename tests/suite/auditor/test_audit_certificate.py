import numpy as np
import pytest
from audit_twin import (
    Motion,
    backbone,
    clearances,
    random_bending,
    random_direction,
    random_motion,
    smallest_clearance,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from scenarios import ContinuumArm, Obstacle, Orbit, Scenario, Track, clearance, sample_world
from suite.auditor import Kind, audit, collides
from suite.auditor import clearance as audited_clearance
from suite.auditor._kernels import CONTACT_M, kept

MICROMETRE = 1e-6


def promised(seen_m):
    """The least that the true smallest clearance can be where the audit saw ``seen_m``, by docs/audit.md."""
    return 0.75 * seen_m if seen_m >= 1e-4 else seen_m - max(1e-4, abs(seen_m) / 4)


def is_free(judged):
    return judged.swept.violation_kind != Kind.COLLISION


def milliseconds(motion):
    return np.arange(0.0, motion.times_s[-1] + 1e-9, 1e-3)


@pytest.mark.parametrize("thousand", range(10))
def test_ten_thousand_motions_free_means_free_and_clear_means_free(thousand):
    rng = np.random.default_rng(thousand)
    free, clear, called_collisions = 0, 0, 0
    for _ in range(1000):
        motion = random_motion(rng)
        judged = audit(*motion)
        smallest = smallest_clearance(motion, milliseconds(motion))
        if is_free(judged):
            free += 1
            assert smallest > 0.0  # stronger than "no deeper than 0.1 mm"
        if smallest >= 1e-3:
            clear += 1
            called_collisions += not is_free(judged)
    assert free > 200
    assert clear > 200
    assert called_collisions == 0  # fewer than 1 % are asked for


def resting_beside_the_base(gap_m):
    """Next to it no other obstacle is near: the certificate then leaps as far as its bounds allow."""
    point = (0.0, 0.0, -(0.018 + 0.01 + gap_m))
    return Obstacle(radius_m=0.01, motion=Track(times_s=(0.0,), positions_m=(point,)))


def random_dart(rng, arm, q):
    """A small sphere that flies fast and straight at, or just past, the arm."""
    at_s, velocity = rng.uniform(0.1, 0.9), rng.uniform(1.0, 4.0) * random_direction(rng)
    points = backbone(arm, q[None], np.linspace(0, 1, 30))[0]
    there = points[rng.integers(10, len(points))] + rng.uniform(0.0, 0.03) * random_direction(rng)
    track = Track(
        times_s=(0.0, 1.0), positions_m=(tuple(there - at_s * velocity), tuple(there + (1 - at_s) * velocity))
    )
    return Obstacle(radius_m=0.002, motion=track)


@pytest.mark.parametrize("moving", ["darts", "arm"])
def test_fast_small_things_are_not_leapt_over(moving):
    rng = np.random.default_rng(5)
    arm, hits = ContinuumArm(), 0
    for _ in range(200):
        q = random_bending(rng, 3, 1.0)
        if moving == "darts":
            states, others = np.stack([q, q]), (random_dart(rng, arm, q),)
        else:
            # Sections that bend alike while the arm is nearly straight: its tip is as fast as the bound says.
            states = np.tile(random_bending(rng, 1), 3) * [[-0.4], [0.4]]
            there = backbone(arm, states.mean(axis=0)[None], np.array([1.0]))[0, -1]
            point = tuple(there + rng.uniform(0.0, 0.03) * random_direction(rng))
            others = (Obstacle(radius_m=0.002, motion=Track(times_s=(0.0,), positions_m=(point,))),)
        scenario = Scenario(
            id="fast",
            arm=arm,
            start_rad=tuple(states[0]),
            goal_m=(5, 5, 5),
            obstacles=(resting_beside_the_base(5e-3), *others),
        )
        motion = Motion(scenario, np.array([0.0, 1.0]), states)
        hit = clearances(motion, milliseconds(motion)).min() < -1e-4
        hits += hit
        assert not (hit and is_free(audit(*motion)))
    assert hits > 50


@settings(max_examples=300)
@given(seed=st.integers(0, 2**32 - 1), duration_s=st.floats(0.02, 2.5), gap_m=st.floats(0.0, 0.1))
def test_any_motion_free_means_free_and_clear_means_free(seed, duration_s, gap_m):
    motion = random_motion(np.random.default_rng(seed), duration_s, gap_m)
    judged = audit(*motion)
    smallest = smallest_clearance(motion, milliseconds(motion))
    if is_free(judged):
        assert smallest > 0.0
    if smallest >= 1e-3:
        assert is_free(judged)


@settings(max_examples=200)
@given(seed=st.integers(0, 2**32 - 1))
def test_first_contact_is_a_contact_and_smallest_clearance_is_near_the_true_one(seed):
    motion = random_motion(np.random.default_rng(seed), largest_gap_m=0.1)
    judged = audit(*motion)
    true, seen_m = clearances(motion, milliseconds(motion), 300).min(), judged.min_clearance_m
    assert promised(seen_m) <= true + MICROMETRE
    between_two_looks_m = 0.6e-3  # of the twin, a millisecond apart
    assert true <= max(1.2 * seen_m, seen_m + 8 * MICROMETRE) + between_two_looks_m
    if is_free(judged):
        assert seen_m >= CONTACT_M
    else:
        at = np.array([judged.swept.violation_time_s])
        assert clearances(motion, at, 300)[0] < CONTACT_M * 1.2 + 8 * MICROMETRE


def test_what_is_kept_is_what_is_promised_and_grows_with_what_was_seen():
    seen = np.sort([*np.linspace(-0.1, 0.1, 2001), CONTACT_M, np.nextafter(CONTACT_M, 0)])
    below = np.array([kept(m) for m in seen])
    np.testing.assert_allclose(below, [promised(m) for m in seen], rtol=1e-12)
    assert (np.diff(below) >= 0).all()
    assert (below < seen).all()


def test_after_a_graze_the_deepest_contact_is_still_found():
    """Grazed in the first second, struck deep between the second and the third, clear at every whole second."""
    straight = ContinuumArm(n_sections=1)
    reach = straight.radius_m + 0.01
    off = [reach + 0.03, reach - 0.0002, reach + 0.03, reach - 0.012, reach + 0.03]
    times = (0.0, 0.5, 1.5, 2.5, 3.5)
    track = Track(times_s=times, positions_m=tuple((x, 0.0, 0.1) for x in off))
    scenario = Scenario(
        id="twice",
        arm=straight,
        start_rad=(0, 0),
        goal_m=(5, 5, 5),
        obstacles=(Obstacle(radius_m=0.01, motion=track),),
    )
    judged = audit(scenario, [0.0, 4.0], np.zeros((2, 2)))
    assert judged.per_step.violation_kind == Kind.SHORT_OF_GOAL
    assert judged.swept.violation_kind == Kind.COLLISION
    assert 0.45 < judged.swept.violation_time_s < 0.5
    assert judged.min_clearance_m + MICROMETRE >= -0.012
    assert promised(judged.min_clearance_m) <= -0.012


def test_a_contact_at_a_whole_second_does_not_end_the_search_for_the_smallest_clearance():
    arm = ContinuumArm(n_sections=1)
    times, off = (0.0, 1.0, 2.0), (0.1, 0.027, 0.02)  # the arm and the sphere touch at 0.028 m
    track = Track(times_s=times, positions_m=tuple((x, 0.0, 0.1) for x in off))
    scenario = Scenario(
        id="on", arm=arm, start_rad=(0, 0), goal_m=(5, 5, 5), obstacles=(Obstacle(radius_m=0.01, motion=track),)
    )
    judged = audit(scenario, [0.0, 2.5], np.zeros((2, 2)))
    assert judged.per_step[1:] == (1.0, Kind.COLLISION)
    assert judged.min_clearance_m == pytest.approx(-0.008, abs=2e-3)
    assert promised(judged.min_clearance_m) <= -0.008


@pytest.mark.parametrize(("gap_m", "collides_"), [(2e-4, False), (1.3e-4, False), (7e-5, True), (0.0, True)])
def test_the_line_between_free_and_contact_lies_between_the_two_that_are_promised(gap_m, collides_):
    """0.12 mm to spare is free, below 0.075 mm is contact, however short the dip and wherever the looks fall."""
    arm = ContinuumArm(n_sections=1)
    reach = arm.radius_m + 0.01
    for at_s in np.linspace(0.31, 0.69, 20):
        track = Track(
            times_s=(0.0, at_s, 1.0),
            positions_m=((reach + 0.02, 0, 0.1), (reach + gap_m, 0, 0.1), (reach + 0.02, 0, 0.1)),
        )
        scenario = Scenario(
            id="dip", arm=arm, start_rad=(0, 0), goal_m=(5, 5, 5), obstacles=(Obstacle(radius_m=0.01, motion=track),)
        )
        judged = audit(scenario, [0.0, 0.9], np.zeros((2, 2)))
        assert (judged.swept.violation_kind == Kind.COLLISION) is collides_, at_s


@settings(max_examples=300)
@given(seed=st.integers(0, 2**32 - 1), at=st.floats(0.0, 0.1))
def test_clearance_agrees_with_exact_arcs_and_never_overstates(seed, at):
    motion = random_motion(np.random.default_rng(seed))
    q = random_bending(np.random.default_rng(seed), motion.scenario.arm.n_sections)
    world = sample_world(motion.scenario.obstacles, at, at + 1e-6, 1e-6)
    exact = clearance(motion.scenario.arm, q, at, world)
    ours = audited_clearance(motion.scenario, q, at)
    assert exact - max(8 * MICROMETRE, exact / 6) <= ours <= exact + 1e-3 * MICROMETRE
    assert collides(motion.scenario, q, at) == (ours <= 0.0)


@settings(max_examples=200)
@given(seed=st.integers(0, 2**32 - 1), duration_s=st.floats(0.02, 4.0))
def test_each_verdict_is_stricter_than_the_one_before(seed, duration_s):
    motion = random_motion(np.random.default_rng(seed), duration_s)
    arm = motion.scenario.arm
    goal = tuple(arm.tip(motion.configurations_rad[-1]))
    judged = audit(motion.scenario.model_copy(update={"goal_m": goal}), *motion[1:])
    verdicts = (judged.executable, judged.swept, judged.per_step)
    assert sorted(v.success for v in verdicts) == [v.success for v in verdicts]
    dates = [np.inf if v.success else v.violation_time_s for v in verdicts]
    assert sorted(dates) == dates


def test_a_whole_second_is_looked_at_between_states_that_all_but_meet_there():
    arm = ContinuumArm(n_sections=1)
    crossing = Track(times_s=(0.0, 1.0, 2.0), positions_m=((0.5, 0, 0.1), (0, 0, 0.1), (0, 0.5, 0.1)))
    scenario = Scenario(
        id="meet", arm=arm, start_rad=(0, 0), goal_m=(5, 5, 5), obstacles=(Obstacle(radius_m=0.01, motion=crossing),)
    )
    times = np.array([0.0, 1.0 - 2e-10, 1.0 + 2e-10, 2.0])
    judged = audit(scenario, times, np.zeros((4, 2)))
    assert judged.per_step[1:] == (1.0, Kind.COLLISION)
    assert judged.swept.violation_time_s < 1.0


def test_without_obstacles_everything_is_clear():
    scenario = Scenario(id="empty", start_rad=(0,) * 6, goal_m=(5, 5, 5))
    judged = audit(scenario, [0.0, 3.0], np.zeros((2, 6)))
    assert judged.min_clearance_m == np.inf
    assert not collides(scenario, np.zeros(6), 0.0)


def test_what_cannot_be_proven_in_time_counts_as_contact():
    frantic = Orbit(center_m=(50, 0, 0), radius_m=49.0, normal=(0, 0, 1), rate_rad_s=1e6, phase_rad=0.0)
    scenario = Scenario(
        id="frantic", start_rad=(0,) * 6, goal_m=(5, 5, 5), obstacles=(Obstacle(radius_m=0.02, motion=frantic),)
    )
    assert audit(scenario, [0.0, 60.0], np.zeros((2, 6))).swept.violation_kind == Kind.COLLISION


@pytest.mark.parametrize("shape", [((2,), (3, 6)), ((2, 1), (2, 6)), ((2,), (2, 4))])
def test_shapes_that_do_not_belong_together_are_refused(shape):
    scenario = Scenario(id="empty", start_rad=(0,) * 6, goal_m=(5, 5, 5))
    with pytest.raises(ValueError, match="allowed"):
        audit(scenario, np.zeros(shape[0]), np.zeros(shape[1]))
