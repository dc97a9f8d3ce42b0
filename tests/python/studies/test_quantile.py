"""Quantiles over a suite count runs that overturned or collapsed as infinite."""

import numpy as np
import pytest
import rwmf
import xarray as xr
from scenes import bare_frame, coupled

RECORDS = [
    rwmf.Motion(size * np.sin(np.arange(60) * 0.12), dt=0.02, unit="m/s2", name=f"wave {i}")
    for i, size in enumerate((1.0, 3.0, 14.0, 30.0))
]


def _fallen(kind: str) -> xr.Dataset:
    """Compute a suite whose last motions end the run."""
    if kind == "overturned":
        case = coupled(frame=None, cable=None, solver={"t_end": 4.0})
    else:
        case = bare_frame(p_delta={"h_f": 3.0, "drift_limit": 0.05}, solver={"t_end": 4.0})
    name = "u_s_max" if case.frame is not None else "theta_max_over_alpha"
    found = rwmf.sweep(case, {"T_s": [2.0, 3.0]}, RECORDS, quantities=name)
    return found.rename({name: "peak"})


@pytest.mark.parametrize("kind", ["overturned", "collapsed"])
def test_fallen_runs_are_infinite(kind: str) -> None:
    found = _fallen(kind)
    status = found["status"].attrs["flag_meanings"].split().index(kind)
    n = (found["status"] == status).sum("record").squeeze().values
    assert ((n > 0) & (n < len(RECORDS))).all()
    values = np.where(found["status"] == status, np.inf, found["peak"]).squeeze()
    axis = values.shape.index(len(RECORDS))
    ranked = np.moveaxis(np.sort(values, axis=axis), axis, 0)
    for share, place in ((0.0, 0), (0.25, 0), (0.26, 1), (0.5, 1), (1.0, 3)):
        one = rwmf.quantile(found, "peak", share).squeeze()
        assert one.values == pytest.approx(ranked[place])
        assert one.dims == ("T_s",)
    assert np.isinf(rwmf.quantile(found, "peak", 1.0)).all()
    several = rwmf.quantile(found, "peak", (0.5, 1.0)).squeeze()
    assert list(several["quantile"].values) == [0.5, 1.0]
    assert several.sel(quantile=0.5).values == pytest.approx(ranked[1])
    assert several.attrs == found["peak"].attrs
    least = rwmf.quantile(found.rename(peak="peak_min"), "peak_min", 0.0).squeeze()
    assert np.isneginf(least).all()


def test_statuses_of_spectra_are_names() -> None:
    """Over the periods of a spectrum, some of which collapse."""
    case = bare_frame(p_delta={"h_f": 3.0, "drift_limit": 0.05})
    found = rwmf.spectrum(case, T_s=np.linspace(0.1, 2.0, 9))
    n = int((found["status"] == "collapsed").sum())
    assert 0 < n < 9
    shares = (np.arange(9) + 1) / 9
    infinite = np.isinf(rwmf.quantile(found, "u_s_max", shares, dim="T_s"))
    assert int(infinite.sum()) == n


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ({"q": 84}, r"q = 84: must be in \[0, 1\]"),
        ({"quantity": "theta"}, "'theta': is not in the dataset, which has u_s_max"),
        ({"dim": "scale"}, "no dimension 'scale', only"),
    ],
)
def test_wrong_words(words: dict[str, object], message: str) -> None:
    found = rwmf.sweep(coupled(solver={"t_end": 1.0}), {"T_s": [1.0]}, RECORDS[:1])
    with pytest.raises(rwmf.InputError, match=message):
        rwmf.quantile(found, **words)  # type: ignore[arg-type]
