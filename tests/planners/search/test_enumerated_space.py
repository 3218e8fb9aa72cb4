"""The enumerated configuration space: the published workspace, and every configuration in the cube of its tip."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies import ARM
from twins.kinematics import backbone_point

from planners.search import configurations
from planners.search.configurations import EnumeratedSpace, enumerated_space, hexagonal_lattice
from scenarios import ContinuumArm, ScenarioError

COARSE = 1.0


@pytest.fixture(scope="module")
def coarse() -> EnumeratedSpace:
    return enumerated_space(ARM, COARSE)


def test_the_published_workspace_box() -> None:
    space = enumerated_space(ARM, 0.5)
    assert len(space.bends_rad) == 151
    assert len(space.codes) == 151**3 == 3_442_951
    assert np.count_nonzero(np.diff(space.offsets)) == 227_335
    occupied = np.flatnonzero(np.diff(space.offsets))
    index = np.array(np.unravel_index(occupied, (2 * space.half,) * 3)).T
    outermost = occupied[((index == index.min(axis=0)) | (index == index.max(axis=0))).any(axis=1)]
    tips = ARM.tips(np.concatenate([space.configurations(cube) for cube in outermost]))
    low, high = tips.min(axis=0), tips.max(axis=0)
    np.testing.assert_allclose([high[0], -low[0]], 0.4019, atol=1e-4)
    # Rows of the lattice run along x; along y it has no bending vectors, and reaches half a centimetre less.
    np.testing.assert_allclose([high[1], -low[1]], 0.3966, atol=1e-4)
    np.testing.assert_allclose([low[2], high[2]], [-0.2990, 0.45], atol=1e-4)
    # The paper, section V, in metres.
    np.testing.assert_allclose([low[0], high[0]], [-0.4020, 0.4020], atol=0.001)
    np.testing.assert_allclose([low[1], high[1]], [-0.4020, 0.4020], atol=0.006)
    np.testing.assert_allclose([low[2], high[2]], [-0.2995, 0.45], atol=0.002)


@pytest.mark.parametrize(("spacing", "max_bend"), [(0.5, np.pi), (1.0, np.pi), (0.3, 1.0), (3.0, np.pi), (2.0, 1.0)])
def test_a_lattice_is_all_points_of_a_hexagonal_grid_in_the_disc(spacing: float, max_bend: float) -> None:
    points = hexagonal_lattice(spacing, max_bend)
    expected = {
        (round(x, 9), round(y, 9))
        for a in range(-60, 61)
        for b in range(-60, 61)
        for x, y in [(spacing * (a + b / 2), spacing * b * np.sqrt(3) / 2)]
        if np.hypot(x, y) <= max_bend + 1e-12
    }
    assert {tuple(point) for point in (points.round(9) + 0.0).tolist()} == {(x + 0.0, y + 0.0) for x, y in expected}
    assert len(points) == len(expected)


def test_every_configuration_stands_once_in_the_cube_of_its_tip(coarse: EnumeratedSpace) -> None:
    assert sorted(coarse.codes.tolist()) == list(range(37**3))
    cubes = np.repeat(np.arange(len(coarse.offsets) - 1), np.diff(coarse.offsets))
    low = np.array(np.unravel_index(cubes, (2 * coarse.half,) * 3)).T - coarse.half
    tips = ARM.tips(coarse.decode(coarse.codes)) / 0.01
    assert (tips >= low).all()
    assert (tips < low + 1).all()
    for k in np.random.default_rng(0).integers(len(cubes), size=30):
        q = coarse.decode(coarse.codes[[k]])[0]
        np.testing.assert_allclose(backbone_point(q, 0.15, 0.45) / 0.01, tips[k], atol=1e-3)
        assert q.tolist() in coarse.configurations(int(cubes[k])).tolist()


def test_codes_are_digits_first_section_first(coarse: EnumeratedSpace) -> None:
    bends = coarse.bends_rad
    np.testing.assert_array_equal(
        coarse.decode(np.array([(3 * 37 + 5) * 37 + 36]))[0], np.concatenate([bends[3], bends[5], bends[36]])
    )


@given(st.tuples(*[st.floats(-0.45, 0.45)] * 3))
def test_a_point_is_in_its_cube(coarse: EnumeratedSpace, point: tuple[float, float, float]) -> None:
    center = coarse.center_m(coarse.cube_of(np.array(point)))
    assert (np.abs(center - point) <= 0.005 + 1e-12).all()
    assert coarse.cube_of(center) == coarse.cube_of(np.array(point))


@pytest.mark.parametrize("point", [(2.0, 0.1, -0.1), (0.1, -100.0, 0.1), (0.1, -0.1, 0.47), (-3.0, 3.0, 3.0)])
def test_a_point_off_the_grid_is_given_the_nearest_cube(coarse: EnumeratedSpace, point: tuple[float, ...]) -> None:
    center = coarse.center_m(coarse.cube_of(np.array(point)))
    np.testing.assert_allclose(center, np.clip(point, -0.455, 0.455), atol=0.005 + 1e-12)


@pytest.mark.parametrize("n", [1, 2, 4])
def test_arms_of_other_sizes(n: int) -> None:
    arm = ContinuumArm(n_sections=n, section_length_m=0.1, max_bend_rad=2.0)
    space = enumerated_space(arm, 1.5)
    assert len(space.codes) == len(space.bends_rad) ** n
    assert arm.within_bends(space.decode(space.codes)).all()
    cube = space.cube_of(arm.tip(space.decode(space.codes[:1])[0]))
    assert len(space.configurations(cube)) > 0


def test_what_is_found_in_the_cache_is_what_was_put_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SUITE_CACHE_DIR", str(tmp_path))
    fresh = enumerated_space(ARM, COARSE)
    (folder,) = (tmp_path / "configurations").iterdir()
    written = folder.stat().st_mtime_ns
    again = enumerated_space(ARM, COARSE)
    assert folder.stat().st_mtime_ns == written
    for a, b in zip(fresh, again, strict=True):
        np.testing.assert_array_equal(a, b)
    # Another arm, another folder.
    enumerated_space(ContinuumArm(section_length_m=0.14), COARSE)
    assert len(list((tmp_path / "configurations").iterdir())) == 2
    # The body's radius does not matter to where the tip is.
    enumerated_space(ContinuumArm(radius_m=0.01), COARSE)
    assert len(list((tmp_path / "configurations").iterdir())) == 2


@pytest.mark.parametrize(("name", "size"), [("codes", 1000), ("offsets", 200), ("codes", 0)])
def test_what_was_cut_off_is_enumerated_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, size: int
) -> None:
    monkeypatch.setenv("SUITE_CACHE_DIR", str(tmp_path))
    fresh = [np.array(part) for part in enumerated_space(ARM, COARSE)]
    (file,) = (tmp_path / "configurations").rglob(f"{name}.npy")
    file.write_bytes(file.read_bytes()[:size])
    configurations._groups.cache_clear()
    for a, b in zip(fresh, enumerated_space(ARM, COARSE), strict=True):
        np.testing.assert_array_equal(a, b)
    assert file.stat().st_size > size
    assert len(list((tmp_path / "configurations").iterdir())) == 1


def test_a_lattice_too_fine_is_refused_in_one_line() -> None:
    with pytest.raises(ScenarioError, match=r"^spacing_rad: found 0.06 .* take a wider spacing$"):
        enumerated_space(ARM, 0.06)
