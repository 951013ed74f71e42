"""Labelled data sets of simulated drives: a plan, shards that any number of processes write, features, splits and a card."""
