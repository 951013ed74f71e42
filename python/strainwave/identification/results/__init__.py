"""Results of identification: of each file, of all together, and the checks on them."""
