"""Labelled data sets of simulated drives: faults, plans, shards that any number of processes write, features and splits."""
