"""Powers and energies of a drive."""

from typing import Any


class NoMeter:
    """
    No measurement: powers and energies are not worked out.

    .. math:: E(t) = \\text{not known}

    >>> from strainwave.meter import NoMeter
    >>> NoMeter()
    NoMeter()

    Parameters
    ----------

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition
    """

    def __init__(self) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /) -> NoMeter:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'none'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]

    @property
    def active(self) -> bool:
        """Whether it makes any difference."""

class EnergyMeter:
    """
    Powers and energies of a drive, as outputs of its runs.

    .. math:: E_{supplied} = \\sum_{places} E_{lost} + E_{load} + \\Delta E_{stored}

    Each energy is the integral of its power since the start of the run. Lost are those of the motor, of friction at the three
    places, of damping, and of hysteresis; stored are those of both shafts, of the spring and of the motor, which a run
    may begin with. Hysteresis and bristles of friction store a part of what they take, and give it back later: over a
    cycle what they took is lost. A spring that softens as it warms up turns some of its energy to heat. A random
    kinematic error whose amplitude follows load or speed does work on the shafts, of either sign, as that amplitude changes.
    What a brake takes counts to the load.

    The balance is as exact as the steps are: they integrate the powers with the motion. What an input does by a jump takes no
    time, so no power tells it: of the angle at which an output shaft is held, and of the temperature of a spring that softens. With a random kinematic error
    whose amplitude follows load or speed, the balance of steps of a fixed length is of first order where these cross zero, for
    the amplitude has a kink there: take simulate_adaptively.

    >>> import strainwave as sw
    >>> drive = sw.Drive(load=sw.loads.Inertia(inertia=0.01), meter=sw.meter.EnergyMeter())
    >>> run = sw.simulate(drive, sw.scenario.step(amplitude=5.0, duration=0.1))
    >>> float(run["energy_supplied"][-1]) > float(run["energy_motor"][-1]) > 0.0
    True

    Parameters
    ----------

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition; the balance is that of GoldsteinPooleSafko2002, section 1.3
    """

    def __init__(self) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /) -> EnergyMeter:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'energy'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @property
    def active(self) -> bool:
        """Whether it makes any difference."""
