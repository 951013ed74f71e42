"""Command in, recording out: scenarios, states, single runs, ensembles."""
