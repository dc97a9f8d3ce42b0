"""Cheapest designs that meet targets over a suite."""
