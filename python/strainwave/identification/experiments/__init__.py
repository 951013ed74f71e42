"""Measurements as experiments: each predicts what a model would show in it."""
