"""No standard call takes more than 3 % above its recorded instructions (developer/bench.md)."""

import shutil

import pytest
from instruction_counts.__main__ import REFERENCE
from instruction_counts.calls import NAMES
from instruction_counts.ledger import Ledger
from instruction_counts.measure import Measured, measure, setting_of_build

CALL = "run_tendon"


@pytest.fixture(scope="module")
def recorded() -> Ledger:
    """Read the counts of the repository."""
    return Ledger.read(REFERENCE)


@pytest.fixture(scope="module")
def measured(recorded: Ledger) -> Measured:
    """Count all calls once, where the recorded counts can be met."""
    if not shutil.which("valgrind"):
        pytest.skip("no valgrind, which counts instructions (apt-get install valgrind)")
    # a host depends on less than Python does: where it cannot be compared, nothing can
    _skip_elsewhere(recorded, setting_of_build(), CALL)
    return measure(NAMES)


def _skip_elsewhere(recorded: Ledger, setting: dict[str, str], name: str) -> None:
    differences = recorded.differences(setting, name)
    if differences:
        pytest.skip("; ".join(differences))


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_call_has_not_grown(name: str, recorded: Ledger, measured: Measured) -> None:
    _skip_elsewhere(recorded, measured.setting, name)
    lines = recorded.grown({name: measured.counts[name]})
    assert not lines, lines[0]


def test_every_call_is_recorded_and_no_other(recorded: Ledger) -> None:
    assert list(recorded.counts) == list(NAMES)
