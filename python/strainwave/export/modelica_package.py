"""A drive as a Modelica package: a component with a rotational flange, which calls the drive's functions in C."""

from __future__ import annotations

import ctypes
import math
import platform as machine
import sys
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, arguments
from strainwave.export.coupled import MAX_STABLE_SHARE, SUFFIXES, CoupledDrive, losses, shared_library
from strainwave.export.coupled.drive import COMPARED_SAMPLES
from strainwave.export.elements import max_torque_of
from strainwave.export.exported import Exported, Form, stating_origins
from strainwave.export.host import Command, checked_name, command_mode, internal_step
from strainwave.files.gear_set import GearSet
from strainwave.files.ratings import drive_of
from strainwave.native.static_type import in_words
from strainwave.simulation.signals import command_unit

Array = NDArray[np.float64]

DEFAULT_PERIOD = 5e-4  # s, of the exchange between drive and Modelica
EXAMPLE_INERTIA = 1.0  # kg.m², before a drive whose load has none
FOLDERS = {"x86_64-linux": "linux64", "aarch64-linux": "aarch64-linux", "x86_64-darwin": "darwin64", "arm64-darwin": "darwin64"}
UNITS = {"1": "1", "A": "A", "V": "V", "N.m": "N.m", "rad": "rad", "rad/s": "rad/s"}  # of commands, as Modelica spells them


@stating_origins
def modelica(
    drive: Drive | GearSet,
    *,
    max_torque: float | None = None,
    command: Command | None = None,
    period: float | None = None,
    step: float | None = None,
    name: str = "StrainWaveDrive",
) -> Exported:
    """Return a drive as a Modelica package, with the shared library that it calls.

    The component `Drive` has a flange and the command as input. At each instant of a period it gives angle and speed of the
    flange to the drive, and applies torque and rate of the torque until the next one. The drive contains controller, sensors,
    motor and gear.

    Args:
        drive: a drive, or a gear set with one. What is connected to the flange takes the place of its load
        max_torque: at the output [N.m], up to which the stiffness limits the period; by default the peak torque of the ratings
        command: "held" from period to period, as a staircase, or "followed": it goes on at the rate of the last period; by
            default followed if it is an angle or a speed
        period: default of the parameter of this name [s]; by default 0.5 ms, or shorter where the drive needs that
        step: largest internal step [s]; by default 0.2 ms, or shorter where the drive needs that
        name: of the package and the library

    Returns:
        The files of the package by their path, and the loss by the period.

    Raises:
        TypeError, ValueError: an argument is not of its kind
        NoCompilerError: there is no compiler
        CompileError: the compiler reports an error

    >>> import strainwave as sw
    >>> found = sw.export.modelica(sw.GearSet.read("robot-joint"))  # doctest: +SKIP
    >>> sorted(found.files)[-1]  # doctest: +SKIP
    'StrainWaveDrive/package.mo'
    """
    model, drive = drive, drive_of(drive)
    checked_name(name, "Modelica")
    folder = FOLDERS.get(f"{machine.machine()}-{sys.platform}")
    if folder is None:
        raise ValueError("a Modelica package is compiled on Linux and macOS; on other systems take strainwave export fmu")
    largest = max_torque_of(model, max_torque) or 0.0
    step = internal_step(drive, step)
    coupled = CoupledDrive.of(drive, largest)
    inertia = float(getattr(drive.load, "inertia", 0.0))
    if period is not None:
        period = arguments.number("period", period, "s", low=0.0)
    else:
        period = min(DEFAULT_PERIOD, MAX_STABLE_SHARE * coupled.max_timestep(inertia) if inertia else DEFAULT_PERIOD)
    prefix = name.lower()
    mode = command_mode(drive, command)
    sources = coupled.sources(name, step, "functions.cpp", prefix, mode == "followed")
    content = shared_library(sources, "functions.cpp")
    files: dict[str, str | bytes] = {
        f"{name}/package.mo": _package(drive, coupled, name, prefix, period),
        f"{name}/Resources/Include/{prefix}.h": _header(drive, coupled.hold, prefix, mode),
        f"{name}/Resources/Library/{folder}/lib{prefix}{SUFFIXES[sys.platform]}": content,
        **{f"{name}/Resources/Source/{path}": text for path, text in sources.items()},
    }
    numbers = {
        "output_stiffness": (coupled.stiffness, "N.m/rad"),
        "output_hold": (coupled.hold, "N.m"),
        "period": (period, "s"),
        "internal_step": (step, "s"),
    }

    def moved(command: float, angle: float, exchange: float, every: int) -> Array:
        duration = COMPARED_SAMPLES * every * exchange
        found = inertia_moved(content, prefix, inertia or EXAMPLE_INERTIA, coupled, command, angle, exchange, duration)
        return found[::every]

    return Exported(
        "Modelica package",
        model.name if isinstance(model, GearSet) else name,
        files,
        numbers,
        tuple(losses(drive, inertia or EXAMPLE_INERTIA, step, period, "period", moved)),
        tuple(_left_out()),
        tuple(_remarks(name, coupled, inertia, mode)),
    )


