"""Labelled data sets of simulated drives: faults, plans, shards that any number of processes write, features and splits."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
