"""The studio: pages in a browser for a gear and for the verbs of the command, served on this machine."""
