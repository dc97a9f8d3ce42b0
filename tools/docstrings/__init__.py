"""Check of docstrings for required items: arguments, units, shapes, results, errors."""
