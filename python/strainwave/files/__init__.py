"""What is read and written: recordings, tables, units, gear files and ratings, folders of ensembles."""
