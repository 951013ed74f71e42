"""The verbs of the command `strainwave`, one file each."""
