"""Tests that may be skipped when everything is to be tested.

With RWMF_MUST_RUN=1, as `.ci/run` sets it, every other skip is a failure: a package that went
missing would take its tests along unseen.
"""

import os
from collections.abc import Generator
from typing import TypeVar

import pytest

# file, a part of the reason, why that is no loss
MAY_SKIP = (
    ("test_instruction_counts.py", "counts are of", "they hold for one processor and interpreter"),
    ("test_sweep_engines.py", "'mpi4py'", "not in the lock: it needs the MPI of the machine"),
    ("test_sweep_engines.py", "no MPI on this machine", "the same"),
    ("test_validation.py", "'mujoco'", "its stored histories are compared in any case"),
    (
        "test_opensees.py",
        "no OpenSees",
        "each script is read in any case; stored histories as well",
    ),
    ("test_obspy.py", "'obspy'", "not in the lock; stand-ins of its traces run in any case"),
    ("test_coupling.py", "no OpenSees", "its stored errors are checked in any case"),
    ("test_laws.py", "no OpenSees", "its laws are held against closed forms in any case"),
    ("test_files.py", "only root can", "giving files away is tested where it can be done"),
    ("test_files.py", "strace may not trace here", "containers may not"),
)
_Report = TypeVar("_Report", pytest.TestReport, pytest.CollectReport)
_WHERE = "tests/support/may_skip.py lists what may be"


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport() -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Turn the skip of a test into a failure where it must run."""
    return _judge((yield))


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report() -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    """Turn the skip of a whole file into a failure where it must run."""
    return _judge((yield))


def _judge(report: _Report) -> _Report:
    if not (report.skipped and os.environ.get("RWMF_MUST_RUN") == "1"):
        return report
    reason = str(report.longrepr[2] if isinstance(report.longrepr, tuple) else report.longrepr)
    if not any(file in report.nodeid and part in reason for file, part, _ in MAY_SKIP):
        report.outcome = "failed"
        report.longrepr = f"{report.nodeid} must not be skipped ({_WHERE}): {reason}"
    return report
