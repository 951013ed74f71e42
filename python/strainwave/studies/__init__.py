"""Studies: questions that a document raises, put to its models by experiments, and answered with numbers."""
