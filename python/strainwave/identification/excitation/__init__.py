"""Measurements to make next, which determine chosen parameters best."""
