"""Compiled code for one drive: its static type, the machine's compiler, and the kernels that were compiled before."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
