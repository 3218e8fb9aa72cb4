"""A planner that misbehaves in its trials, by setting, and is well-behaved in its warm-up."""

import ctypes
import os
import resource
import signal
import stat
import sys
import threading
import time
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from planners import TimedPath
from planners.base import ArmPlanner

Mode = Literal[
    "raise", "garbage", "half", "close", "exit", "crash", "abort", "print", "count", "spoil", "late", "corrupt"
]


class HostileSettings(BaseModel):
    """What to do."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    mode: Mode = Field(default="raise", description="kind of mischief")


class Hostile(ArmPlanner):
    """Stands still, and does what its setting says."""

    settings_model = HostileSettings
    summary = "mischief, to see what it costs"

    def search(self, q, now_s, stop):
        if not _is_warm_up():
            self._misbehave(self.settings.mode)
        return TimedPath(np.array([now_s, now_s + 1.0]), np.stack([q, q]))

    def _misbehave(self, mode: Mode) -> None:  # noqa: C901  a case is a trick
        match mode:
            case "raise":
                raise ValueError("bad \udc80 name\nwith a \0")
            case "garbage":
                _write(b"\0\0\0\4abcd" * 9)
            case "half":
                _write((1000).to_bytes(8) + b"abc")
                time.sleep(1000)
            case "close":
                os.closerange(3, 256)
                signal.setitimer(signal.ITIMER_REAL, 0)
                time.sleep(1000)
            case "exit":
                os._exit(0)
            case "crash":
                ctypes.string_at(0)
            case "abort":
                os.abort()
            case "print":
                os.write(1, b"\x1b[2J spam" * 100_000)
            case "count":
                self.state_checks = 2**70
            case "spoil":
                resource.setrlimit(resource.RLIMIT_NOFILE, (3, 3))
                os.chdir("/")
            case "late":
                threading.Timer(0.2, os._exit, [7]).start()
            case "corrupt":
                frame = sys._getframe()
                while frame is not None and "task" not in frame.f_locals:
                    frame = frame.f_back
                frame.f_locals["task"].scenario.__dict__["id"] = "stolen,\n=cmd"


def _is_warm_up() -> bool:
    frame = sys._getframe()
    while frame is not None and frame.f_code.co_name != "warm_up":
        frame = frame.f_back
    return frame is not None


def _write(data: bytes) -> None:
    for link in Path("/proc/self/fd").iterdir():
        if link.exists() and stat.S_ISSOCK(link.stat().st_mode):
            os.write(int(link.name), data)
