"""Sweeps: many runs in chunks, on threads or on any executor, into one labelled dataset."""

from rwmf.sweep.run import merge, sweep
from rwmf.sweep.suite import RecordFile, find_records

__all__ = ["RecordFile", "find_records", "merge", "sweep"]
