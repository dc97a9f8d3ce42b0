"""Sweeps: many runs in chunks, on threads or on any executor, into one labelled dataset."""

from rwmf._sweep.record_sets import RecordFile, find_records
from rwmf._sweep.run import merge, sweep

__all__ = ["RecordFile", "find_records", "merge", "sweep"]
