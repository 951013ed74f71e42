"""Diagnosis of a gear from recordings: orders against noise and against a baseline, condition and remaining life."""
