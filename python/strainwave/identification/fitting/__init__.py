"""Least squares on one or several experiments, and how sure its estimates are."""
