"""Diagnosis of a gear from recordings: orders against noise and a healthy baseline, geometry, health and detection limits."""
