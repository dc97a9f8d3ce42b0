"""Traces of ObsPy as motions: unit from the argument or the processing, doubtful samples refused.

The texts of `processing` are those that ObsPy 1.4 writes.
"""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import rwmf
from refused import refusals

A = np.sin(np.arange(50) * 0.3)
_REMOVED = (
    "ObsPy 1.4.1: remove_response(fig=None::inventory=<Inventory\n object>::output='{}'::"
    "plot=False::taper=True::water_level=60::zero_mean=True)"
)
_INTEGRATED = "ObsPy 1.4.1: integrate(method='cumtrapz')"
_DIFFERENTIATED = "ObsPy 1.4.1: differentiate(method='gradient')"


def _trace(data: Any = A, *steps: str, **header: object) -> SimpleNamespace:  # noqa: ANN401
    stats: dict[str, object] = {"delta": 0.01, "npts": len(data)} | header
    if steps:
        stats["processing"] = list(steps)
    return SimpleNamespace(data=data, stats=SimpleNamespace(**stats), id="IV.ARS1..HNN")


def test_a_trace_is_a_motion() -> None:
    expected = rwmf.Motion(A, dt=0.01, unit="g", name="IV.ARS1..HNN")
    assert rwmf.Motion.from_obspy(_trace(), "g") == expected
    assert rwmf.Motion.from_obspy([_trace()], "g") == expected
    single = A.astype(np.float32)
    named = rwmf.Motion.from_obspy(_trace(np.ma.masked_array(single)), "cm/s2", name="north")
    assert named == rwmf.Motion(single, dt=0.01, unit="cm/s2", name="north")


@pytest.mark.parametrize(
    "steps",
    [
        ("ObsPy 1.4.1: detrend(options={}::type='linear')", _REMOVED.format("ACC")),
        (_REMOVED.format("VEL"), _DIFFERENTIATED),
        (_REMOVED.format("ACC"), _INTEGRATED, _DIFFERENTIATED),
    ],
)
def test_processing_states_the_unit(steps: tuple[str, ...]) -> None:
    assert rwmf.Motion.from_obspy(_trace(A, *steps)).unit == "m/s2"
    # samples over g leave no trace in the processing
    assert rwmf.Motion.from_obspy(_trace(A, *steps), "g").unit == "g"


test_doubtful_traces_are_refused = refusals(
    rwmf.Motion.from_obspy,
    (_trace(), r"'IV.ARS1..HNN': states no unit: give unit = 'g', 'm/s2' or 'cm/s2'"),
    (_trace(A, _DIFFERENTIATED), "states no unit"),
    (_trace(A, _REMOVED.format("VEL")), "holds velocities after its processing"),
    (_trace(A, _REMOVED.format("ACC"), _INTEGRATED), "holds velocities"),
    (_trace(A, _REMOVED.format("DISP")), "holds displacements"),
    (_trace(np.arange(50)), "holds whole numbers, counts of a digitiser"),
    (_trace(np.ma.masked_greater(A, 0.9)), "has gaps"),
    (_trace(A, npts=51), "has 50 samples, its header says 51"),
    ([_trace(), _trace()], r"has 2 traces \(IV.ARS1..HNN, IV.ARS1..HNN\)"),
    ([], "must be a trace of ObsPy"),
    (A, "must be a trace of ObsPy"),
    (7, "must be a trace of ObsPy"),
)


@pytest.mark.parametrize("order", ["VEL", "DISP"])
def test_a_unit_makes_no_accelerations_of_velocities(order: str) -> None:
    with pytest.raises(rwmf.InputError, match="must be accelerations"):
        rwmf.Motion.from_obspy(_trace(A, _REMOVED.format(order)), "m/s2")


def test_traces_of_the_package() -> None:
    obspy = pytest.importorskip("obspy")
    trace = obspy.Trace(A, {"delta": 0.01})
    assert np.array_equal(rwmf.Motion.from_obspy(trace, "g").values, A)
    trace.integrate()
    with pytest.raises(rwmf.InputError, match="no unit"):
        rwmf.Motion.from_obspy(obspy.Stream([trace]))
