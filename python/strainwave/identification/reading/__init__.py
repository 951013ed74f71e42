"""Files of measurements: which columns they have, and what each seems to be."""
