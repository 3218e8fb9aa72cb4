"""A share of ``make fuzz``."""

from pathlib import Path

import pytest

from fuzz.__main__ import fuzz


def test_whatever_a_file_holds_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    read, found = fuzz(1500, 7, tmp_path)
    assert not found.lines
    assert sum(count for name, count in read.items() if not name.endswith(", taken")) == 1500
    assert sum(name.endswith(", taken") for name in read) > 5
