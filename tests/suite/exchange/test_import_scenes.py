import json
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from scenarios import Box, Still, load_scenarios
from suite.auditor import clearance
from suite.cli.main import main
from suite.exchange.meshes import import_mesh


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)


def scene(**changes: object) -> dict[str, object]:
    turn = [0.0, 0.0, np.sin(0.3), np.cos(0.3)]
    way = [[0.3, 0.01 * k, 0.2, 0.0, 0.0, 0.0, 1.0] for k in range(300)]
    turning = [[0.0, 0.5, 0.5, 0.0, 0.0, np.sin(0.01 * k), np.cos(0.01 * k)] for k in range(300)]
    return {
        "fps": 30,
        "frame_count": 299,
        "start_configuration": [0.0] * 6,
        "obstacles": [
            {"name": "table", "type": "static_box", "dimensions": [1, 2, 0.1], "positions": [[0, 0, -0.5, *turn]]},
            {"name": "ball", "type": "dynamic_sphere", "radius": 0.05, "positions": way},
            {"name": "crate", "type": "dynamic_box", "dimensions": [0.1, 0.1, 0.2], "positions": way},
            {"name": "tumbling", "type": "dynamic_box", "dimensions": [0.1, 0.2, 0.2], "positions": turning},
            {"name": "arm", "type": "dynamic_robot", "trajectory": [[0.0]]},
        ],
    } | changes


def test_a_scene_of_sirrt(capfd) -> None:
    Path("scene task.json").write_text(json.dumps(scene()))
    assert main(["import", "sirrt", "scene task.json", "-o", "made.yaml", "--goal", "0.1,0,0.3"]) == 0
    said = capfd.readouterr().err
    assert "1 robots among the obstacles are left out" in said
    assert "1 boxes turn on their way; each is the sphere that holds it" in said
    (made,) = load_scenarios("made.yaml")
    table, ball, crate, tumbling = made.obstacles
    assert made.id == "scene-task"
    assert isinstance(table.motion, Still)
    assert isinstance(table.shape, Box)
    assert table.shape.rotation_rad == pytest.approx((0.0, 0.0, 0.6))
    times = np.arange(300) / 30 - 5.0
    way = np.array([[0.3, 0.01 * k, 0.2] for k in range(300)])
    for body in (ball, crate):
        assert np.abs(body.position(times) - way).max() < 1e-9
    assert ball.radius_m == 0.05
    assert crate.shape == Box(size_m=(0.1, 0.1, 0.2))
    assert (tumbling.shape, tumbling.radius_m) == (None, pytest.approx(0.15))


BAD_SCENES = {
    "no json": "{",
    "no fps": json.dumps({"obstacles": []}),
    "no radius": json.dumps(scene(obstacles=[{"type": "static_sphere", "positions": [[0, 0, 0, 0, 0, 0, 1]]}])),
    "no pose": json.dumps(scene(obstacles=[{"type": "static_sphere", "radius": 1, "positions": []}])),
    "unknown type": json.dumps(scene(obstacles=[{"type": "torus", "positions": [[0, 0, 0, 0, 0, 0, 1]]}])),
    "no rotation": json.dumps(
        scene(obstacles=[{"type": "static_box", "dimensions": [1, 1, 1], "positions": [[0] * 7]}])
    ),
    "not finite": json.dumps(scene(fps=float("nan"))),
    "deep": "[" * 100_000,
}


@pytest.mark.parametrize("text", BAD_SCENES.values(), ids=BAD_SCENES)
def test_a_bad_scene_is_one_line(text: str, capfd) -> None:
    Path("bad.json").write_text(text)
    assert main(["import", "sirrt", "bad.json", "-o", "made.json"]) == 2
    out, err = capfd.readouterr()
    assert (out, err.count("\n")) == ("", 1)


CUBE = np.array(list(product((0.0, 1.0), repeat=3)))


