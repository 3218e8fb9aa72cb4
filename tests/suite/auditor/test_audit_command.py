import csv
import json
import math

import pytest

from scenarios import ContinuumArm, Obstacle, Orbit, Scenario, UserError, save_scenarios
from suite.auditor import audit as audit_one
from suite.auditor import trajectory_file
from suite.auditor.command import ENGINES, audit_file
from suite.auditor.report import COLUMNS, as_csv, as_json, as_text
from suite.cli.main import main
from suite.errors import SuiteError

HEADER = "scenario_id,planner,time_s,u1_rad,v1_rad,u2_rad,v2_rad"
ONE = Scenario(id="one", arm=ContinuumArm(n_sections=1), start_rad=(0, 0), goal_m=(0, 0, 0.15))
TWO = Scenario(id="two", arm=ContinuumArm(n_sections=2), start_rad=(0,) * 4, goal_m=(1, 1, 1))


@pytest.fixture
def judge(tmp_path):
    scenarios, trajectories = tmp_path / "two.yaml", tmp_path / "trajectories.csv"
    save_scenarios(scenarios, [ONE, TWO])

    def judge_lines(*lines, engine="certificate"):
        trajectories.write_text("\n".join(lines) + "\n", encoding="utf-8")
        return list(as_text(audit_file(trajectories, scenarios, engine)))

    return judge_lines


@pytest.fixture
def files(tmp_path):
    """Two trajectories, of which one is sound in every way, and their scenarios."""
    orbiting = Orbit(center_m=(0.05, 0.02, 0.1), radius_m=0.03, normal=(0, 0, 1), rate_rad_s=0.3, phase_rad=0.1)
    near = Scenario(
        id="near",
        arm=ContinuumArm(n_sections=1),
        start_rad=(0, 0),
        goal_m=tuple(ContinuumArm(n_sections=1).tip([1.0, 0.0])),
        obstacles=(Obstacle(radius_m=0.02, motion=orbiting),),
    )
    scenarios, trajectories = tmp_path / "scenarios.yaml", tmp_path / "trajectories.csv"
    save_scenarios(scenarios, [ONE, near])
    one_section = HEADER[: -len(",u2_rad,v2_rad")]
    lines = [one_section, "one,pf,0,0,0", 'near,"rrt[a=1,b=2]",0,0,0', 'near,"rrt[a=1,b=2]",7,1,0']
    trajectories.write_text("\n".join(lines) + "\n")
    return trajectories, scenarios


def test_rows_hold_full_numbers_and_all_formats_the_same(files):
    found = list(audit_file(*files))
    judged = audit_one(found[1].trajectory.scenario, [0.0, 7.0], [[0.0, 0.0], [1.0, 0.0]])
    rows = json.loads("".join(as_json(found)))
    assert [tuple(row) for row in rows] == [COLUMNS, COLUMNS]
    first, second = rows
    assert (first["scenario_id"], first["planner"], first["success_executable"]) == ("one", "pf", True)
    assert (first["arrival_time_s"], first["min_clearance_m"]) == (0.0, None)  # there is nothing to be clear of
    assert second["scenario_hash"] == found[1].trajectory.scenario.content_hash
    assert second["min_clearance_m"] == judged.min_clearance_m
    assert second["violation_swept_time_s"] == judged.swept.violation_time_s
    assert (second["success_per_step"], second["success_swept"]) == (judged.per_step.success, False)
    assert second["violation_swept_kind"] == "collision"
    assert second["end_time_s"] == judged.end_time_s

    cells = list(csv.DictReader(as_csv(found)))
    assert len(cells) == len(rows)
    for row, line in zip(rows, cells, strict=True):
        for name, value in row.items():
            if name == "min_clearance_m" and value is None:
                assert float(line[name]) == math.inf
            else:
                assert line[name] == ("" if value is None else str(value)), name


def test_formats_and_exit_codes_of_the_command(files, tmp_path, capsys):
    arguments = ["audit", *map(str, files)]
    assert main(arguments) == 0
    assert capsys.readouterr().out.splitlines() == list(as_text(audit_file(*files)))
    assert main([*arguments, "--format", "csv", "--strict"]) == 1  # one of them collides
    assert capsys.readouterr().out.splitlines() == list(as_csv(audit_file(*files)))
    assert main([*arguments, "--format", "json"]) == 0
    assert len(json.loads(capsys.readouterr().out)) == 2
    sound = tmp_path / "sound.csv"
    sound.write_text("".join(files[0].read_text().splitlines(keepends=True)[:2]))
    assert main(["audit", str(sound), str(files[1]), "--strict"]) == 0


@pytest.mark.parametrize(
    "text", ["\ufeff{0}\n{1}\n", "{0}\n{1}\n\n", "{0}\n{1}\n \n", "\ufeff{0}\r\n{1}\r\n,,,,,,\r\n"]
)
def test_a_byte_order_mark_and_a_blank_last_line_are_no_mistake(tmp_path, text):
    scenarios, trajectories = tmp_path / "two.json", tmp_path / "trajectories.csv"
    save_scenarios(scenarios, [ONE, TWO])
    trajectories.write_bytes(text.format(HEADER, "two,pf,0,0,0,0,0").encode())
    scenarios.write_bytes("\ufeff".encode() + scenarios.read_bytes() + b"\n\n")
    (only,) = audit_file(trajectories, scenarios)
    assert only.trajectory.times_s.tolist() == [0.0]


