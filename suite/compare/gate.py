"""Whether a change made planners worse: two runs judged in pairs, with a stated margin and a stated risk.

Success is judged by non-inferiority. What solutions cost is compared on the scenarios that both solve. Wall-clock times
are reported and never judged. docs/compare.md says how often the gate is wrong, and how that was measured.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any

import numpy as np
import pandas as pd

from suite.compare.costs import COSTS, COUNTS, TIMES, compare_costs, geometric_mean
from suite.compare.matching import BASE, NEW, match, same_rows
from suite.compare.statistics import holm, mcnemar_worse_p, tango_interval
from suite.errors import SuiteError


class Judgement(StrEnum):
    """What can be said of one quantity of one planner."""

    REGRESSION = "regression"
    INCONCLUSIVE = "inconclusive"
    BETTER = "better"
    NON_INFERIOR = "non-inferior"
    UNCHANGED = "unchanged"
    NOT_JUDGED = "not judged"


@dataclass(frozen=True)
class Finding:
    """One quantity of one planner, in one family under one set of conditions."""

    family: str
    planner: str
    conditions: tuple[object, ...]
    quantity: str
    pairs: int
    """Pairs that it was compared on: for costs the scenarios that both solve."""
    base: float
    """Success in percent, or a geometric mean."""
    new: float
    change: float
    """Percentage points of success, or percent by which the geometric mean has changed."""
    low: float = np.nan
    """Interval of the change, with the risk alpha on each side: Tango's for success, bootstrap for costs."""
    high: float = np.nan
    only_base: int | None = None
    """Pairs in which only the base succeeds; None for costs."""
    only_new: int | None = None
    p_worse: float = 1.0
    """Corrected by Holm over all planners and families and, for costs, quantities: worse, for costs by the margin."""
    p_better: float = 1.0
    is_within_margin: bool = False
    """Whether it is shown that no more than the margin was lost."""
    judgement: Judgement = Judgement.NOT_JUDGED


@dataclass(frozen=True)
class Bar:
    """What the gate is asked to hold a run to."""

    margin: float = 5.0
    """Loss of success that may be, in percentage points."""
    alpha: float = 0.05
    """Risk of calling planners that are as good as before a regression: once for success over all planners and
    families, once for all costs."""
    cost_margin: float = 10.0
    """Change of a cost or count that makes no difference, in percent."""
    verdict: str = "executable"
    """Which success is judged."""
    across: Collection[str] = field(default=())
    """Conditions in which the rows of a pair may differ."""

    def __post_init__(self) -> None:
        """Refuse numbers out of range."""
        for name, most in (("margin", 100.0), ("alpha", 0.5), ("cost_margin", 1000.0)):
            if not 0.0 < (value := getattr(self, name)) <= most:
                raise SuiteError(f"--{name.replace('_', '-')}: found {value:g}, allowed above 0, up to {most:g}")


@dataclass(frozen=True)
class Comparison:
    """What two runs say about a change."""

    findings: tuple[Finding, ...]
    """None when nothing could be paired."""
    keys: tuple[str, ...]
    """Names of the ``conditions`` of a finding."""
    missing: tuple[str, ...]
    """Trials of one run that have no partner in the other, a line each."""
    differing: tuple[str, ...]
    """Settings and conditions in which pairs differ, a line each."""
    bar: Bar

    def of(self, judgement: Judgement) -> list[Finding]:
        """The findings of one kind."""
        return [finding for finding in self.findings if finding.judgement == judgement]

    @property
    def frame(self) -> pd.DataFrame:
        """One row per finding; conditions are columns."""
        rows: list[dict[str, Any]] = []
        for finding in self.findings:
            values = dict(vars(finding))
            named = {name: values.pop(name) for name in ("family", "planner")}
            rows.append(named | dict(zip(self.keys, values.pop("conditions"), strict=True)) | values)
        return pd.DataFrame(rows)


def compare_runs(base: pd.DataFrame, new: pd.DataFrame, bar: Bar) -> Comparison:
    """Judge the trials of a run against those of another, planner by planner, in each family, under like conditions.

    Args:
        base: Frame of trial rows.
        new: The same, of what is held against it.
        bar: Margins and risk.

    Raises:
        SuiteError: The bar names an unknown condition.
    """
    matched = match(base, new, bar.across)
    success, costs, times = [], [], []
    for (family, planner, *conditions), pairs in matched.groups:
        about = Finding(str(family), str(planner), tuple(conditions), "success", 0, np.nan, np.nan, 0.0)
        is_unchanged = bool(same_rows(pairs).all())
        success += list(_success(about, pairs, bar, is_unchanged))
        costs += list(_costs(about, pairs, bar, (*COUNTS, *COSTS), is_unchanged))
        times += list(_costs(about, pairs, bar, TIMES, is_unchanged=False))
    findings = (*_judged(success, bar), *_judged(costs, bar), *times)
    return Comparison(findings, matched.keys, matched.missing, matched.differing, bar)


