"""Sweeps: many runs in chunks, on threads or any executor, into one labelled dataset."""

from rwmf._sweep.computation import merge, sweep
from rwmf._sweep.record_sets import RecordFile, find_records

__all__ = ["RecordFile", "find_records", "merge", "sweep"]
