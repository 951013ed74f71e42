"""Reports of torsion tests, their figures and tables, and the display during a test."""
