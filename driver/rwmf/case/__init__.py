"""Cases: contents of a namelist, read and validated by the kernel."""

from rwmf.case.case import Case, CaseLike
from rwmf.case.motion import Motion

__all__ = ["Case", "CaseLike", "Motion"]
