"""The torsion test rig: images of two markers and masses on pans in, the loop of a gear, its stiffness and lost motion out.

What is here is what one calls, and what that gives back. The parts of a result, and the steps on the way to it, are in `bench`,
`vision`, `analysis`, `running`, `reading`, `influence` and `virtual`; `report` and `command` use them, and nothing else does.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
