"""The tube of section 1 against its twin, and the hulls that stand for shapes against signed distances."""

import numpy as np
import pytest
from hypothesis import given, settings
from just_missed import just_missed, random_arm
from shapes import KINDS, random_shape
from strategies import seeds
from twins.section_tube import tube as twin_tube
from twins.shapes import signed_distance

from scenarios import ContinuumArm, Line, Obstacle, Scenario, clearances, sample_world
from scenarios.proofs import Bound, _kernels, sections
from scenarios.proofs.allowance import STRAY_RAD, Allowance
from scenarios.proofs.cells import POINTS, Cells, cells_of
from scenarios.proofs.hulls import pack_hulls
from scenarios.proofs.section import SectionTube
from scenarios.proofs.sections import SectionsTube

LONG_S = 1e3


def compare(scenario: Scenario, per_radius: int, spread: float) -> tuple[int, int]:
    """Sum over steps of the cells that the twin has dropped, and of those that only one of both has."""
    arm, steps = scenario.arm, 8
    cells: Cells = cells_of(arm.section_length_m, arm.max_bend_rad, per_radius)
    rate = Allowance.of(arm).rate_rad_s
    step_s = spread * cells.edge_rad / rate
    hulls = pack_hulls(scenario.obstacles, arm.radius_m, scenario.time_limit_s)
    tube = SectionTube(scenario.model_copy(update={"time_limit_s": LONG_S}), hulls, Bound(0.0, np.inf), cells, step_s)
    tube._from_start_m[:] = tube._from_goal_m[:] = -np.inf  # of start and goal the twin knows nothing
    far = len(cells.middles_rad) // 2
    dropped = odd = 0
    for alive in twin_tube(scenario, cells.edge_rad, far, step_s, steps, POINTS, (rate, STRAY_RAD)):
        mine = {tuple(cell) for cell in np.argwhere(tube.alive) - far}
        assert alive <= mine, "cells dropped that are not hit"
        dropped += np.count_nonzero(cells.allowed) - len(alive)
        odd += len(alive ^ mine)
        tube.advance()
    return dropped, odd


@settings(max_examples=4)
@given(seeds)
def test_the_tube_among_spheres_is_its_twins(seed: int) -> None:
    rng = np.random.default_rng(seed)
    solved = just_missed(rng, random_arm(rng), 8)
    if solved:
        dropped, odd = compare(solved.scenario, int(rng.integers(6, 14)), rng.uniform(0.5, 6.0))
        assert odd <= 1e-3 * dropped


def test_the_tube_among_shapes_is_nearly_its_twins() -> None:
    rng = np.random.default_rng(5)
    dropped = odd = 0
    for _ in range(3):
        solved = just_missed(rng, random_arm(rng), 4, shapes=True)
        if solved:
            more = compare(solved.scenario, 8, 2.0)
            dropped, odd = dropped + more[0], odd + more[1]
    assert dropped > 500
    assert odd < 0.05 * dropped  # within a shape the twin's distance is negative, and a cylinder's hull is smaller


@pytest.mark.parametrize("kind", KINDS)
def test_a_hull_is_never_nearer_than_its_shape_and_hardly_farther(kind: str) -> None:
    rng = np.random.default_rng(2)
    for _ in range(40):
        shape = random_shape(rng, kind)
        obstacle = Obstacle(shape=shape, motion=Line(point_m=(0.0, 0.0, 0.0), velocity_m_s=(0.0, 0.0, 0.0)))
        hulls = pack_hulls([obstacle], 0.02, 1.0)
        point = rng.normal(size=3) * 0.1
        true = float(signed_distance(shape, point[None])[0])
        radius = hulls.reaches_m[0] - 0.02
        upper, lower = (bound - radius for bound in _kernels.hull_distance(hulls, 0, *point, 0.0))
        assert upper >= true - 1e-9
        if kind != "cylinder" and true > 0.0:
            assert lower <= true + 1e-9
        if true > 0.0:
            assert upper <= true + 3e-3
        for enough in (0.5 * max(true, 0.0) + radius + 1e-6, 1.2 * max(true, 0.0) + radius + 4e-3):
            early, far = _kernels.hull_distance(hulls, 0, *point, enough)
            assert early - radius >= true - 1e-9
            if upper < 1e-3:
                continue  # a point inside may come out as next to the surface
            assert (early < enough) == (upper + radius < enough)
            assert (far >= enough) == (upper + radius >= enough)


@pytest.mark.parametrize("rad", [0.0, 0.05, 0.1, 0.17, 0.33])
def test_offsets_are_those_of_cells_that_come_as_near(rad: float) -> None:
    cells = cells_of(0.15, np.pi, 31)
    edge = cells.edge_rad
    found = {tuple(offset) for offset in cells.offsets(rad)}
    for i in range(-9, 10):
        for j in range(-9, 10):
            gap = edge * np.hypot(max(abs(i) - 1, 0), max(abs(j) - 1, 0))
            assert ((i, j) in found) == (gap <= rad), (i, j)


@pytest.mark.parametrize("seed", range(6))
def test_bends_of_a_pair_of_cells_that_is_dropped_are_hit(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sections, "PER_RADIUS", 5)
    rng = np.random.default_rng(seed)
    places = rng.normal(size=(4, 3))
    places *= rng.uniform(0.14, 0.25, size=(4, 1)) / np.linalg.norm(places, axis=1, keepdims=True)
    motions = [Line(point_m=tuple(place), velocity_m_s=(0.0, 0.0, 0.0)) for place in places]
    scenario = Scenario(
        id="full",
        arm=ContinuumArm(n_sections=3, radius_m=0.03),
        start_rad=(0.0,) * 6,
        goal_m=(0.0, 0.0, 0.4),
        obstacles=tuple(Obstacle(radius_m=rng.uniform(0.06, 0.09), motion=motion) for motion in motions),
    )
    tube = SectionsTube(scenario, pack_hulls(scenario.obstacles, 0.03, 1.0), Bound(0.0, np.inf))
    # All that the first look leaves out of all there is; start and goal apart.
    tube._rest_m = tube.first._rest_m = np.inf
    tube.alive[:] = True
    tube.first.alive = tube.first.cells.allowed.copy()
    tube.first._until_s[:] = tube._until_s[:] = -1.0
    tube.first._drop()
    tube._strike()
    coarse = cells_of(0.15, np.pi, 5)
    middles = coarse.middles_rad[np.argwhere(coarse.allowed)]
    dropped = np.argwhere(~tube.alive)
    assert 300 < len(dropped) < tube.alive.size
    picked = dropped[rng.integers(len(dropped), size=20_000)]
    # Corners count most: anywhere in the cells, more often near their rims.
    inside = 0.5 * coarse.edge_rad * np.sign(rng.normal(size=(20_000, 4))) * rng.uniform(size=(20_000, 1)) ** 0.2
    bends = middles[picked].reshape(-1, 4) + inside
    bends = bends[(np.linalg.norm(bends.reshape(-1, 2, 2), axis=2) <= np.pi).all(axis=1)]
    world = sample_world(scenario.obstacles, 0.0, 1.0, 1.0)
    gaps = clearances(ContinuumArm(n_sections=2, radius_m=0.03), bends, 0.0, world)
    assert gaps.max() < 0.0
    assert gaps.max() > -0.02  # and some hardly
