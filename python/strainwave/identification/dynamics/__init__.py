"""Logs of moving drives: linear regression, then simulation."""
