from .cache import KernelWarning as KernelWarning
from .compile import Compilation as Compilation
