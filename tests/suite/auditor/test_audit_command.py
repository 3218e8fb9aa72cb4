import pytest

from scenarios import ContinuumArm, Scenario, save_scenarios
from suite.auditor import trajectory_file
from suite.auditor.command import ENGINES, audit_file
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
        return list(audit_file(trajectories, scenarios, engine))

    return judge_lines


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
    with pytest.raises(SuiteError, match="cannot be read: No such file"):
        trajectory_file.read_trajectories(file, [ONE])
    file.write_bytes(b"\xff\xfe")
    with pytest.raises(SuiteError, match="allowed UTF-8"):
        trajectory_file.read_trajectories(file, [ONE])
    monkeypatch.setattr(trajectory_file, "MAX_FILE_BYTES", 1)
    with pytest.raises(SuiteError, match="found 2 bytes, allowed 1"):
        trajectory_file.read_trajectories(file, [ONE])
