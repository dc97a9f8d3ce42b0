"""Counts of words and sentences in docstrings, comments, messages and pages."""
