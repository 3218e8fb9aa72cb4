"""What kind of place a folder is in, and who is at work there."""

from __future__ import annotations

import errno
import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from suite.errors import SuiteError

LOCK = ".lock"
"""Locked where a folder itself cannot be."""
_REMOTE = ("nfs", "cifs", "smb", "lustre", "gpfs", "beegfs", "ceph", "afs", "9p", "fuse.sshfs", "fuse.gluster", "pvfs")


def is_remote(folder: Path) -> bool:
    """Whether other machines may have the folder as well; where the system does not tell, it is taken for local."""
    try:
        mounts = Path("/proc/self/mountinfo").read_text(encoding="utf-8", errors="surrogateescape")
    except OSError:
        return False
    return file_system(folder.resolve(), mounts).startswith(_REMOTE)


def file_system(folder: Path, mounts: str) -> str:
    """Type of the file system that holds ``folder``, by the text of ``/proc/self/mountinfo``; empty if unknown."""
    found = ("", "")
    for line in mounts.splitlines():
        mount, _, source = line.partition(" - ")
        place = mount.split(" ")[4].encode("latin-1", "surrogateescape").decode("unicode_escape")
        if folder.is_relative_to(place) and len(place) >= len(found[0]):
            found = place, source.split(" ")[0]
    return found[1]


@contextmanager
def held(folder: Path) -> Iterator[None]:
    """Hold a lock on the folder; it goes with the process, however that ends.

    Raises:
        SuiteError: Another process holds it.
    """
    handle = os.open(folder, os.O_RDONLY)
    try:
        try:
            _lock(handle, fcntl.LOCK_EX)
        except OSError as error:
            if error.errno != errno.EBADF:
                raise
            os.close(handle)  # NFS locks nothing that is open for reading alone
            handle = os.open(folder / LOCK, os.O_RDWR | os.O_CREAT, 0o666)
            _lock(handle, fcntl.LOCK_EX)
        yield
    except BlockingIOError:
        raise SuiteError(f"{folder}: another process is running in it, allowed: one at a time") from None
    finally:
        os.close(handle)


def is_held(folder: Path) -> bool:
    """Whether a process holds the folder."""
    for place in (folder / LOCK, folder):
        with suppress(FileNotFoundError):
            handle = os.open(place, os.O_RDONLY)
            try:
                _lock(handle, fcntl.LOCK_SH)
            except BlockingIOError:
                return True
            finally:
                os.close(handle)
    return False


def _lock(handle: int, kind: int) -> None:
    fcntl.flock(handle, kind | fcntl.LOCK_NB)
