"""The folder of a server: removed when it ends, or by the next one if it has been killed."""

from __future__ import annotations

import fcntl
import os
import shutil
import tempfile
from contextlib import suppress
from pathlib import Path

__all__ = ["Folder"]

_PREFIX = "rwmf-explore-"


class Folder:
    """A new temporary folder, locked for as long as this process lives.

    The lock is on the folder itself, and the system releases it with the process. A folder without
    a lock therefore belongs to a server that was killed.
    """

    def __init__(self) -> None:
        self._lock: int | None = None
        for left in Path(tempfile.gettempdir()).glob(f"{_PREFIX}*"):
            lock = _locked(left)
            if lock is not None:
                _remove(left, lock)
        while self._lock is None:
            # another server may take a folder without a lock for one that was left behind
            self.path = Path(tempfile.mkdtemp(prefix=_PREFIX))
            self._lock = _locked(self.path)

    def remove(self) -> None:
        """Remove the folder with its content; a second call does nothing."""
        if self._lock is not None:
            _remove(self.path, self._lock)
            self._lock = None


def _locked(path: Path) -> int | None:
    """Lock a folder of this user.

    Returns
    -------
    int or None
        Descriptor that holds the lock; None if there is no such folder, or it is in use.
    """
    try:
        found = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    except OSError:
        return None
    with suppress(OSError):
        if os.fstat(found).st_uid == os.geteuid():
            fcntl.flock(found, fcntl.LOCK_EX | fcntl.LOCK_NB)
            # it may have been removed between opening and locking
            if os.path.samestat(os.fstat(found), os.lstat(path)):
                return found
    os.close(found)
    return None


def _remove(path: Path, lock: int) -> None:
    shutil.rmtree(path, ignore_errors=True)
    os.close(lock)
