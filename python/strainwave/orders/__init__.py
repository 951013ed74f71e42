"""Orders found in measurements: the kinematic error from two encoders, and ripple in torque or current."""
