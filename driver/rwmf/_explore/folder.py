"""Temporary folder of a server, removed at its end, or by the next server after a crash."""

from __future__ import annotations

import fcntl
import os
import shutil
import tempfile
from contextlib import suppress
from pathlib import Path

_PREFIX = "rwmf-explore-"


class Folder:
    """A new temporary folder, locked until this process ends.

    The operating system releases the lock of the folder with the process. A folder without a lock
    therefore belongs to a terminated server.
    """

    def __init__(self) -> None:
        self._lock: int | None = None
        for left in Path(tempfile.gettempdir()).glob(f"{_PREFIX}*"):
            lock = _locked(left)
            if lock is not None:
                _remove(left, lock)
        while self._lock is None:
            # between creation and lock another server may take the folder for an abandoned one
            self.path = Path(tempfile.mkdtemp(prefix=_PREFIX))
            self._lock = _locked(self.path)

    def remove(self) -> None:
        """Remove the folder with its contents; further calls have no effect."""
        if self._lock is not None:
            _remove(self.path, self._lock)
            self._lock = None


def _locked(path: Path) -> int | None:
    """Lock a folder of this user."""
    try:
        found = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    except OSError:
        return None
    with suppress(OSError):
        if os.fstat(found).st_uid == os.geteuid():
            fcntl.flock(found, fcntl.LOCK_EX | fcntl.LOCK_NB)
            # another process may have removed it before the lock
            if os.path.samestat(os.fstat(found), os.lstat(path)):
                return found
    os.close(found)
    return None


def _remove(path: Path, lock: int) -> None:
    shutil.rmtree(path, ignore_errors=True)
    os.close(lock)
