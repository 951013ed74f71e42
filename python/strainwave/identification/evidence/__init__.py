"""What a measurement says of a gear, what speaks for it, and what against it."""
