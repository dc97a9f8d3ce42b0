"""Whether docstrings say what the house asks for: arguments, units, shapes, results, errors."""
