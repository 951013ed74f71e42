"""Orders found in measurements: the kinematic error from two encoders, and ripple in torque or current."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
