"""Every shipped namelist runs and states its purpose."""

from pathlib import Path

import numpy as np
import pytest
import rwmf
from checkout import ROOT
from reproduce.figures import SCENES

INPUTS = sorted((ROOT / "inputs").glob("*.nml"))
FIGURES = [path for path in INPUTS if path.stem.startswith("fig")]
# enough ordinates to see that the grid is read
FEW = {"n": 3, "T_s_min": 0.4, "T_s_max": 2.0}


@pytest.fixture(params=FIGURES, ids=lambda path: path.stem)
def case(request: pytest.FixtureRequest, elcentro: Path, tmp_path: Path) -> rwmf.Case:
    """Read a shipped case; its record comes from the package, not from an ignored folder."""
    text = request.param.read_text(encoding="utf-8")
    text = text.replace("records/elcentro.csv", str(elcentro))
    return rwmf.Case.from_text(text, tmp_path / request.param.name)


def test_every_figure_has_a_case() -> None:
    figures = {path.name[:5] for path in FIGURES}
    assert figures == {f"fig{number:02d}" for number in range(4, 14)}
    assert set(SCENES) <= {path.stem for path in INPUTS}


def test_what_every_case_states(case: rwmf.Case) -> None:
    assert "formulation" in case.model.given
    assert case.frame.xi_s == 0.05
    if case.wall is not None:
        assert (case.cable.eta_0, case.cable.eta_alpha, case.impact.e) == (1.0, 5.0, 0.9)
        assert (case.wall.h, case.wall.b) in ((2.0, 0.5), (2.0, 1.0))


def test_run(case: rwmf.Case) -> None:
    history = rwmf.simulate(case)
    assert np.isfinite(history["u_s"]).all()
    assert 0 < float(abs(history["u_s"]).max()) <= float(history["u_s_max"]) * (1 + 1e-9)
    assert history["u_s"].attrs["units"] == "m"


@pytest.mark.parametrize(
    "path", [path for path in INPUTS if path not in FIGURES], ids=lambda path: path.stem
)
def test_other_inputs_run(path: Path, elcentro: Path, pacoima: Path, tmp_path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert "?" in text.split("\n\n")[0], "the first comment asks the question"
    for name, record in (("elcentro", elcentro), ("pacoima", pacoima)):
        text = text.replace(f"records/{name}.csv", str(record))
    case = rwmf.Case.from_text(text, tmp_path / path.name)
    result = rwmf.simulate(case)
    peak = "u_s_max" if case.wall is None else "theta_max_over_alpha"
    assert 0 < float(result[peak]) < np.inf


@pytest.mark.parametrize("case", FIGURES[-4:], indirect=True, ids=lambda path: path.stem)
def test_spectrum(case: rwmf.Case) -> None:
    few = case.replace(spectrum=FEW)
    result = rwmf.spectrum(few)
    assert result["u_s_max"].shape == (1, 5, 3)
    assert (result["status"] == "ok").all()
    alone = rwmf.spectrum(few.without_wall())
    assert alone["u_s_max"].shape == (3,)
    # a light wall only damps: the frame alone moves further, or as far where the first peak is
    # the largest
    assert (result["u_s_max"].isel(b=0, gamma=-1) < 1.001 * alone["u_s_max"]).all()
