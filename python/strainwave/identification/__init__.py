"""Identification: what measurements say of a gear, and how sure they are."""
