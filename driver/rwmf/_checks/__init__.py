"""Demands over the limits of a case."""