def inertia_moved(
    content: bytes,
    prefix: str,
    inertia: float,
    coupled: CoupledDrive,
    command: float,
    angle: float,
    period: float,
    duration: float,
) -> Array:
    """Return the angles of an inertia that a drive moves, at all instants of its period [rad].

    Args:
        content: the library
        prefix: of its functions
        inertia: at the output [kg.m²]
        coupled: stiffness and dry friction there
        command: constant
        angle: at the begin [rad]
        period: of the exchange [s]
        duration: of the run [s]
    """
    with TemporaryDirectory() as folder:
        path = Path(folder, "drive.so")
        path.write_bytes(content)
        library = ctypes.CDLL(str(path))
    begin, step, end = (getattr(library, f"{prefix}_{each}") for each in ("open", "torque", "close"))
    begin.restype, step.restype, end.restype, end.argtypes = ctypes.c_void_p, None, None, (ctypes.c_void_p,)
    step.argtypes = ctypes.c_void_p, *[ctypes.c_double] * 6, *[ctypes.POINTER(ctypes.c_double)] * 2
    torque, rate, drive = ctypes.c_double(), ctypes.c_double(), begin()
    speed, angles, stiffness = 0.0, [angle], coupled.stiffness
    frequency = math.sqrt(stiffness / inertia)
    sine, cosine = math.sin(frequency * period), math.cos(frequency * period)
    for i in range(round(duration / period)):
        step(drive, i * period, angle, speed, command, 0.0, period, torque, rate)
        pushed, rising = torque.value / stiffness, rate.value / stiffness
        free = speed + pushed * frequency * sine + rising * (1.0 - cosine)
        after = max(abs(free) - period * coupled.hold / inertia, 0.0) * math.copysign(1.0, free)
        angle += speed * period + pushed * (1.0 - cosine) + rising * (period - sine / frequency) + 0.5 * period * (after - free)
        speed = after
        angles.append(angle)
    end(drive)
    return np.array(angles)


def _left_out() -> Iterator[str]:
    yield "the load: what is connected to the flange takes its place"
    yield "spin of the housing: the rotor counts its speed relative to the housing"
    yield "parameters of the drive: they are constants of the library"


def _remarks(name: str, coupled: CoupledDrive, inertia: float, mode: Command) -> Iterator[str]:
    yield f"the command is {mode} from period to period"
    yield "not run in a Modelica tool; the functions in C were compared, and rumoca flattens the package"
    if inertia:
        yield f"before an inertia of {inertia:.4g} kg.m2 set periods of {0.5 * coupled.max_timestep(inertia):.2g} s or less"
    command = f"c++ -std=c++20 -O2 -shared -fPIC -I. functions.cpp -o lib{name.lower()}.so"
    yield f"Resources/Source compiles for other systems: {command}"


def _header(drive: Drive, hold: float, prefix: str, mode: Command) -> str:
    return f"""/* A drive with strain wave gear, by strainwave: {in_words(drive)}. */
#ifndef {prefix.upper()}_H
#define {prefix.upper()}_H
#ifdef __cplusplus
extern "C" {{
#endif

/* A drive before its first step; NULL without memory. {prefix}_close frees it. */
void *{prefix}_open(void);
void {prefix}_close(void *drive);

/* Steps the drive from the time of the last call to this one, along the motion of its output between both. Gives the
   torque [N.m] that drives the output now, and its rate [N.m/s] until the next call, which is expected after the period
   [s]: the rate if the output kept its speed. Both are not a number, with a line on stderr, if the drive fails. The first
   call begins at rest. A command goes on at its rate until the next call; if the rate is 0 it is {mode}. The caller adds dry
   friction of {hold!r} N.m at the output. */
void {prefix}_torque(void *drive, double time, double angle, double speed, double command, double command_rate, double period,
                     double *torque, double *torque_rate);

#ifdef __cplusplus
}}
#endif
#endif
"""


