"""No standard call takes more than 3 % above its recorded instructions (developer/bench.md)."""

import shutil

import pytest
from instruction_counts.__main__ import REFERENCE
from instruction_counts.calls import NAMES
from instruction_counts.ledger import Ledger
from instruction_counts.measure import Measured, measure, setting_of_build


@pytest.fixture(scope="module")
def recorded() -> Ledger:
    """Read the counts of the repository."""
    return Ledger.read(REFERENCE)


@pytest.fixture(scope="module")
def measured(recorded: Ledger) -> Measured:
    """Count once the calls whose recorded counts can be met: those of Python depend on more."""
    if not shutil.which("valgrind"):
        pytest.skip("no valgrind, which counts instructions (apt-get install valgrind)")
    setting = setting_of_build()
    return measure([name for name in NAMES if not recorded.differences(setting, name)])


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_call_has_not_grown(name: str, recorded: Ledger, measured: Measured) -> None:
    if differences := recorded.differences(measured.setting, name):
        pytest.skip("; ".join(differences))
    lines = recorded.grown({name: measured.counts[name]})
    assert not lines, lines[0]


def test_every_call_is_recorded_and_no_other(recorded: Ledger) -> None:
    assert list(recorded.counts) == list(NAMES)
