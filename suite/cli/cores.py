"""How many processor cores this process may use."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path, PurePosixPath

CGROUPS = Path("/sys/fs/cgroup")


def cores() -> int:
    """Cores that the system gives this process: those it may run on, and no more than a container's quota."""
    n_cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    with suppress(OSError, ValueError):
        n_cores = min(n_cores, int(_quota(Path("/proc/self/cgroup").read_text(encoding="ascii"), CGROUPS)))
    return max(1, n_cores)


def _quota(memberships: str, cgroups: Path) -> float:
    """The smallest quota [cores] of the control groups in ``/proc/self/cgroup`` and of those they are in.

    Raises:
        ValueError: None of them has one.
    """
    quotas = []
    for line in memberships.splitlines():
        _, controllers, path = line.split(":", 2)
        if controllers and "cpu" not in controllers.split(","):
            continue
        root = cgroups / controllers if controllers else cgroups  # version 1, version 2
        inside = PurePosixPath(path.lstrip("/"))
        for group in (inside, *inside.parents):
            with suppress(OSError, ValueError):  # no such file, or "max"
                quotas.append(_of_group(root / group, is_old=bool(controllers)))
    return min(quotas)


def _of_group(folder: Path, *, is_old: bool) -> float:
    if is_old:
        quota, period = (
            int((folder / f"cpu.cfs_{name}_us").read_text(encoding="ascii")) for name in ("quota", "period")
        )
    else:
        quota, period = map(int, (folder / "cpu.max").read_text(encoding="ascii").split())
    if quota <= 0:
        raise ValueError("no limit")
    return quota / period