def judge_success(only_base: int, only_new: int, pairs: int, bar: Bar) -> Judgement:
    """Judge one planner by itself from counts of pairs; with several, p-values are corrected first."""
    (finding,) = _judged([_of_counts(_NOBODY, only_base, only_new, pairs, bar)], bar)
    return finding.judgement


_NOBODY = Finding("", "", (), "success", 0, np.nan, np.nan, 0.0)


def _judged(findings: Iterable[Finding], bar: Bar) -> list[Finding]:
    """Correct the p-values of those that were tested, and judge."""
    drafts = list(findings)
    tested = [k for k, finding in enumerate(drafts) if finding.judgement == Judgement.NOT_JUDGED]
    worse = holm([drafts[k].p_worse for k in tested])
    better = holm([drafts[k].p_better for k in tested])
    for k, p_worse, p_better in zip(tested, worse, better, strict=True):
        corrected = replace(drafts[k], p_worse=p_worse, p_better=p_better)
        drafts[k] = replace(corrected, judgement=_judgement(corrected, bar.alpha))
    return drafts


def _judgement(finding: Finding, alpha: float) -> Judgement:
    if finding.p_worse <= alpha and not finding.is_within_margin:
        return Judgement.REGRESSION
    if finding.p_better <= alpha:
        return Judgement.BETTER
    return Judgement.NON_INFERIOR if finding.is_within_margin else Judgement.INCONCLUSIVE


def _success(about: Finding, pairs: pd.DataFrame, bar: Bar, is_unchanged: bool) -> Iterator[Finding]:
    name = f"success_{bar.verdict}"
    judged = pairs.dropna(subset=[name + BASE, name + NEW])
    if judged.empty:
        return
    base, new = judged[name + BASE].astype(bool), judged[name + NEW].astype(bool)
    about = replace(about, base=100.0 * base.mean(), new=100.0 * new.mean())
    if is_unchanged:
        yield replace(about, pairs=len(judged), only_base=0, only_new=0, judgement=Judgement.UNCHANGED)
    else:
        yield _of_counts(about, int((base & ~new).sum()), int((new & ~base).sum()), len(judged), bar)


def _of_counts(about: Finding, only_base: int, only_new: int, pairs: int, bar: Bar) -> Finding:
    low, high = tango_interval(only_base, only_new, pairs, 1.0 - 2.0 * bar.alpha)
    return replace(
        about,
        pairs=pairs,
        change=100.0 * (only_new - only_base) / pairs,
        low=100.0 * low,
        high=100.0 * high,
        only_base=only_base,
        only_new=only_new,
        p_worse=mcnemar_worse_p(only_base, only_new),
        p_better=mcnemar_worse_p(only_new, only_base),
        is_within_margin=100.0 * low > -bar.margin,
    )


def _costs(
    about: Finding, pairs: pd.DataFrame, bar: Bar, names: Iterable[str], is_unchanged: bool
) -> Iterator[Finding]:
    """Quantities on the scenarios that both solve; none where nothing is solved by both."""
    solved = [pairs[f"success_{bar.verdict}{side}"].fillna(False).astype(bool) for side in (BASE, NEW)]
    both = pairs[solved[0] & solved[1]]
    for name in names:
        known = both.dropna(subset=[name + BASE, name + NEW])
        base, new = (known[name + side].to_numpy(np.float64) for side in (BASE, NEW))
        if name not in COUNTS:  # a motion of no length, say: it has no ratio
            base, new = base[(base > 0) & (new > 0)], new[(base > 0) & (new > 0)]
        if not len(base):
            continue
        named = replace(about, quantity=name, pairs=len(base))
        if is_unchanged:
            mean = geometric_mean(base, is_count=name in COUNTS)
            yield replace(named, base=mean, new=mean, judgement=Judgement.UNCHANGED)
            continue
        change = compare_costs(base, new, bar.cost_margin / 100.0, bar.alpha, is_count=name in COUNTS)
        finding = replace(
            named,
            base=change.base,
            new=change.new,
            change=100.0 * (change.ratio - 1.0),
            low=100.0 * (change.low - 1.0),
            high=100.0 * (change.high - 1.0),
        )
        if name in TIMES:
            yield finding
        else:
            is_within = change.p_within <= bar.alpha
            yield replace(finding, p_worse=change.p_worse, p_better=change.p_better, is_within_margin=is_within)
