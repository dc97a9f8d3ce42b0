"""A case: what a namelist describes, as the kernel has read and validated it."""

from rwmf.case.case import Case, CaseLike
from rwmf.case.motion import Motion

__all__ = ["Case", "CaseLike", "Motion"]
