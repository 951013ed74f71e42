"""Files: recordings, tables, units, gear files and ratings, folders of ensembles."""
