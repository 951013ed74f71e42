"""A test being run: its plan, the guide through it, and where photographs come from."""
