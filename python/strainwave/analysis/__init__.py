"""Properties of a drive without a long run: steady state, linearisation, responses, derivatives."""
