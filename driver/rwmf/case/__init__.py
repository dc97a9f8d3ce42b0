"""A case: what a namelist describes, as the kernel has read and validated it."""

from rwmf.case.case import Case

__all__ = ["Case"]
