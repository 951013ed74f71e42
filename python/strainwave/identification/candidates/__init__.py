"""The models that are tried on a measurement, and which of them is best."""
