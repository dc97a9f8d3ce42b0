"""Processor time of a computing process, independent of other processes."""

import os
import resource
import subprocess
import time
from pathlib import Path


def compute(process: subprocess.Popen[str] | subprocess.Popen[bytes], seconds: float) -> float:
    """Let a process compute for some time.

    Parameters
    ----------
    process : subprocess.Popen
        The process; it must not end.
    seconds : float
        Least processor time [s].

    Returns
    -------
    float
        Processor time that it has had [s].
    """
    while (had := _spent(process.pid)) < seconds:
        assert process.poll() is None, process.communicate()
        time.sleep(0.02)
    return had


def spent_by_children() -> float:
    """Processor time of all child processes that have ended [s]."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def _spent(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
