"""Reports: what was found and what was not, as one self-contained HTML file."""
