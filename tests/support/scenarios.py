"""Parts of scenario files that several tests read."""

RAMP_AND_SINE = """name = "Ramp and push"
note = "as on the rig"
duration = { value = 2000, unit = "ms" }
temperature = { value = 40.0, unit = "degC" }
[[command]]
kind = "ramp"
rate = { value = 30.0, unit = "deg/s" }
[[command]]
kind = "sine"
amplitude = { value = 2.0, unit = "deg" }
frequency = 3.0
"""
TURNED = """[initial]
output_angle = { value = 5.0, unit = "deg" }
"""
