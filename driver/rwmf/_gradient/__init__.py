"""Derivatives of results with respect to the numbers of a case."""
