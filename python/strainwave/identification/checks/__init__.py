"""Consistency checks: of a file with physics and with the start set, and of files with each other."""