def _package(drive: Drive, coupled: CoupledDrive, name: str, prefix: str, period: float) -> str:
    """Return the text of the package."""
    external = f'annotation(Library="{prefix}", Include="#include \\"{prefix}.h\\"")'
    unit = UNITS.get(command_unit(drive), "1")
    inertia = float(getattr(drive.load, "inertia", 0.0)) or EXAMPLE_INERTIA
    return f"""within;
package {name} "A drive with strain wave gear, by strainwave: {in_words(drive)}"
  // Not run in a Modelica tool. The functions in C were compared with the simulation, and rumoca flattens this text.

  class Instance "Drive in memory"
    extends ExternalObject;
    function constructor
      output Instance instance;
      external "C" instance = {prefix}_open() {external};
    end constructor;
    function destructor
      input Instance instance;
      external "C" {prefix}_close(instance) {external};
    end destructor;
  end Instance;

  impure function step "Step the drive to a time, and return the torque at its output"
    input Instance instance;
    input Real instant(unit="s");
    input Real angle(unit="rad");
    input Real speed(unit="rad/s");
    input Real command(unit="{unit}");
    input Real command_rate;
    input Real period(unit="s");
    output Real torque(unit="N.m");
    output Real torque_rate(unit="N.m/s");
    external "C" {prefix}_torque(instance, instant, angle, speed, command, command_rate, period, torque, torque_rate)
      {external};
  end step;

  model Drive "Controller, motor and gear up to the output shaft"
    Modelica.Mechanics.Rotational.Interfaces.Flange_b flange "Output of the gear";
    Modelica.Blocks.Interfaces.RealInput command(unit="{unit}") "Command of the controller, or of the motor in open loop";
    parameter Real period(unit="s") = {period!r} "Of the exchange with the drive";
    parameter Real hold(unit="N.m") = {coupled.hold!r} "Dry friction at which the output breaks away";
    parameter Real stiffness(unit="N.m/rad") = {coupled.stiffness!r} "Against what the output moves otherwise than expected";
    Modelica.Mechanics.Rotational.Components.BearingFriction friction(tau_pos=[0, hold]) if hold > 0;
    Real speed(unit="rad/s") "Of the output";
  protected
    Instance instance = Instance();
    discrete Real driving(unit="N.m", start=0, fixed=true);
    discrete Real driving_rate(unit="N.m/s", start=0, fixed=true);
    discrete Real instant(unit="s", start=0, fixed=true);
    discrete Real angle(unit="rad", start=0, fixed=true);
    discrete Real turning(unit="rad/s", start=0, fixed=true);
    Modelica.Mechanics.Rotational.Sources.Torque source(
      tau=driving + driving_rate * (time - instant) - stiffness * (flange.phi - angle - turning * (time - instant)));
  equation
    speed = der(flange.phi);
    when sample(0, period) then
      instant = time;
      angle = flange.phi;
      turning = speed;
      (driving, driving_rate) = step(instance, time, flange.phi, speed, command, 0.0, period);
    end when;
    connect(source.flange, flange);
    connect(friction.flange_a, flange);
  end Drive;

  model Example "A step of the command before an inertia"
    Drive drive;
    Modelica.Mechanics.Rotational.Components.Inertia inertia(
      J={inertia!r}, phi(start=0, fixed=true), w(start=0, fixed=true));
    Modelica.Blocks.Sources.Constant command(k=0.1);
  equation
    connect(command.y, drive.command);
    connect(drive.flange, inertia.flange_a);
    annotation(experiment(StopTime=1.0));
  end Example;
  annotation(uses(Modelica(version="4.0.0")));
end {name};
"""


MODELICA = Form(modelica, "Modelica", "a package with a flange, and its library", "modelica.md")
