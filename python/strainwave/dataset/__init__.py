"""Labelled data of drives with faults."""
