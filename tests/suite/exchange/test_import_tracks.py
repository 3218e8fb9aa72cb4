"""A made-up file in each layout gives scenarios whose tracks are the file's."""

from pathlib import Path

import numpy as np
import pytest

from scenarios import Scenario, load_scenarios
from suite.cli.main import main
from suite.trial.observation import Observer

RNG = np.random.default_rng(7)
TIMES = 12.5 + 0.04 * np.arange(500)
WAYS = {"3": RNG.uniform(-0.3, 0.3, (500, 3)), "17": RNG.uniform(-0.3, 0.3, (500, 3))}


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)


def imported(text: str, options: str = "", name: str = "walk.csv") -> list[Scenario]:
    Path(name).write_text(text)
    assert main(["import", "tracks", name, "-o", "made.jsonl", "--overwrite", *options.split()]) == 0
    return load_scenarios("made.jsonl")


def assert_tracks(scenario: Scenario, ways: list[np.ndarray], times: np.ndarray = TIMES) -> None:
    """Positions at the file's times, of which the sixth second is t = 0."""
    assert len(scenario.obstacles) == len(ways)
    for obstacle, way in zip(scenario.obstacles, ways, strict=True):
        assert np.abs(obstacle.position(times - times[0] - 5.0) - way).max() < 1e-9


def table(ways: dict[str, np.ndarray], scale: float = 1.0, radius: str = "0.05") -> str:
    lines = ["t,id,x,y,z,radius"]
    for k, t in enumerate(TIMES):
        lines += [
            f"{float(t)!r},{name},{','.join(repr(float(scale * x)) for x in way[k])},{radius}"
            for name, way in ways.items()
        ]
    return "\n".join(lines)


def test_a_table() -> None:
    (scenario,) = imported(table(WAYS))
    assert_tracks(scenario, list(WAYS.values()))
    assert {obstacle.radius_m for obstacle in scenario.obstacles} == {0.05}
    assert (scenario.family, scenario.id) == ("tracks", "walk")
    assert not any(obstacle.unseen(np.arange(-5.0, 20.0)).any() for obstacle in scenario.obstacles)


def test_millimetres_and_an_offset() -> None:
    (scenario,) = imported(table(WAYS, 1000.0, "50"), "--unit mm --offset 0.1,0,-0.2")
    assert_tracks(scenario, [way + np.array([0.1, 0.0, -0.2]) for way in WAYS.values()])
    assert scenario.obstacles[0].radius_m == pytest.approx(0.05)


def test_tum() -> None:
    lines = ["# timestamp tx ty tz qx qy qz qw"]
    lines += [
        f"{float(t)!r} {' '.join(repr(float(x)) for x in way)} 0 0 0.6 0.8"
        for t, way in zip(TIMES, WAYS["3"], strict=True)
    ]
    (scenario,) = imported("\n".join(lines), "--radius 0.02", "robot.txt")
    assert_tracks(scenario, [WAYS["3"]])
    assert scenario.obstacles[0].radius_m == 0.02


@pytest.mark.parametrize("columns", [4, 8])
def test_eth_and_ucy(columns: int) -> None:
    frames = 780 + 10 * np.arange(100)
    times, lines = frames / 25.0, []
    for k, frame in enumerate(frames):
        for name, way in WAYS.items():
            x, y, z = map(float, way[k])
            values = [x, y] if columns == 4 else [x, z, y, 0.1, 0.2, 0.3]
            lines.append(f"{float(frame)!r}\t{name}.0\t" + "\t".join(map(repr, values)))
    (scenario,) = imported("\n".join(lines), name="obsmat.txt")
    flat = [way[:100] * ((1, 1, 0) if columns == 4 else (1, 1, 1)) for way in WAYS.values()]
    assert_tracks(scenario, flat, times)


def motive(unit: str, scale: float, lost: range = range(0)) -> str:
    head = f"Format Version,1.23,Take Name,Take 1,Rotation Type,Quaternion,Length Units,{unit},Coordinate Space,Global"
    columns = [
        (kind, name, what, axis)
        for name in WAYS
        for kind, what, axes in (
            ("Rigid Body", "Rotation", "XYZW"),
            ("Rigid Body", "Position", "XYZ"),
            ("Rigid Body", "Mean Marker Error", [""]),
            ("Rigid Body Marker", "Position", "XYZ"),
        )
        for axis in axes
    ]
    rows = [["", "", *(column[k] for column in columns)] for k in (0, 1)]
    rows += [["", "", *(f"id-{name}" for _, name, _, _ in columns)], ["", "", *(column[2] for column in columns)]]
    rows += [["Frame", "Time (Seconds)", *(column[3] for column in columns)]]
    for k, t in enumerate(TIMES - TIMES[0]):
        row = [str(k), repr(float(t))]
        for name in WAYS:
            point = ["", "", ""] if k in lost else [repr(float(scale * x)) for x in WAYS[name][k]]
            row += ["0", "0", "0", "1", *point, "0.0001", "9", "9", "9"]
        rows.append(row)
    return "\n".join([head, "", *(",".join(row) for row in rows)])


