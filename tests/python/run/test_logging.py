"""The logger "rwmf": silent by default, start and end of public functions, warnings."""

import logging
from pathlib import Path

import numpy as np
import pytest
import rwmf
from checkout import run_python
from scenes import coupled

MOTION = rwmf.Motion(0.3 * np.sin(np.arange(200) * 0.1), dt=0.02, unit="g", name="one")


def _logged(caplog: pytest.LogCaptureFixture) -> list[tuple[str, str]]:
    assert {record.name for record in caplog.records} <= {"rwmf"}
    return [(item.levelname, item.getMessage().split(" after ")[0]) for item in caplog.records]


def test_analyses_are_recorded_with_their_parts(caplog: pytest.LogCaptureFixture) -> None:
    """The function that the user calls ends at level INFO, those that it calls at DEBUG."""
    with caplog.at_level(logging.DEBUG, logger="rwmf"):
        rwmf.stripes(coupled().replace(motion=MOTION), [MOTION], levels=[0.1, 0.2])
    found = [item for item in _logged(caplog) if not item[1].startswith("warning: ")]
    assert found[0] == ("DEBUG", "stripes: started")
    assert ("DEBUG", "sweep: finished") in found
    assert found[-1] == ("INFO", "stripes: finished")
    assert [item for item in found if item[0] == "INFO"] == [found[-1]]


def test_warnings_and_failures_are_recorded(caplog: pytest.LogCaptureFixture) -> None:
    case = coupled().replace(motion={"a_max_g": 30.0})
    with caplog.at_level(logging.INFO, logger="rwmf"):
        with pytest.warns(rwmf.RwmfWarning) as caught:
            rwmf.simulate(case)
        with pytest.raises(rwmf.InputError):
            rwmf.simulate("missing.nml")
    found = _logged(caplog)
    assert ("INFO", f"warning: {caught[0].message}".split(" after ")[0]) in found
    assert found[-1] == ("INFO", "simulate: failed")


def test_time_loops_of_hosts_stay_below_info(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.DEBUG, logger="rwmf"):
        rwmf.Wall(coupled()).next_event(0.01)
    found = _logged(caplog)
    assert ("DEBUG", "Wall.next_event: finished") in found
    assert not [text for level, text in found if level == "INFO" and text.startswith("Wall")]


def test_nothing_is_printed_without_a_handler(tmp_path: Path) -> None:
    found = run_python("from rwmf.errors import LOG; LOG.error('shown')", tmp_path)
    assert (found.returncode, found.stdout, found.stderr) == (0, "", "")
