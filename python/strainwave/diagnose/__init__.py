"""Diagnosis of a gear from what its actuator measures: orders against noise and a baseline, what is detectable, and life."""
