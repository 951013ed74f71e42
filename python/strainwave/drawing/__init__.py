"""Drawing with matplotlib: one style and the marks that reports and the `plot` methods of results share."""
