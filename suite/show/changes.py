"""A comparison of two runs in words: what got worse, what can't be told, what got better, what stayed."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator
from typing import Any

import pandas as pd
from tabulate import tabulate

from suite.compare.gate import Comparison, Finding, Judgement
from suite.show.text import as_csv

_HEADINGS = {
    Judgement.REGRESSION: "Worse",
    Judgement.INCONCLUSIVE: "Can't be told",
    Judgement.BETTER: "Better",
    Judgement.NON_INFERIOR: "Shown to have lost no more than the margin",
    Judgement.UNCHANGED: "Unchanged: equal rows but for timings, no test",
    Judgement.NOT_JUDGED: "Times, for information only",
}
_TITLES = {
    "state_checks": "state checks",
    "motion_checks": "motion checks",
    "n_solves": "solves",
    "arrival_time_s": "arrival s",
    "tip_path_length_m": "tip path m",
    "smoothness_paper_rad": "S rad",
    "planning_time_s": "planning s",
    "solve_p50_s": "solve s",
}


def as_text(found: Comparison) -> str:
    """For a terminal: a small table under each heading, 80 columns for labels of usual length."""
    return "\n".join([*_parts(found, "simple"), f"{conclusion(found)}\n"])


def as_markdown(found: Comparison) -> str:
    """For a page, such as the summary of a job."""
    return "\n".join([f"**{conclusion(found)}**\n", *_parts(found, "github")])


def as_json(found: Comparison) -> str:
    """Everything, with full numbers; null for what there is not."""
    said = {
        "conclusion": conclusion(found),
        "bar": vars(found.bar) | {"across": list(found.bar.across)},
        "counts": {str(judgement): len(found.of(judgement)) for judgement in Judgement},
        "findings": [{name: _plain(value) for name, value in row.items()} for row in found.frame.to_dict("records")],
        "missing": list(found.missing),
        "differing": list(found.differing),
    }
    return json.dumps(said, indent=2, allow_nan=False) + "\n"


FORMATS: dict[str, Callable[[Comparison], str]] = {
    "text": as_text,
    "markdown": as_markdown,
    "json": as_json,
    "csv": lambda found: as_csv(found.frame),
}


def conclusion(found: Comparison) -> str:
    """One sentence."""
    worse, unclear = found.of(Judgement.REGRESSION), found.of(Judgement.INCONCLUSIVE)
    if worse:
        return f"Regression: {', '.join(_named(finding) for finding in worse)}."
    if unclear:
        return f"No regression found; can't be told of {', '.join(_named(finding) for finding in unclear)}."
    return "No regression."


def _parts(found: Comparison, style: str) -> Iterator[str]:
    bar = found.bar
    yield (
        f"Success ({bar.verdict.replace('_', ' ')}) may lose {bar.margin:g} points, costs {bar.cost_margin:g} %;"
        f" risk {100 * bar.alpha:g} %, intervals {100 - 200 * bar.alpha:g} %.\n"
    )
    for judgement, heading in _HEADINGS.items():
        findings = found.of(judgement)
        if judgement == Judgement.UNCHANGED:  # then so is every cost
            findings = [finding for finding in findings if finding.quantity == "success"]
        if findings:
            yield f"{heading}:\n\n{_table(findings, found.keys, style)}\n"
    for heading, lines in (("No partner", found.missing), ("Pairs differ in", found.differing)):
        if lines:
            yield f"{heading}:\n\n" + "".join(f"- {line}\n" for line in lines)


def _table(findings: list[Finding], keys: tuple[str, ...], style: str) -> str:
    several = len({finding.family for finding in findings}) > 1
    values = list(zip(*(finding.conditions for finding in findings), strict=True))
    varied = [k for k in range(len(keys)) if len({str(value) for value in values[k]}) > 1]
    # A planner's own conditions vary from planner to planner; they say something only where one planner has several.
    labels = {(finding.family, finding.planner, finding.quantity) for finding in findings}
    varied = varied if len(labels) < len(findings) else []
    rows = [
        [
            *([finding.family] if several else []),
            finding.planner,
            *(str(finding.conditions[k]) for k in varied),
            _TITLES.get(finding.quantity, "success %"),
            str(finding.pairs),
            f"{finding.base:.3g}",
            f"{finding.new:.3g}",
            _change(finding),
            *_evidence(finding),
        ]
        for finding in findings
    ]
    titles = [*(["family"] if several else []), "planner", *(keys[k] for k in varied)]
    titles += ["what", "pairs", "base", "new", "change", "p"]
    return tabulate(rows, titles, tablefmt=style, disable_numparse=True)


def _change(finding: Finding) -> str:
    unit = "" if finding.only_base is not None else " %"
    if math.isnan(finding.low):
        return f"{finding.change:+.1f}{unit}"
    return f"{finding.change:+.1f}{unit} [{finding.low:+.1f}, {finding.high:+.1f}]"


def _evidence(finding: Finding) -> list[str]:
    if finding.judgement in (Judgement.UNCHANGED, Judgement.NOT_JUDGED):
        return ["-"]
    p = finding.p_better if finding.judgement == Judgement.BETTER else finding.p_worse
    return [f"{p:.2g}"]


def _named(finding: Finding) -> str:
    what = _TITLES.get(finding.quantity, "success").removesuffix(" %")
    return f"{finding.planner} {what}"


def _plain(value: Any) -> Any:
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if value is pd.NA:
        return None
    return value.item() if hasattr(value, "item") else value