def facets(points: np.ndarray) -> np.ndarray:
    return points[ConvexHull(points).simplices]


def binary_stl(triangles: np.ndarray) -> bytes:
    record = np.zeros(len(triangles), np.dtype([("n", "<f4", 3), ("c", "<f4", (3, 3)), ("r", "<u2")]))
    record["c"] = triangles
    return b"solid of a kind".ljust(80) + len(triangles).to_bytes(4, "little") + record.tobytes()


def text_stl(triangles: np.ndarray) -> str:
    lines = ["solid s"]
    for triangle in triangles:
        lines += ["facet normal 0 0 0", "outer loop", *(f"vertex {x!r} {y!r} {z!r}" for x, y, z in triangle.tolist())]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid"])


def obj(triangles: np.ndarray) -> str:
    points, index = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    faces = (index.reshape(-1, 3) + 1).tolist()
    corners = [f"v {x!r} {y!r} {z!r}" for x, y, z in points.tolist()]
    return "\n".join([*corners, "vn 0 0 1", *(f"f {a}//1 {b}//1 {c}//1" for a, b, c in faces)])


TWO_CUBES = np.concatenate([facets(CUBE), facets(0.5 * CUBE + (3.0, 0.0, 0.0))])


@pytest.mark.parametrize("write", [binary_stl, text_stl, obj])
def test_each_piece_of_a_mesh_is_its_hull(write) -> None:
    content = write(TWO_CUBES)
    file = Path("cubes.obj" if write is obj else "cubes.stl")
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    assert main(["import", "mesh", str(file), "-o", "made.json", "--unit", "cm", "--offset", "0.2,0,0"]) == 0
    (made,) = load_scenarios("made.json")
    found = [np.array(body.shape.vertices_m) + body.motion.point_m for body in made.obstacles]
    for corners, expected in zip(found, (0.01 * CUBE, 0.005 * CUBE + np.array([0.03, 0.0, 0.0])), strict=True):
        assert np.sort(corners, axis=0) == pytest.approx(
            np.sort(expected + np.array([0.2, 0.0, 0.0]), axis=0), abs=1e-7
        )
    assert np.isfinite(clearance(made, made.start, 0.0))


def test_a_mesh_of_many_corners_holds_them_all_with_few() -> None:
    rng = np.random.default_rng(0)
    points = rng.normal(size=(3000, 3))
    points *= np.array([0.1, 0.2, 0.3]) / np.linalg.norm(points, axis=1, keepdims=True)
    Path("egg.stl").write_bytes(binary_stl(facets(points)))
    (body,) = import_mesh(Path("egg.stl"), 1.0, (0.0, 0.0, 0.0))
    corners = np.array(body.shape.vertices_m) + body.motion.point_m
    assert len(corners) <= 200
    hull = ConvexHull(corners)
    assert (hull.equations[:, :3] @ points.T + hull.equations[:, 3:]).max() < 1e-7
    assert hull.volume < 1.25 * ConvexHull(points).volume


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.stl", b""),
        ("a.stl", b"solid\nvertex 1 2\n"),
        ("a.stl", b"solid\nvertex 1 2 3\n"),
        ("a.stl", binary_stl(TWO_CUBES)[:-10]),
        ("a.stl", binary_stl(np.full((4, 3, 3), np.nan))),
        ("flat.stl", binary_stl(TWO_CUBES * (1, 1, 0))),
        ("huge.stl", binary_stl(TWO_CUBES * 100)),
        ("a.obj", b"v 0 0 0\nf 1 2 3\n"),
        ("a.obj", b"v 0 0 0\nf 0 1 1\n"),
        ("a.ply", b"ply"),
    ],
)
def test_a_bad_mesh_is_one_line(name: str, content: bytes, capfd) -> None:
    Path(name).write_bytes(content)
    assert main(["import", "mesh", name, "-o", "made.json"]) == 2
    out, err = capfd.readouterr()
    assert (out, err.count("\n")) == ("", 1)
