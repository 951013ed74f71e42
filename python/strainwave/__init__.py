"""strainwave: identification and simulation of strain wave gears (harmonic drives).

>>> import strainwave as sw
>>> gear = sw.load("hfuc-25-100")
>>> gear.kinematics.ratio
-100.0
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

try:
    import_module("strainwave._core")
except Exception as error:  # in a clone also one of the build, which compiles what was edited
    if isinstance(error.__cause__, KeyboardInterrupt):
        raise error.__cause__ from None
    import sys
    import sysconfig

    raise ImportError(
        f"the compiled core of strainwave does not load: {error}. In a clone, `python3 dev.py demo` compiles it, and "
        f"`source .venv/bin/activate` finds the tools for that; a wheel must be one for Python "
        f"{sys.version_info.major}.{sys.version_info.minor} on {sysconfig.get_platform()}"
    ) from None
import lazy_loader

from strainwave import presented_models as _presented_models
from strainwave._core import Gear

_attribute, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> Any:
    """Return a public name, imported at its first use; of one that is nearly a public name, name that one."""
    try:
        return _attribute(name)
    except AttributeError as error:
        from difflib import get_close_matches

        near = get_close_matches(name, __all__, 1)
        meant = f"; did you mean {near[0]}?" if near else ""
        raise AttributeError(f"{error}{meant}", name=name) from None


def from_datasheet(ratio: float, **figures: Any) -> Gear:
    """The gear of `GearSet.from_datasheet`; that set also has the source of each number.

    Args:
        ratio: that with the circular spline held, signed, or with `fixed`
        figures: of the data sheet, as k1="31e3 N.m/rad"; `strainwave.files.datasheet.from_datasheet` describes all

    Raises:
        TypeError, ValueError: as there

    >>> gear = Gear.from_datasheet(ratio=-100, size=25, k1="0.9 kgf.m/arcmin")
    >>> round(gear.stiffness.k1)
    26190
    """
    return import_module("strainwave.files.datasheet").from_datasheet(ratio, **figures).gear  # type: ignore[no-any-return]


Gear.from_datasheet = staticmethod(from_datasheet)  # type: ignore[method-assign]
del from_datasheet
_presented_models.present()
