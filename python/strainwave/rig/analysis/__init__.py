"""What a loop says: regimes, stiffness, lost motion, soft spots, and what loops say together."""
