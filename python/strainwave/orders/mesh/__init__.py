"""From a table of finite elements, over wave-generator angle and load, to the laws of a gear."""
