"""Pages of replays: what ``suite show`` writes or opens."""

from __future__ import annotations

import difflib
import os
import tempfile
import webbrowser
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from scenarios import load_scenarios
from suite.errors import SuiteError
from suite.progress import note
from suite.show.page import page
from suite.show.replay.again import play
from suite.show.replay.chosen import choose
from suite.show.replay.data import scenario_data, trial_data

BEFORE_S = 2.0
"""A page opens so long before the first violation."""


class Made(NamedTuple):
    """A page, and what a terminal says of it."""

    text: str
    story: list[str]
    remarks: list[str]


def replay_page(folder: Path, scenario_id: str | None, planners: Sequence[str]) -> Made:
    """Trials of a run on one scenario, side by side.

    Raises:
        SuiteError, SpecError, ScenarioError: There is no such run, scenario or planner; one line.
    """
    chosen = choose(folder, scenario_id, planners)
    scenario = chosen.scenario
    took_s = sum(trial.row["trial_wall_s"] or 0.0 for trial in chosen.trials)
    note(f"playing again what took {took_s:.1f} s in the run; the first time, kernels have to be compiled")
    played = [play(folder, scenario, trial, planners) for trial in chosen.trials]
    end_s = max(float(each.executed.times_s[-1]) for each in played)
    trials = [trial_data(scenario, each) for each in played]
    violated = [
        each.row["violation_swept_time_s"] for each in played if each.row["violation_swept_kind"] == "collision"
    ]
    data = {
        "kind": "replay",
        "run": folder.name,
        "scenario": scenario_data(scenario, end_s),
        "trials": trials,
        "end": end_s,
        "open": max(0.0, min(violated) - BEFORE_S) if violated else 0.0,
    }
    story = [f"{trial['planner']}: {' '.join(trial['story'])}" for trial in trials]
    remarks = [f"shown is {chosen.why}"] if chosen.why else []
    remarks += [f"{trial['planner']}: {trial['remark']}" for trial in trials if trial["remark"]]
    if chosen.left_out:
        remarks.append(f"not shown for lack of room: {', '.join(chosen.left_out)}; name planners with --planner")
    return Made(page(f"{scenario.id} of {folder.name}", data), story, remarks)


def scenario_page(file: Path, scenario_id: str | None) -> Made:
    """A scenario of a file, the first unless one is named: the arm at its start while the obstacles move.

    Raises:
        ScenarioError, SuiteError: The file cannot be read, or holds no such scenario.
    """
    scenarios = {scenario.id: scenario for scenario in load_scenarios(file)}
    wanted = scenario_id or next(iter(scenarios))
    if wanted not in scenarios:
        near = difflib.get_close_matches(wanted[:100], scenarios, 1) or list(scenarios)
        raise SuiteError(f"--scenario: found {wanted!r}, allowed one of {len(scenarios)} in {file}; nearest: {near[0]}")
    scenario = scenarios[wanted]
    end_s = scenario.time_limit_s
    data = {"kind": "replay", "run": file.name, "scenario": scenario_data(scenario, end_s), "trials": [], "end": end_s}
    others = f"; {len(scenarios) - 1} more in {file}" if len(scenarios) > 1 and scenario_id is None else ""
    words = f"{scenario.id}: {len(scenario.obstacles)} obstacles{others}"
    return Made(page(scenario.id, data | {"open": 0.0}), [words], [])


def open_page(text: str) -> str:
    """Write a page to a temporary file and open it in the browser; returns a line that says where it is."""
    handle, name = tempfile.mkstemp(suffix=".html", prefix="suite-")
    with os.fdopen(handle, "w", encoding="utf-8") as file:
        file.write(text)
    opened = webbrowser.open(Path(name).as_uri())
    return name if opened else f"{name} (found no browser to open it)"
