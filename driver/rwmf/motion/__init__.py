"""Ground motions: records and their formats, intensities, suites, selection."""
