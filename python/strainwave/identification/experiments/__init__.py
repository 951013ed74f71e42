"""Measurements as experiments: each says what a model predicts for it."""
