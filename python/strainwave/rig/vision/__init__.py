"""From photographs of two circular markers to the angle of the shaft that carries them."""
