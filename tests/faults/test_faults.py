"""A share of ``make faults``."""

from pathlib import Path

from faults.__main__ import Campaign


def test_workers_killed_from_outside_change_no_row(tmp_path: Path) -> None:
    campaign = Campaign(tmp_path, trials=30)
    assert len(campaign.whole) == 30
    campaign.workers_killed(2)
    assert campaign.faults.total() >= 2
    assert not campaign.wrong
