"""Shared fixtures: paths, the batch program, the records."""

from __future__ import annotations

import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib
import matplotlib.pyplot as plt
import pytest
from browser import chromium
from checkout import BATCH, Runner, run_command, run_words
from may_skip import pytest_make_collect_report, pytest_runtest_makereport  # noqa: F401
from rwmf import records

if TYPE_CHECKING:
    from playwright.sync_api import Browser

matplotlib.use("Agg")
# a shell gives its background jobs a SIGINT that is ignored, nohup a SIGHUP, and they give it on:
# tests of interrupts would wait in vain
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGHUP, signal.SIG_DFL)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Begin with the files that take long."""
    slow: dict[Path, set[str]] = {}
    for item in items:
        if item.get_closest_marker("slow"):
            slow.setdefault(item.path, set()).add(item.nodeid.partition("[")[0])
        if "browser" in getattr(item, "fixturenames", ()):
            slow.setdefault(item.path, set()).add("browser")
    # a process of pytest-xdist: otherwise the last one works alone on a long file
    if hasattr(config, "workerinput"):
        items.sort(key=lambda item: -len(slow.get(item.path, ())))


@pytest.fixture(autouse=True)
def _closed_figures() -> Iterator[None]:
    """Close the figures of a test: a process that collects them runs out of memory."""
    yield
    plt.close("all")


@pytest.fixture(scope="session")
def record_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Export the textbook record of El Centro and the near-fault record of Pacoima Dam."""
    folder = tmp_path_factory.mktemp("records")
    for name in ("elcentro", "pacoima"):
        records.export(name, folder / f"{name}.csv")
    return folder


@pytest.fixture(scope="session")
def elcentro(record_folder: Path) -> Path:
    """El Centro."""
    return record_folder / "elcentro.csv"


@pytest.fixture(scope="session")
def pacoima(record_folder: Path) -> Path:
    """Pacoima Dam."""
    return record_folder / "pacoima.csv"


@pytest.fixture(scope="session")
def batch_program() -> Path:
    """Find the batch program of the build; RWMF_BATCH names another one."""
    assert BATCH.is_file(), f"{BATCH} is missing: run tools/test, or set RWMF_BATCH"
    return BATCH


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """Run chromium for a file: playwright keeps an event loop, which other files must not meet."""
    with chromium() as running:
        yield running


@pytest.fixture
def batch(batch_program: Path, tmp_path: Path) -> Runner:
    """Run the batch program in the test's folder."""

    def run(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
        return run_words([batch_program, *arguments], tmp_path)

    return run


@pytest.fixture
def command(tmp_path: Path) -> Runner:
    """Run the command rwmf in the test's folder, in this process."""

    def run(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
        return run_command(list(arguments), tmp_path)

    return run
