"""Figures of the laws of a gear on theory pages: error, friction, stiffness, hysteresis and material."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import parts
import strainwave as sw
from matplotlib.axes import Axes
from numpy.typing import NDArray
from parts import Draw, Shown

Array = NDArray[np.float64]

LOAD_TORQUE = 10.0  # N.m, transmitted where a figure shows an error or a friction that depends on it


def having(*verbs: str) -> Callable[[Callable[[Shown], list[Draw]]], Callable[[Shown], list[Draw]]]:
    """Panels for models that can be asked all of these."""

    def only(draw: Callable[[Shown], list[Draw]]) -> Callable[[Shown], list[Draw]]:
        return lambda models: draw(models) if all(hasattr(models[0][1], verb) for verb in verbs) else []

    return only


def prefixed(largest: float, unit: str) -> tuple[float, str]:
    """A factor and a unit with prefix, in which the largest value is easily read."""
    for factor, prefix in ((1.0, ""), (1e3, "m"), (1e6, "µ")):
        if largest * factor >= 0.1:
            return factor, prefix + unit
    return 1e9, "n" + unit


# ---- Kinematic error -------------------------------------------------------------------------------------------------

TURN = np.linspace(0.0, 2.0 * np.pi, 721)
WARMING_OF_ERROR = 40.0  # K, by which an error over the temperature is drawn a second time
DRAWN_SPEED = 100.0  # rad/s, at which a random error is drawn
NOISES = (sw.kinematic_error.Stochastic, sw.kinematic_error.MicroSlip)


def error_of(model: Any, angle: Array) -> Array:
    """Return the kinematic error [rad] without load."""
    return model.error(angle, speed=DRAWN_SPEED) if isinstance(model, NOISES) else model.error(angle)


def under_load(model: Any) -> Array:
    """Return the kinematic error [rad] over a turn under `LOAD_TORQUE`. Only random ones depend on the torque alone."""
    if isinstance(model, NOISES):
        return model.error(TURN, torque=LOAD_TORQUE, speed=DRAWN_SPEED)
    return parts.error_under_load(model, TURN, LOAD_TORQUE)


@having("error", "slope")
def error(models: Shown) -> list[Draw]:
    """Over a turn, without load and under load; errors of very different size in panels of their own."""
    size = {label: float(np.ptp(error_of(model, TURN))) for label, model in models}
    large = [(label, model) for label, model in models if size[label] > 1e-2 * max(size.values())]
    small = [(label, model) for label, model in models if size[label] <= 1e-2 * max(size.values())]

    def together(some: Shown) -> Draw:
        def draw(axes: Axes) -> None:
            factor, unit = prefixed(max(size[label] for label, _ in some), "rad")
            for label, model in some:
                sensitive = getattr(model, "load_sensitivity", getattr(model, "load_share", 0.0)) > 0.0
                warms = hasattr(model, "reference_temperature")
                plain = "without load" if sensitive else "at T0" if warms else None
                axes.plot(np.degrees(TURN), factor * error_of(model, TURN), label=label or plain)
                if sensitive:
                    axes.plot(np.degrees(TURN), factor * under_load(model), label=f"under {LOAD_TORQUE:g} N.m")
                if warms:
                    warm = model.replace(temperature=model.reference_temperature + WARMING_OF_ERROR)
                    axes.plot(np.degrees(TURN), factor * error_of(warm, TURN), label=f"{WARMING_OF_ERROR:g} K warmer")
            axes.set(xlabel="input angle [deg]", ylabel=f"error at the output [{unit}]", xticks=np.arange(0, 361, 60))

        return draw

    return [together(some) for some in (large, small) if some]


@having("error", "highest_order")
def spectrum(models: Shown) -> list[Draw]:
    """Over 512 turns, after which the default band repeats."""

    def draw(axes: Axes) -> None:
        turns, points = 512, 128
        angle = 2.0 * np.pi * np.arange(turns * points) / points
        amplitude = 2.0 * np.abs(np.fft.rfft(error_of(models[0][1], angle))) / len(angle)
        factor, unit = prefixed(float(amplitude.max()), "rad")
        order = np.arange(len(amplitude)) / turns
        axes.plot(order, factor * amplitude, linewidth=0.8)
        axes.set(xlabel="order [1]", ylabel=f"amplitude [{unit}]", xlim=(0.0, 1.2 * models[0][1].highest_order))

    return [draw]


# ---- Friction --------------------------------------------------------------------------------------------------------

SPEED_OF_FRICTION = 1.0  # rad/s, at which friction is drawn over something else


def asked(model: Any, name: str, otherwise: float) -> float:
    """A parameter of a law, or of the one that it modulates."""
    law = model if hasattr(model, name) else getattr(model, "law", model)
    return float(getattr(law, name, otherwise))


@having("steady")
def steady(models: Shown) -> list[Draw]:
    law = models[0][1]
    fastest = 10.0 * asked(law, "stribeck_speed", 1.0)
    slowest = 1e-9 * fastest
    loaded = law.steady(SPEED_OF_FRICTION, load=LOAD_TORQUE) != law.steady(SPEED_OF_FRICTION)

    def draw(axes: Axes) -> None:
        for speed in (np.linspace(-fastest, -slowest, 401), np.linspace(slowest, fastest, 401)):
            axes.plot(speed, law.steady(speed, load=LOAD_TORQUE), color="C0")
        if law.set_valued:
            axes.plot([0.0, 0.0], [-law.hold(-1.0, load=LOAD_TORQUE), law.hold(load=LOAD_TORQUE)], color="C0")
        under = f" under {LOAD_TORQUE:g} N.m" if loaded else ""
        axes.set(xlabel="speed [rad/s]", ylabel=f"steady friction{under} [N.m]")

    return [draw]


@having("steady")
def over_contact(models: Shown) -> list[Draw]:
    """Over whatever the law depends on besides the speed."""
    law = models[0][1]
    fast = 10.0 * asked(law, "stribeck_speed", 1.0)
    ranges = {
        "angle": (np.linspace(0.0, getattr(law, "domain_end", 2.0 * np.pi), 721), "angle [rad]", (SPEED_OF_FRICTION,)),
        "load": (
            np.linspace(-LOAD_TORQUE, LOAD_TORQUE, 401),
            "transmitted torque [N.m]",
            (SPEED_OF_FRICTION, -SPEED_OF_FRICTION),
        ),
        "temperature": (np.linspace(273.15, 333.15, 121), "temperature [K]", (SPEED_OF_FRICTION, fast)),
    }

    def over(name: str) -> Draw:
        values, label, speeds = ranges[name]

        def draw(axes: Axes) -> None:
            several = len(speeds) > 1
            for speed in speeds:
                friction = law.steady(speed, **({"load": LOAD_TORQUE} | {name: values}))
                axes.plot(values, friction, label=f"at {speed:g} rad/s" if several else None)
            axes.set(xlabel=label, ylabel="friction [N.m]" if several else f"friction at {speeds[0]:g} rad/s [N.m]")

        return draw

    def varies(name: str) -> bool:
        friction = law.steady(SPEED_OF_FRICTION, **({"load": LOAD_TORQUE} | {name: ranges[name][0]}))
        return bool(np.ptp(friction) > 1e-9 * np.abs(friction).max())

    return [over(name) for name in ranges if varies(name)]


@having("steady", "State")
def presliding(models: Shown) -> list[Draw]:
    """Slow cycles about three times as wide as the contact bends before it slips, if it bends."""
    law = models[0][1]
    bend, slow = 1e-9, 1e-9
    bent, slipping = float(law.trace([0.0, 1.0], [bend, bend], load=LOAD_TORQUE)[-1]), float(law.steady(slow, load=LOAD_TORQUE))
    if law.set_valued or not 0.0 < bent < 0.1 * slipping:
        return []
    reach = 3.0 * slipping * bend / bent

    def draw(axes: Axes) -> None:
        time = np.linspace(0.0, 125.0, 2001)
        angle = reach * np.sin(0.1 * time)
        factor, unit = prefixed(reach, "rad")
        axes.plot(factor * angle, law.trace(time, np.gradient(angle, time), load=LOAD_TORQUE))
        axes.set(xlabel=f"angle [{unit}], cycled slowly", ylabel="friction [N.m]")

    return [draw]


# ---- Stiffness and hysteresis ----------------------------------------------------------------------------------------


@having("tangent")
def spring(models: Shown) -> list[Draw]:
    law = models[0][1]
    torque = np.linspace(-1.0, 1.0, 801) * 1.5 * getattr(law, "t2", 50.0)
    twist = law.twist(torque)
    factor, unit = prefixed(float(twist.max()), "rad")

    def torques(axes: Axes) -> None:
        axes.plot(factor * twist, torque)
        axes.set(xlabel=f"twist [{unit}]", ylabel="torque [N.m]")

    def slopes(axes: Axes) -> None:
        axes.plot(torque, 1e-3 * law.tangent(twist))
        axes.set(xlabel="torque [N.m]", ylabel="stiffness [kN.m/rad]", ylim=(0.0, None))

    return [torques, slopes]


@having("work", "advance")
def loop(models: Shown) -> list[Draw]:
    """A loop so wide that all the models have slipped; of one alone also smaller loops in it."""
    reach = max(slipped(model) for _, model in models)
    inner = [0.0, 0.6, 0.2, 0.6, -1.0] if len(models) == 1 else []
    turns = reach * np.array([0.0, 1.0, -1.0, 1.0, *inner])
    path = np.concatenate([np.linspace(start, end, 201) for start, end in pairwise(turns)])

    def draw(axes: Axes) -> None:
        factor, unit = prefixed(reach, "rad")
        for label, model in models:
            axes.plot(factor * path, model.trace(path), label=label or None, linewidth=1.2)
        axes.set(xlabel=f"twist [{unit}]", ylabel="torque [N.m]")

    return [draw]


def slipped(model: Any) -> float:
    """The twist [rad] at which the secant has fallen to a third of what it begins with, but within all that it knows."""
    if hasattr(model, "lost_motion"):
        return 0.6 * float(model.lost_motion)
    if hasattr(model, "springs"):  # which harden, so that the secant does not fall so far
        return float(model.springs.twist(4.0 * model.friction))
    reaches = np.geomspace(1e-6, 10.0, 281)
    secant = np.array([model.trace([0.0, reach])[-1] / reach for reach in reaches])
    limit = getattr(getattr(model, "density", None), "limit", reaches[-1])
    return min(float(reaches[np.argmax(secant < secant.max() / 3.0)]), float(limit))


# ---- Variation and ring ----------------------------------------------------------------------------------------------

FORCE_ORDER = 4.0  # of the wave generator, of the mesh force that a ring answers


@having("factor")
def variation(models: Shown) -> list[Draw]:
    """Over a turn of the wave generator."""
    law = models[0][1]
    if not law.active:
        return []

    def draw(axes: Axes) -> None:
        axes.plot(np.degrees(TURN), law.factor(TURN))
        axes.set(xlabel="input angle [deg]", ylabel="stiffness over its mean [1]", xticks=np.arange(0, 361, 60))

    return [draw]


@having("natural_frequency", "waves", "mass")
def ring(models: Shown) -> list[Draw]:
    """Amplitude of the teeth over the speed, under a mesh force of one order."""
    modes = models[0][1]
    speed = np.linspace(0.0, max(modes.natural_frequency), 2000)

    def answer(place: int, order: float) -> NDArray[np.complex128]:
        own, frequency = modes.natural_frequency[place], order * speed
        dynamic = own**2 - frequency**2 + 2j * modes.damping[place] * own * frequency
        return np.asarray(0.5 / (modes.mass[place] * dynamic))

    def draw(axes: Axes) -> None:
        motion = sum(
            answer(place, FORCE_ORDER + sign * waves) for place, waves in enumerate(modes.waves) for sign in (1.0, -1.0)
        )
        factor, unit = prefixed(float(np.abs(motion).max()), "m/N")
        axes.semilogy(speed, factor * np.abs(motion))
        axes.set(xlabel="input speed [rad/s]", ylabel=f"order {FORCE_ORDER:g} of u over force [{unit}]")

    return [draw]


# ---- Material --------------------------------------------------------------------------------------------------------


@having("storage", "loss")
def moduli(models: Shown) -> list[Draw]:
    """Over the frequency."""
    law = models[0][1]
    if not law.active:
        return []
    times = law.relaxation_time
    frequency = np.geomspace(0.03 / max(times), 30.0 / min(times), 400)

    def draw(axes: Axes) -> None:
        axes.semilogx(frequency, law.storage(frequency), label="in phase with the twist")
        axes.semilogx(frequency, law.loss(frequency), label="a quarter ahead")
        axes.set(xlabel="angular frequency [rad/s]", ylabel="stiffness [N.m/rad]")

    return [draw]


PANELS = (
    error,
    spectrum,
    steady,
    over_contact,
    presliding,
    spring,
    loop,
    variation,
    ring,
    moduli,
)


def preisach(density: Any) -> sw.hysteresis.Preisach:
    return sw.hysteresis.Preisach(density=density)


# In place of the example, where others show more; several are drawn together.
SHOWN: dict[str, dict[str, Any]] = {
    "fourier": {"": sw.kinematic_error.Fourier(order=[1, 2, 4], amplitude=[5e-5, 2e-4, 4e-5], phase=[0.0, 0.3, 1.1])},
    "misalignment": {
        f"{name}:": sw.kinematic_error.Misalignment(
            major_radius=25.25e-3,
            minor_radius=24.75e-3,
            pitch_radius=25e-3,
            housing_eccentricity=20e-6,
            generator_eccentricity=10e-6,
            generator_direction=0.9,
            combine=name,
        )
        for name in ("single", "max", "mean")
    },
    "tooth_errors": {
        f"{share:.0%} engaged:": sw.kinematic_error.ToothErrors(
            flexspline_teeth=200,
            circular_spline_teeth=202,
            pitch_radius=25e-3,
            engaged_share=share,
            flexspline_deviation=15e-6,
            circular_spline_deviation=15e-6,
            seed=1,
        )
        for share in (0.1, 0.3)
    },
    "load_dependent": {
        "": sw.friction.LoadDependent(
            driving_forward=0.1, driving_reverse=0.15, backdriving_forward=0.2, backdriving_reverse=0.3
        )
    },
    "asymmetric": {
        "": sw.friction.Asymmetric(
            law=sw.friction.Stribeck(coulomb=0.03, breakaway=0.045, stribeck_speed=2.0, viscous=2e-3), dry_asymmetry=0.2
        )
    },
    "curved_viscous": {
        f"p = {p:g}:": sw.friction.CurvedViscous(coulomb=0.02, viscous_torque=0.03, exponent=p, reference_speed=10.0)
        for p in (0.5, 1.0, 2.0)
    },
    "angle_speed_map": {
        "": sw.friction.AngleSpeedMap(speed=[1.0, 4.0, 10.0], level=[0.04, 0.03, 0.05, 0.03, 0.02, 0.04, 0.05, 0.045, 0.06])
    },
    "cyclic": {
        "": sw.friction.Cyclic(
            law=sw.friction.Stribeck(coulomb=0.03, breakaway=0.045, stribeck_speed=2.0, viscous=5e-5),
            order=[1, 2],
            amplitude=[0.1, 0.3],
            phase=[0.0, 1.0],
        )
    },
    "thermal": {
        "": sw.friction.Thermal(
            law=sw.friction.Coulomb(coulomb=0.03, breakaway=0.04, viscous=2e-3), dry_fall=0.005, viscous_fall=0.025
        )
    },
    "bouc_wen": {
        f"n = {n:g}:": sw.hysteresis.BoucWen(stiffness=1000.0, saturation=0.5, sharpness=n, shape=0.5) for n in (1.0, 2.0, 8.0)
    },
    "backlash": {"": sw.stiffness.Backlash(law=sw.stiffness.Cubic(a1=1.2e4, a3=1e9), clearance=1e-3)},
    "frictional_windup": {
        "": sw.hysteresis.FrictionalWindup(
            springs=sw.stiffness.MultiCompliance(
                flexspline_stiffness=8000.0,
                flexspline_hardening=0.02,
                wave_generator_stiffness=2.0,
                wave_generator_hardening=1.5,
                reduction=100.0,
            ),
            friction=5.0,
        )
    },
    "power_density": {
        f"p = {p:g}:": preisach(sw.hysteresis.PowerDensity(limit=1e-3, saturation=1.0, exponent=p)) for p in (2.0, 4.0, 8.0)
    },
    "grid_density": {
        "symmetric:": preisach(sw.hysteresis.GridDensity(limit=1e-3, weight=[0.2, 0.3, 0.2])),
        "not symmetric:": preisach(sw.hysteresis.GridDensity(limit=1e-3, weight=[0.6, 0.1, 0.0])),
    },
    "preisach": {"": preisach(sw.hysteresis.PowerDensity(limit=1e-3, saturation=1.0, exponent=2.0))},
}
