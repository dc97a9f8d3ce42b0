"""Formats that the kernel reads: AT2 files and tables."""

from __future__ import annotations

from rwmf import _library
from rwmf._records.channels import Channel
from rwmf.case import Motion

__all__ = ["read_by_kernel"]


def read_by_kernel(content: bytes, name: str, unit: str | None, dt: float | None) -> list[Channel]:
    """Read the channels of an AT2 file or a table."""
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
