"""Formats that the kernel reads: AT2 files and tables."""

from __future__ import annotations

from rwmf import _library
from rwmf._records.channels import Channel
from rwmf.case import Motion

__all__ = ["read_by_kernel"]


def read_by_kernel(content: bytes, name: str, unit: str | None, dt: float | None) -> list[Channel]:
    """Read the channels of an AT2 file or a table.

    Parameters
    ----------
    content : bytes
        The file.
    name : str
        Name of the motion; that of the column is added in a table of several components.
    unit : str, optional
        Unit of the samples; must agree with a unit in the file.
    dt : float, optional
        Interval of one column [s]; must agree with an interval in the file.

    Returns
    -------
    list of Channel
        One per column of accelerations.

    Raises
    ------
    InputError
        When the file is damaged, lacks unit or interval, or contradicts them.
    """
    found = _library.read_record(content, unit, dt)
    is_alone = len(found) == 1
    return [
        Channel(
            Motion(
                item.values,
                dt=item.dt,
                times=item.times,
                unit=item.unit,
                name=name if is_alone else f"{name}-{item.name}",
            ),
            "" if is_alone else item.name,
            item.format,
            is_complete=is_alone,
        )
        for item in found
    ]