STANDS_TWICE = {
    "one state": ["one,pf,0,0,0,,"] * 2,
    "behind one another": ["one,pf,0,0,0,,", "one,pf,1,0.1,0,,", "one,pf,2,0.2,0,,"] * 2,
    "another way": ["one,pf,0,0,0,,", "one,pf,1,0.1,0,,", "one,pf,0,0,0,,", "one,pf,1,0.3,0,,"],
    "apart": ["one,pf,0,0,0,,", "one,pf,1,0.1,0,,", "two,pf,0,0,0,0,0", "one,pf,0,0,0,,", "one,pf,1,0.1,0,,"],
    "with fewer digits": ["one,pf,0,0,0,,", "one,pf,1,0.1,0,,", "one,pf,0.0,1e-9,0,,"],
}


@pytest.mark.parametrize("lines", STANDS_TWICE.values(), ids=STANDS_TWICE)
def test_a_trajectory_that_stands_twice_is_refused(judge, lines):
    with pytest.raises(SuiteError, match=r"line \d: found 'one pf' beginning again, allowed once per file"):
        judge(HEADER, *lines)


LIES = {
    "backward to another time": ["one,pf,0,0,0,,", "one,pf,2,0,0,,", "one,pf,1,0,0,,"],
    "two places at the first instant": ["one,pf,0,0,0,,", "one,pf,0,0.5,0,,"],
    "a state twice on the way": ["one,pf,0,0,0,,", "one,pf,1,0,0,,", "one,pf,1,0,0,,"],
    "no time at all": ["one,pf,nan,0,0,,", "one,pf,nan,0,0,,"],
}


@pytest.mark.parametrize("lines", LIES.values(), ids=LIES)
def test_whatever_else_times_do_is_for_the_audit_to_judge(judge, lines):
    assert len(judge(HEADER, *lines)) == 1


@pytest.mark.parametrize("engine", ENGINES)
def test_every_trajectory_gets_its_line_however_the_file_mixes_them(judge, engine):
    lines = judge(HEADER, "two,rrt[range=3],0,0,0,0,0", "one,pf,0,0,0,,", "two,rrt[range=3],1,0,0,nan,0", engine=engine)
    failed = "not finite at 0.000 s"
    assert lines == [
        f"two rrt[range=3]: per step {failed}, swept {failed}, executable {failed}; never arrives; clearance inf mm",
        "one pf: per step ok, swept ok, executable ok; arrives at 0.000 s; clearance inf mm",
    ]


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (["time_s,u1_rad"], "line 1: found columns 'time_s,u1_rad', allowed scenario_id,planner,time_s,u1_rad"),
        ([""], "line 1: found columns"),
        ([HEADER], "found no timed state"),
        ([HEADER, "one,pf,0,0"], "line 2: found 4 cells, allowed 7"),
        ([HEADER, "three,pf,0,0,0,,"], "line 2: scenario_id: found 'three', allowed a scenario of the file: one, two"),
        ([HEADER, "one,,0,0,0,,"], "line 2: planner: found '', allowed"),
        ([HEADER, "one,pf,0,0,0,,", "one,pf,1,x,0,,"], "line 3: u1_rad: found 'x', allowed a number"),
        ([HEADER, "one,pf,soon,0,0,,"], "line 2: time_s: found 'soon', allowed a number"),
        ([HEADER, "two,pf,0,0,0,,"], "line 2: u2_rad: found '', allowed a number"),
        ([HEADER, "one,pf,0,0,0,1,"], "line 2: u2_rad: found '1', allowed nothing"),
        ([HEADER[: -len(",u2_rad,v2_rad")], "two,pf,0,0,0"], "line 2: found columns for 1 sections, allowed at least"),
        ([HEADER, "one,pf,0," + "9" * 200_000 + ",0,,"], "not valid CSV: field larger than field limit"),
    ],
)
def test_a_file_that_does_not_fit_is_refused_in_one_line(judge, lines, message):
    with pytest.raises(SuiteError) as error:
        judge(*lines)
    assert message in str(error.value)
    assert "\n" not in str(error.value)
    assert len(str(error.value)) < 400


def test_unknown_engine_lists_the_known_ones(judge):
    with pytest.raises(SuiteError, match="found 'bullet', allowed certificate, fcl"):
        judge(HEADER, engine="bullet")


def test_files_that_cannot_be_read_are_refused(tmp_path, monkeypatch):
    file = tmp_path / "there.csv"
    with pytest.raises(UserError, match="cannot be read: No such file"):
        trajectory_file.read_trajectories(file, [ONE])
    file.write_bytes(b"\xff\xfe")
    with pytest.raises(UserError, match="allowed UTF-8"):
        trajectory_file.read_trajectories(file, [ONE])
    monkeypatch.setattr(trajectory_file, "MAX_FILE_BYTES", 1)
    with pytest.raises(UserError, match="found 2 bytes, allowed 1"):
        trajectory_file.read_trajectories(file, [ONE])
