"""Diagnosis of a gear from what its actuator measures: orders in the motor current, detection, and what is detectable."""
