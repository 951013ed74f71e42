"""What to measure next, to know chosen parameters best."""
