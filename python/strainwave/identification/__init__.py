"""Identification: parameters of a gear from measurements, with their uncertainty."""
