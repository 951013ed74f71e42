"""Comparison of two recordings, or of two models."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, overload

from strainwave.analysis.agreement import Agreement, agreements
from strainwave.analysis.difference import Difference, Model, differences
from strainwave.files.recording import Recording
from strainwave.messages import shortened


@overload
def compare(first: Recording, second: Recording, names: Sequence[str] | None = None) -> list[Agreement]: ...
@overload
def compare(first: Model, second: Model) -> list[Difference]: ...
def compare(first: Any, second: Any, names: Sequence[str] | None = None) -> Any:
    """Compare two recordings, or two models.

    Of recordings each column that both have is compared, over the time that both cover: the second is read off at the samples
    of the first, between its own on a straight line. Columns of other units are converted. Of models all numbers are compared,
    and which law stands at which place; of a gear and a drive the gear. Of two sets the ratings are compared, too.

    Args:
        first, second: two recordings with the column `time`; or two of gear, drive and set
        names: the columns to compare; without it all that both recordings have

    Returns:
        Of recordings the agreement of each column, in the order of the first or of `names`. Of models the differences, none if
        they are equal.

    Raises:
        TypeError: they are not of one kind, or `names` is given for models
        ValueError: the recordings have no time or no other column in common, do not overlap, or a column measures something
            else in one of them

    >>> import strainwave as sw
    >>> one = sw.Recording({"time": [0.0, 1.0, 2.0], "torque": [0.0, 1.0, 2.0]}, {"time": "s", "torque": "N.m"})
    >>> other = sw.Recording({"time": [0.5, 2.5], "torque": [400.0, 2600.0]}, {"time": "s", "torque": "mN.m"})
    >>> print(*sw.compare(one, other))
    torque: rms 0.05 N.m, largest 0.05 N.m at t = 2 s, correlation 1
    >>> print(*sw.compare(sw.load("csg-25-100"), sw.load("csg-32-100"))[:1])
    gear.damping: 4.526 N.m.s/rad against 13.46 N.m.s/rad (+197 %)
    """
    kinds = [_kind(name, each) for name, each in (("first", first), ("second", second))]
    if kinds[0] != kinds[1]:
        raise TypeError(f"first is {kinds[0]}, second {kinds[1]}; give two recordings, or two of gear, drive and set")
    if isinstance(first, Recording):
        return agreements(first, second, names)
    if names is not None:
        raise TypeError(f"names = {shortened(names)}: of models all numbers are compared; leave it out")
    return differences(first, second)


def _kind(name: str, each: object) -> str:
    if not isinstance(each, Recording | Model):
        raise TypeError(f"{name} = {shortened(each)} must be a recording, a gear, a drive or a set")
    return "a recording" if isinstance(each, Recording) else "a model"
