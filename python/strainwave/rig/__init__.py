"""The torsion test rig: images of two markers and masses on pans in, the loop of a gear, its stiffness and lost motion out.

What is here is what one calls, and what that gives back. The parts of a result, and the steps on the way to it, are in the
modules of the rooms: `bench`, `torque`, `running`, `vision`, `reading`, `analysis`, `influence` and `virtual`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
