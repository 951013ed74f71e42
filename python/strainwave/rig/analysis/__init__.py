"""Evaluation of loops: regimes, stiffness, lost motion, soft spots, and the comparison of several loops."""
