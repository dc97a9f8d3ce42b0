"""Instruction counts of the standard calls, with a check against growth (tools/counts)."""
