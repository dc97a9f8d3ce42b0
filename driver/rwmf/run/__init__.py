"""One case: run, spectrum, static curve, their quantities and checks."""