@pytest.mark.parametrize(("unit", "scale"), [("Meters", 1.0), ("Millimeters", 1000.0)])
def test_motive(unit: str, scale: float) -> None:
    (scenario,) = imported(motive(unit, scale))
    assert_tracks(scenario, list(WAYS.values()))
    (turned,) = imported(motive(unit, scale), "--up y")
    assert_tracks(turned, [np.column_stack([way[:, 0], -way[:, 2], way[:, 1]]) for way in WAYS.values()])


def test_a_gap_is_unseen_and_the_straight_way_is_true() -> None:
    lost = range(200, 300)  # 8 to 12 s of the file: 3 to 7 s of the scenario
    (scenario,) = imported(motive("Meters", 1.0, lost))
    (first, second) = scenario.obstacles
    for obstacle, way in ((first, WAYS["3"]), (second, WAYS["17"])):
        assert obstacle.unseen(np.arange(-5.0, 15.0)).nonzero()[0].tolist() == [8, 9, 10, 11]
        middle = obstacle.position(np.array([0.5 * (TIMES[199] + TIMES[300]) - TIMES[0] - 5.0]))
        assert middle[0] == pytest.approx(0.5 * (way[199] + way[300]), abs=1e-9)


def test_sensors_report_nothing_in_a_gap() -> None:
    class Sensing:
        (scenario,) = imported(motive("Meters", 1.0, range(200, 300)))
        seed, noise_mm, dropout = 0, 0.0, 0.0

    seen = Observer(Sensing()).until(14.0)
    unseen = np.isnan(seen.positions_m).any(axis=(1, 2))
    assert seen.times_s[unseen].tolist() == [3.0, 4.0, 5.0, 6.0]


def test_a_long_recording_is_cut_into_scenarios() -> None:
    made = imported(table(WAYS), "--every 4 --time-limit-s 6")
    assert [scenario.id for scenario in made] == [f"walk-{k:04d}" for k in range(4)]
    for k, scenario in enumerate(made):
        for obstacle, way in zip(scenario.obstacles, WAYS.values(), strict=True):
            times = TIMES - TIMES[0] - 5.0 - 4.0 * k
            inside = (times >= -5.0) & (times <= 6.0)
            assert np.abs(obstacle.position(times[inside]) - way[inside]).max() < 1e-9


BAD = {
    "empty": "",
    "no header": "1,2,3,4",
    "no column": "id,t,x,y\n1,2,3,4",
    "a word": "id,t,x,y,z\n1,0,0,0,zero",
    "too few": "id,t,x,y,z\n1,0,0,0",
    "twice": "id,t,x,y,z\n1,0,0,0,0\n1,0,1,1,1",
    "no time": "id,t,x,y,z\n1,,0,0,0",
    "infinite": "id,t,x,y,z\n1,0,0,0,inf",
    "far": "id,t,x,y,z\n1,0,0,0,1e9",
    "two radii": "id,t,x,y,z,radius\n1,0,0,0,0,1\n1,1,0,0,0,2",
    "nothing seen": "id,t,x,y,z\n1,0,,,",
    "tum cut short": "0 0 0 0 0 0 0 1\n1 0 0",
    "motive without numbers": "Format Version,1.2\n\nFrame,Time",
    "binary": "\x00\x01\x02",
}


@pytest.mark.parametrize("text", BAD.values(), ids=BAD)
def test_a_bad_file_is_one_line_and_nothing_made(text: str, capfd) -> None:
    Path("bad.csv").write_text(text)
    assert main(["import", "tracks", "bad.csv", "-o", "made.json"]) == 2
    out, err = capfd.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert not Path("made.json").exists()


@pytest.mark.parametrize(
    "options",
    ["--every 0", "--every 1e-9", "--goal 1,2", "--start 1", "--fps 0", "--unit ft", "--arm x=1", "--radius 0"],
)
def test_a_bad_option_is_one_line(options: str, capfd) -> None:
    Path("walk.csv").write_text(table({"1": WAYS["3"]}, radius=""))
    assert main(["import", "tracks", "walk.csv", "-o", "made.json", *options.split()]) == 2
    out, err = capfd.readouterr()
    assert (out, err.count("\n")) == ("", 1)
