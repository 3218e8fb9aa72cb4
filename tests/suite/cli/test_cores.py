"""How many cores there are for workers, by what control groups say."""

from pathlib import Path

import pytest

from suite.cli import cores


@pytest.mark.parametrize(("text", "quota"), [("50000 100000", 0.5), ("150000 100000", 1.5), ("400000 100000", 4.0)])
def test_a_quota_of_version_two(tmp_path: Path, text: str, quota: float) -> None:
    (tmp_path / "a" / "b").mkdir(parents=True)
    (tmp_path / "a" / "cpu.max").write_text(text)
    (tmp_path / "a" / "b" / "cpu.max").write_text("max 100000")
    assert cores._quota("0::/a/b\n", tmp_path) == quota


def test_a_quota_of_version_one_and_none(tmp_path: Path) -> None:
    folder = tmp_path / "cpu,cpuacct" / "a"
    folder.mkdir(parents=True)
    (folder / "cpu.cfs_quota_us").write_text("200000")
    (folder / "cpu.cfs_period_us").write_text("100000")
    assert cores._quota("4:cpu,cpuacct:/a\n3:memory:/b\n", tmp_path) == 2.0
    (folder / "cpu.cfs_quota_us").write_text("-1")
    with pytest.raises(ValueError, match="empty"):
        cores._quota("4:cpu,cpuacct:/a\n", tmp_path)


def test_half_a_core_is_one_worker(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cores, "_quota", lambda memberships, cgroups: 0.5)
    assert cores.cores() == 1
