"""A digest of `tools/bits` follows numbers, and nothing else."""

from __future__ import annotations

import copy
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from checkout import ROOT

sys.path.append(str(ROOT / "tools"))

from bitwise.clean import csv_text
from bitwise.dump import dump_dataset

FOUND = xr.Dataset(
    {"u_s": ("t", np.array([0.1, 0.0, np.nan]), {"units": "m", "long_name": "displacement"})},
    {"t": ("t", np.array([0.0, 0.5, 1.0])), "record": ("t", np.array(["a", "b", "c"]))},
    {"impacts": 3, "warnings": "not conserved: energy", "seconds": 0.3, "source": "rwmf 0.5.0"},
)


def _with_texts(found: xr.Dataset) -> None:
    found["u_s"].attrs["long_name"] = "another wording"
    found["u_s"].attrs["group"] = "a new group"
    found["record"] = ("t", np.array(["x", "y", "z"]))
    found.attrs |= {"warnings": "another", "seconds": 9.0, "source": "rwmf 9.9.9", "note": "new"}


def _with_number(found: xr.Dataset) -> None:
    found["u_s"].values[0] = np.nextafter(found["u_s"].values[0], 1)


def _with_sign(found: xr.Dataset) -> None:
    found["u_s"].values[1] = -0.0


def _with_count(found: xr.Dataset) -> None:
    found.attrs["impacts"] = 4


@pytest.mark.parametrize(
    ("change", "is_same"),
    [(_with_texts, True), (_with_number, False), (_with_sign, False), (_with_count, False)],
)
def test_numbers_of_a_dataset(change: object, is_same: bool) -> None:
    found = copy.deepcopy(FOUND)
    assert callable(change)
    change(found)
    assert (dump_dataset(found) == dump_dataset(FOUND)) == is_same


TABLE = '# rwmf 0.5.0\n# case: &wall\nu_s_max_m,seconds,warnings\n0.25,0.1,"a, b"\n'


@pytest.mark.parametrize(
    ("old", "new", "is_same"),
    [
        ("0.5.0", "9.9.9", True),
        ("&wall", "&wall /, &new_group", True),
        (",0.1,", ",7.5,", True),
        ("a, b", "another wording", True),
        ("0.25", "0.2500000000000001", False),
        ("u_s_max_m", "theta_max", False),
    ],
)
def test_numbers_of_a_file(tmp_path: Path, old: str, new: str, is_same: bool) -> None:
    path = tmp_path / "case.summary.csv"
    path.write_text(TABLE, encoding="utf-8")
    before = csv_text(path)
    path.write_text(TABLE.replace(old, new), encoding="utf-8")
    assert (csv_text(path) == before) == is_same
