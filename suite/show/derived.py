"""The files that are made from the journal, whole and anew each time."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TextIO

import numpy as np
import pandas as pd

from scenarios import Scenario
from suite.compare.conditions import telling_apart
from suite.compare.tables import summarize
from suite.files import replacing, write_text
from suite.show.text import as_csv, as_markdown_page
from suite.store.frames import FLOAT_FORMAT, trials_csv, trials_frame
from suite.store.journal import Executed, Journal
from suite.trial.task import Code


def write_derived(
    folder: Path, journal: Journal, scenarios: Sequence[Scenario], present: Mapping[str, Code]
) -> pd.DataFrame:
    """Write trials, tables, scenarios and trajectories.

    Args:
        folder: The run's folder.
        journal: The run's journal.
        scenarios: The run's scenarios.
        present: The code of every planner by label, in the order in which the tables show them.

    Returns:
        The summary that stands in ``table.csv``.
    """
    trials = trials_frame(journal.rows())
    summary = summarize(trials, list(present), present)
    write_text(folder / "trials.csv", trials_csv(trials))
    write_text(folder / "table.csv", as_csv(summary))
    write_text(folder / "table.md", as_markdown_page(folder.name, summary))
    with replacing(folder / "scenarios.jsonl") as handle:
        handle.writelines(f"{scenario.model_dump_json()}\n" for scenario in scenarios)
    with replacing(folder / "trajectories.csv") as handle:
        telling = telling_apart(trials)
        n_sections = max(s.arm.n_sections for s in scenarios)
        _write_trajectories(handle, journal.executed(), telling, n_sections)
    return summary


def _write_trajectories(handle: TextIO, executed: Iterable[Executed], telling: Sequence[str], n_sections: int) -> None:
    """One line per timed state; arms with fewer sections leave the last columns empty.

    Where a planner met a scenario more than once, a column says under which of the ``telling`` conditions.
    """
    writer = csv.writer(handle, lineterminator="\n")
    bends = [f"{axis}{section}_rad" for section in range(1, n_sections + 1) for axis in "uv"]
    writer.writerow(["scenario_id", "planner", *(["condition"] if telling else []), "time_s", *bends])
    for trial in executed:
        timed = np.column_stack([trial.times_s, trial.configurations_rad])
        # One format for a whole trial: thousands of states are written in the time that cells would take for hundreds.
        names = io.StringIO()
        condition = ";".join(f"{name}={trial.conditions[name]}" for name in telling)
        named = [trial.scenario_id, trial.planner, *([condition] if telling else [])]
        csv.writer(names, lineterminator="").writerow(named)
        numbers = [FLOAT_FORMAT] * timed.shape[1] + [""] * (1 + len(bends) - timed.shape[1])
        line = ",".join([names.getvalue().replace("%", "%%"), *numbers]) + "\n"
        handle.write(line * len(timed) % tuple(timed.reshape(-1).tolist()))
