"""Misalignment of a wave generator: ramps of an actuator with it, sweeps of its levels, and its estimate from a record.

What is here is what one calls for a misalignment, and what that returns. Diagnoses by orders are `sw.diagnose.order_lines` and
`sw.diagnose.detection_limit`; the command is `strainwave diagnose joint`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
