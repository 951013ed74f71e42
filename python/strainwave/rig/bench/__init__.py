"""The rig and the record of a test on it, and their files."""
