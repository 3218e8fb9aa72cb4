"""Several runs as one: seeds, planners and machines put together in a folder of their own."""

from __future__ import annotations

import json
import sqlite3
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from scenarios import FileError, PackedScenarios, Scenario, ScenarioError, load_scenarios
from suite.errors import SuiteError
from suite.experiment.experiment import make_experiment
from suite.experiment.manifest import Manifest
from suite.files import write_text
from suite.progress import note
from suite.show.derived import write_derived
from suite.store.journal import Journal
from suite.store.run_folder import JOURNAL, MANIFEST, present_codes, read_manifest
from suite.store.union import Union, unite
from suite.trial.columns import SCHEMA_VERSION

SHOWN = 5
"""Conflicts that are named; the others are counted."""


def merge_runs(folders: Sequence[Path], out: Path, *, keep_first: bool = False) -> None:
    """Put runs together in ``out``; they themselves are only read.

    Args:
        folders: Of the runs, each with its journal, which may be damaged.
        out: Made; an empty folder will do.
        keep_first: Where two runs have different rows for one trial by the same code, let that of the first stand.

    Raises:
        SuiteError: A run cannot be read, two are in conflict, or ``out`` holds something. Then nothing is written.
    """
    _refuse(folders, out)
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=out.parent, prefix=f".{out.name}.") as draft:
            _merge_into(Path(draft), folders, keep_first=keep_first)
            out.mkdir(exist_ok=True)
            for file in Path(draft).iterdir():
                file.rename(out / file.name)
    except (OSError, sqlite3.Error) as error:
        raise SuiteError(f"{out}: cannot be written: {getattr(error, 'strerror', None) or error}") from None


def _refuse(folders: Sequence[Path], out: Path) -> None:
    resolved = [folder.resolve() for folder in folders]
    for k, folder in enumerate(resolved):
        if folder in resolved[:k]:
            raise SuiteError(f"{folders[k]}: found twice, allowed once")
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise SuiteError(f"{out}: found something there, allowed: a new or an empty folder")


def _merge_into(draft: Path, folders: Sequence[Path], *, keep_first: bool) -> None:
    """Journal, manifest and what is derived from them."""
    union = unite(folders, draft / JOURNAL)
    if union.conflicts and not keep_first:
        more = f"; {len(union.conflicts) - SHOWN} more" if len(union.conflicts) > SHOWN else ""
        raise SuiteError(
            f"found {len(union.conflicts)} trials with different rows by the same code: "
            f"{'; '.join(union.conflicts[:SHOWN])}{more}; --keep-first lets those of the run named first stand"
        )
    for line in (*union.notes, *union.code_notes(), *(f"{line}; the first stands" for line in union.conflicts[:SHOWN])):
        note(line)
    manifests = [read_manifest(folder) or {} for folder in folders]
    manifest = _manifest(manifests, union)
    with Journal(draft / JOURNAL) as journal:
        journal.ask(union.chosen, None)
        hashes = {row["scenario_hash"] for row in journal.rows()}
        scenarios = PackedScenarios(_scenarios(folders, manifests, hashes))
        if not scenarios:
            raise SuiteError(f"{folders[0]}: found no scenario of its trials, allowed: a run with its scenarios.jsonl")
        manifest["scenarios"] = {"count": len(scenarios), "hash": scenarios.digest}
        write_text(draft / MANIFEST, json.dumps(manifest, indent=2) + "\n")
        write_derived(draft, journal, scenarios, present_codes(manifest))


def _manifest(manifests: Sequence[Manifest], union: Union) -> Manifest:
    """The last run's, with the planners of all and, if there is one, the experiment that asks for all."""
    last = manifests[-1]
    codes = {planner: counter.most_common(1)[0][0] for planner, counter in union.planner_codes.items()}
    houses = [code.house for code in codes.values()]
    kept = {part: value for part, value in last.items() if part in ("sources", "versions", "machine")}
    merged = [{key: value for key, value in manifest.items() if key != "merged"} for manifest in manifests]
    return {
        "schema_version": SCHEMA_VERSION,
        "experiment": _experiment([manifest.get("experiment", {}) for manifest in manifests]),
        **kept,
        "code": {
            "house": (last.get("code") or {}).get("house") or max(houses, key=houses.count),
            "planners": {planner: code.planner for planner, code in codes.items()},
        },
        "merged": merged,
    }


def _experiment(parts: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """The experiment that asks for what all ask for; empty if there is none.

    Conditions are crossed with one another, so runs may differ in one of them, in seeds for example; planners and
    obstacles they may have more of, and trials too: what the others lack is what is missing of the whole.
    """
    united = dict(parts[0])
    swept = set[str]()
    for part in parts[1:]:
        for field in {*united, *part}:
            ours, theirs = united.get(field), part.get(field)
            if field == "trials" and isinstance(ours, int) and isinstance(theirs, int):
                united[field] = max(ours, theirs)
            elif ours != theirs:
                values = [*_listed(ours), *_listed(theirs)]
                united[field] = [value for k, value in enumerate(values) if value not in values[:k]]
                swept |= {field} - {"planners", "obstacles"}
    return united if len(swept) <= 1 and _is_one(united) else {}


def _listed(value: Any) -> list[Any]:
    return value if isinstance(value, list) else [value]


def _is_one(fields: dict[str, Any]) -> bool:
    """Whether an experiment can be made of the fields; not every field takes several values."""
    try:
        make_experiment(**fields)
    except (ValueError, TypeError):
        return False
    return True


def _scenarios(folders: Sequence[Path], manifests: Sequence[Manifest], wanted: Iterable[str]) -> Iterator[Scenario]:
    """The scenarios of the merged trials, each once, from the runs' files or drawn anew as their manifests say."""
    left, ids = set(wanted), dict[str, str]()
    for folder, manifest in zip(folders, manifests, strict=True):
        for scenario in _of_run(folder, manifest):
            if scenario.content_hash in left:
                left.remove(scenario.content_hash)
                if ids.setdefault(scenario.id, scenario.content_hash) != scenario.content_hash:
                    raise SuiteError(
                        f"{folder}: found {scenario.id} with another content than before, allowed the same"
                    )
                yield scenario
    if left:
        note(f"{len(left)} scenarios are in no scenarios.jsonl and can't be drawn anew: their trials are there without")


def _of_run(folder: Path, manifest: Manifest) -> list[Scenario]:
    """All of a run's scenarios; an unfinished run has not written them yet."""
    try:
        return load_scenarios(folder / "scenarios.jsonl")
    except (FileError, ScenarioError):
        try:
            return list(make_experiment(**manifest.get("experiment", {})).scenarios())
        except (ValueError, TypeError):
            return []
