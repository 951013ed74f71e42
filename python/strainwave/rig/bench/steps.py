"""The steps of a torsion test, as they were made: what lay on the pans, and the photograph of it."""

from __future__ import annotations

from dataclasses import dataclass

from strainwave import arguments
from strainwave.messages import shortened
from strainwave.rig.loop import not_negative, positive, signed

MAX_NAME = 200  # characters of a name of a photograph or a specimen


@dataclass(frozen=True)
class Step:
    """A step of a test: masses on the pans, and the shaft at rest.

    Args:
        number: in the order made, from 1
        mass_positive: total on the pair of pans that turns the shaft positively [kg]
        mass_negative: total on the other pair [kg]
        image: file name of the photograph, relative to the folder of the test; None if the angle was read otherwise
        angle: read otherwise [rad], or None
        torque: measured otherwise, instead of masses [N.m], or None
        time: since the test began [s], or None
        temperature: of the gear [K], or None
        position: how far the flexspline was turned in its mount [rad]
        unit: which specimen

    Raises:
        ValueError: a mass is negative, a number is not finite, or a text has spaces around it or more than one line

    >>> Step(2, mass_positive=0.3).mass_positive
    0.3
    >>> Step(3, mass_positive=-0.3)
    Traceback (most recent call last):
    ValueError: mass_positive = -0.3 kg must lie in [0, 1e+12]
    """

    number: int
    mass_positive: float = 0.0
    mass_negative: float = 0.0
    image: str | None = None
    angle: float | None = None
    torque: float | None = None
    time: float | None = None
    temperature: float | None = None
    position: float = 0.0
    unit: str = ""

    def __post_init__(self) -> None:
        arguments.whole("number", self.number, low=1)
        for name in ("mass_positive", "mass_negative"):
            not_negative(name, getattr(self, name), "kg")
        signed("position", self.position, "rad")
        _check_name("unit", self.unit)
        if self.image is not None:
            _check_name("image", self.image)
        for name, unit in (("angle", "rad"), ("torque", "N.m"), ("time", "s")):
            if (value := getattr(self, name)) is not None:
                signed(name, value, unit)
        if self.temperature is not None:
            positive("temperature", self.temperature, "K")


def _check_name(name: str, text: str) -> None:
    if text != arguments.text(name, text).strip() or not text.isprintable() or len(text) > MAX_NAME:
        limits = f"of at most {MAX_NAME} characters"
        raise ValueError(f"{name} = {shortened(text)} must be one line of text without spaces around it, {limits}")
