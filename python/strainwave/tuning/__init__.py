"""Controllers of a drive: tuned, compensated by what is known of its gear, and judged on gears that it may be."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
