"""Version and instruction set of the kernel, read without NumPy."""

from __future__ import annotations

import ctypes
from importlib.util import find_spec

_BYTES = 64


def identity() -> str:
    """Return both as ``0.7.0 (x86-64-v4)``; to import the extension would load NumPy as well."""
    found = find_spec("rwmf._kernel")
    text = ctypes.create_string_buffer(_BYTES)
    ctypes.CDLL("" if found is None else found.origin).rwmf_identity(text)
    return text.value.decode()
