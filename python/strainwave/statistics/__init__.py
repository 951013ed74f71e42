"""Linear fits with their rank, covariance under correlated noise, noise floors, robust scale."""
