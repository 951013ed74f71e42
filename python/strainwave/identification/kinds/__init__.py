"""Kinds of measurement: how each is fitted, and what it determines."""
