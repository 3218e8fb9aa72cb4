"""How much memory a process and its children have for themselves; Linux tells."""

from __future__ import annotations

import sys
from contextlib import suppress
from pathlib import Path

CAN_BE_MEASURED = sys.platform == "linux"
_PRIVATE = ("RssAnon:", "RssShmem:")
"""What libraries and tables map from files is shared by all workers, and not a planner's."""


def private_mb(process: int) -> float:
    """Memory of a process and its descendants [MB]; what has ended meanwhile has none."""
    total_kb, pending = 0, [process]
    while pending:
        folder = Path(f"/proc/{pending.pop()}")
        with suppress(OSError):
            lines = (folder / "status").read_text(encoding="utf-8", errors="replace").splitlines()
            total_kb += sum(int(line.split()[1]) for line in lines if line.startswith(_PRIVATE))
            for task in (folder / "task").iterdir():
                pending += map(int, (task / "children").read_text(encoding="ascii").split())
    return total_kb / 1000
