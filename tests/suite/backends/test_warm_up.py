"""The warm-up of real planners: complete, and no more than that."""

import json
import subprocess
import sys
from pathlib import Path

from planners import parse_planner
from scenarios import generate
from suite.backends.job import Part
from suite.backends.local import warm_up
from suite.backends.warm_up import warm_up_parts
from suite.experiment.experiment import make_experiment
from suite.runner import run_experiment
from suite.store.run_folder import read_trials
from suite.trial.task import TrialTask

LOADED_BY_A_TRIAL = """
import json, sys
from numba.core import event
from planners import parse_planner
from scenarios import generate
from suite.backends.local import warm_up
from suite.backends.job import Job
from suite.backends.warm_up import warm_up_parts
from suite.trial.episode import run_trial
from suite.trial.task import TrialTask
from numba.core.dispatcher import Dispatcher

label, limits = sys.argv[1], sys.argv[2] == "limits"
spec = parse_planner(label)
tasks = [TrialTask(s, spec, sys.argv[3], limits, 0) for s in generate("orbit", 2, 2, seed=1000)]
job = Job(run_trial, 60.0, warm_up_parts(tasks))
for part in job.needed_by(tasks[0]):
    assert warm_up(part) is None, part
late, really_compile = [], Dispatcher.compile
def compile(self, signature):
    if tuple(signature) not in self.overloads:
        late.append(self.py_func.__name__)
    return really_compile(self, signature)
Dispatcher.compile = compile
for task in tasks:
    run_trial(task)
print(json.dumps(late))
"""


def late_kernels(planner: str, predictor: str, limits: bool = False) -> list[str]:
    """Kernels that a process has to compile or load in its first trials, after the warm-up."""
    command = [sys.executable, "-c", LOADED_BY_A_TRIAL, planner, "limits" if limits else "", predictor]
    said = subprocess.run(command, check=True, capture_output=True, text=True, cwd=Path(__file__).parents[3])
    found: list[str] = json.loads(said.stdout)
    return found


def test_no_trial_compiles_or_loads_a_kernel() -> None:
    assert late_kernels("rrt", "portfolio") == []
    assert late_kernels("pf", "cubic", limits=True) == []
    assert late_kernels("temporal", "arc", limits=True) == []  # a predictor that is not the planner's own


def parts_for(**predictors: str) -> list[Part]:
    (scenario,) = generate("orbit", 1, 1, seed=1000)
    return warm_up_parts(
        TrialTask(scenario, parse_planner(label), predictor, False, 0) for label, predictor in predictors.items()
    )


def test_predictors_that_no_planner_uses_are_not_compiled() -> None:
    names = [part.name for part in parts_for(pf="cubic")]
    assert names == ["audit", "collision checks", "predictor cubic", "pf"]
    names = [part.name for part in parts_for(pf="cubic", rrt="portfolio")]
    assert {"predictor arc", "predictor gp", "predictor kalman"} <= set(names)


def test_a_planner_that_cannot_be_set_up_fails_alone() -> None:
    (scenario,) = generate("orbit", 1, 1, seed=1000)
    broken = parse_planner("pf")._replace(name="no such planner", label="broken")
    tasks = [TrialTask(scenario, spec, "cubic", False, 0) for spec in (broken, parse_planner("pf"))]
    parts = {part.name: part for part in warm_up_parts(tasks)}
    assert warm_up(parts["pf"]) is None
    failure = warm_up(parts["broken"])
    assert failure is not None
    assert "no such planner" in failure.message


def test_a_run_in_this_process_gives_the_rows_of_one_in_workers(tmp_path: Path) -> None:
    experiment = make_experiment(planners=("pf",), obstacles=(0,), trials=2, seed=1000)
    for workers in (0, 2):
        run_experiment(experiment, tmp_path / str(workers), workers=workers)
    here, there = (read_trials(tmp_path / name).filter(regex="^(?!.*(_p50|_p95|_max|time|wall))") for name in "02")
    assert here.equals(there)
    assert len(here) == 2
