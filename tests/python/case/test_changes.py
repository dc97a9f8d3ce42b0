"""Other numbers need no text: the same case as by text, in microseconds, samples shared."""

import os
from pathlib import Path

import numpy as np
import pytest
import rwmf
from refused import refusals
from rwmf.case import case as case_module
from scenes import block, coupled

_PULSE = {"kind": "sine", "a_max_g": 0.4, "omega_p": 12.0}


def _by_text(case: rwmf.Case, **groups: object) -> rwmf.Case:
    """Return the edited case by way of its text."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(case_module, "numbers_of", lambda _: None)
        return case.replace(**groups)


@pytest.mark.parametrize(
    "groups",
    [
        {"frame": {"T_s": 0.7}, "wall": {"b": 0.4, "h": 2.5}},
        {"Frame": {"t_s": 0.7}},
        {"cable": {"eta_0": 0.3}},
        {"cable": {"eta_alpha": None}},
        {"impact": {"e": 0.8}},
        {"motion": {"omega_p": 9.0, "a_max_g": -0.3, "cycles": 2.0}},
        {"solver": {"max_steps": 100000, "rtol": 1e-8, "verify": True}},
        {"output": {"dt": 0.01, "energy": True}},
        {"model": {"g": 9.8}},
        {"spectrum": {"T_s": [0.5, 0.75], "gamma": (5, 10)}},
        {"spectrum": {"T_s_min": 0.5, "T_s_max": 1.0, "n": 3}},
        {"frame": {"T_s": np.float32(0.5), "gamma": np.int64(3)}},
    ],
)
def test_a_change_is_an_edit(groups: dict[str, dict[str, object]]) -> None:
    case = coupled(motion=_PULSE, solver={"t_end": 2.0}, impact={"e": 0.9})
    changed = case.replace(**groups)
    expected = _by_text(case, **groups)
    assert changed == expected
    assert repr(changed) == repr(expected)
    assert changed.replace(cable=None) == expected.replace(cable=None)
    assert rwmf.Case.from_text(changed.text) == expected
    assert rwmf.simulate(changed).equals(rwmf.simulate(expected))


test_a_change_is_checked = refusals(
    lambda groups: coupled(motion=_PULSE, solver={"t_end": 2.0}).replace(**groups),
    ({"frame": {"T_s": -1.0}}, "&frame: T_s = -1.0: must be a number > 0"),
    ({"frame": {"T_s": np.nan}}, "&frame: T_s = nan: must be a number > 0"),
    ({"frame": {"Ts": 1.0}}, "unknown key, did you mean T_s"),
    ({"frame": {"T_s": True}}, "must be a number > 0"),
    ({"frame": {"T_s": "1"}}, "must be a number > 0"),
    ({"frame": {"T_s": [1.0, 2.0]}}, "must be one value"),
    ({"solver": {"max_steps": 1.5}}, "must be an integer >= 1"),
    ({"wall": {"h": None}}, "the key h is missing"),
    ({"motion": {"v_p": 1.0}}, "v_p = 1.0: must not be given beside a_max_g"),
    ({"fram": {"T_s": 1.0}}, "there is no group &fram, did you mean frame"),
)


def _resident_bytes() -> int:
    pages = Path("/proc/self/statm").read_text(encoding="utf-8").split()[1]
    return int(pages) * os.sysconf("SC_PAGE_SIZE")


def test_a_change_is_cheap_however_long_the_record() -> None:
    """Five hundred changes of a record of 200,000 samples would hold 1.6 GB if each copied it."""
    motion = rwmf.Motion(np.sin(np.arange(200000) * 0.1), dt=0.01, unit="g")
    case = block().replace(motion=motion, solver={"t_end": 1.0})
    chain = case
    chain.replace(wall={"h": 2.0})
    kept = []
    before = _resident_bytes()
    for i in range(250):
        chain = chain.replace(wall={"h": 2.0 + 1e-6 * i})
        kept += [chain, case.replace(motion={"scale": 1.0 + 1e-6 * i})]
    assert _resident_bytes() - before < 1e8
    assert chain.wall.h == 2.0 + 1e-6 * 249
    assert float(rwmf.simulate(chain).theta_max_over_alpha) > 0
