"""A model is its header and its name in the list of its family, and nothing else: counted, and tried with one more."""

from __future__ import annotations

import re
import shutil
import subprocess
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from strainwave import _core

from tests.support.cplusplus import INCLUDE_FOLDER, ROOT, STRICT, compilation, compiler

HEADERS = INCLUDE_FOLDER / "strainwave"
SOURCE = ROOT / "src"
SOURCES = [
    path
    for folder in (INCLUDE_FOLDER, SOURCE, ROOT / "python" / "strainwave")
    for path in sorted(folder.rglob("*"))
    if path.suffix in {".hpp", ".cpp", ".py"}
]

# Where else a model is named, and why it must be.
BOUND_TO_ANY = "holds another law, which is any law where it is chosen at run time"
OF_EACH_RING = "whose state depends on the vibration of the ring, so that each is a law of its own"
DEFAULT = "what a drive has where nothing else is said"
STEADY_RUNNING = "steady running leaves the kinematic error out"
REACHED = "a log reaches some of the segments that a gear has, the first of them as one line"
SERIES = "stages become one spring, with which runs are faster"
PRINTED = "of a gear that a printed table of four stiffnesses is made into"
SHEET = "what a data sheet tells of a gear"
AT_REST = "a law of sliding of which the numbers stand in a law of bristles, too"
SAID = "the ratio that a person says of files"
RIGID = "what a rigid drive that is moved by hand or motor carries"
HEAT = "another Thermal: the heat of a drive, by any law"
MODEL = "the gear and the load that a model of the drive has by default"
GEAR_AND_LOAD = "whose gear and load are parameters of its type"
NOTHING = "what a compensation has where nothing else is said"
COMPOSED = ("tuning/", "workbench/", "orders/mesh/")  # drives are put together from models there, whatever else they are
TRIED = "identification/candidates/"  # where a fit of each model starts that is tried on a measurement, is said there
DIVIDED = "whose Coulomb and viscous friction a set divides where a file determines their sum"
ALONE = "that of a gear whose log determines no load or motor"
WRITTEN = "export/"  # another program has a place for some models only
LINEAR = "what has no linear model, and what takes its place"
SHAFTS_ALONE = "angles of both shafts show neither bodies within the gear nor a torque that depends on more than the twist"
ELSEWHERE = {
    "ModelFeedforward": {
        "parameter_drive.hpp": BOUND_TO_ANY,
        "general/compensation.cpp": BOUND_TO_ANY,
        "native/static_type.py": GEAR_AND_LOAD,
    },
    "FeedbackLinearisation": {
        "parameter_drive.hpp": BOUND_TO_ANY,
        "general/control.cpp": BOUND_TO_ANY,
        "native/static_type.py": GEAR_AND_LOAD,
    },
    "KinematicErrorTracking": {
        "parameter_drive.hpp": BOUND_TO_ANY,
        "general/control.cpp": BOUND_TO_ANY,
        "native/static_type.py": GEAR_AND_LOAD,
    },
    "NoObserver": {"compensation/compensation.hpp": NOTHING},
    "NoLearning": {"compensation/compensation.hpp": NOTHING},
    "NoFeedforward": {"compensation/compensation.hpp": NOTHING},
    "NoDither": {"compensation/compensation.hpp": NOTHING},
    "ThermalSoftening": {"drive_model.hpp": MODEL},
    "Fourier": {
        "drive_model.hpp": MODEL,
        "files/datasheet.py": SHEET,
        "orders/two_encoders.py": "orders that two encoders tell are of this form",
        "orders/over_temperature.py": "orders that two encoders tell are of this form",
        "kinematic_error/temperature_dependent.hpp": "what it varies by default",
        "kinematic_error/scaled.hpp": "what it scales by default",
        "kinematic_error/misalignment.hpp": "what a misalignment is to leading order",
        "fault/misalignment.hpp": "what a misalignment is to leading order",
        "laws.hpp": "what a misalignment is to leading order",
        "verbs.cpp": "the harmonics of any error are of this form",
        "analysis/steady.py": STEADY_RUNNING,
        "diagnose/inversion.py": "an error of every order, by which a drive is probed",
        "diagnose/smallest_error.py": "an error of one order, by which a drive is probed",
    },
    "ToothWear": {
        "spline_orders.py": "its waves have the orders of the splines",
        "diagnose/wear.py": "whose amounts it fits to tests of a gear",
    },
    "Growing": {"diagnose/wear.py": "whose scale it fits to tests of a gear"},
    "WaveGeneratorBearing": {"commands/diagnose.py": "whose geometry an option has, for the orders of its elements"},
    "Misalignment": {"diagnose/actuator_ramp.py": "the law that its study is about"},
    "Staged": {
        "analysis/torsion_loop.py": "whose springs a loop has in series with that of the flexspline",
        "parameter_drive.hpp": BOUND_TO_ANY,
        "general/structure.cpp": OF_EACH_RING,
        "diagnose/actuator_ramp.py": SERIES,
    },
    "Rigid": {"structure/staged.hpp": DEFAULT},
    "Modes": {
        "files/mesh_table.py": "the table of modes contains its numbers",
        "analysis/torsion_loop.py": "whose compliance a loop contains",
    },
    "Lumped": {
        "general/structure.cpp": OF_EACH_RING,
        "analysis/output_torque.py": SHAFTS_ALONE,
        "gear.hpp": DEFAULT,
        "native/kernels.py": "bodies within the gear make a step too long to be inlined",
        "diagnose/actuator_ramp.py": SERIES,
        "identification/kinds/between_encoders.py": "a log does not tell the springs of stages apart",
    },
    "Constant": {
        "analysis/output_torque.py": SHAFTS_ALONE,
        "gear.hpp": DEFAULT,
        "structure/staged.hpp": "what its springs do where nothing else is said",
    },
    "Scaled": {"parameter_drive.hpp": BOUND_TO_ANY},
    "TemperatureDependent": {
        "parameter_drive.hpp": BOUND_TO_ANY,
        "orders/over_temperature.py": "fitted to records at several temperatures",
    },
    "Viscous": {
        "identification/experiments/friction_table.py": "by which a place without friction is known",
    },
    "LoadDependent": {"files/datasheet.py": SHEET},
    "AccelerationSource": {
        "analysis/steady.py": "accelerates under any torque, so that there is no equilibrium",
        "identification/experiments/drive_log.py": "the input of a log moves as it was measured",
    },
    "CurrentSource": {
        "identification/kinds/prepared_log.py": "a log contains the current along a motion, whatever the motor",
        "identification/results/drive.py": ALONE,
    },
    "Coulomb": {
        "identification/results/identifiability.py": DIVIDED,
        "compensation/bristle_observer.hpp": "what follows the measured motion by default",
        "drive_model.hpp": MODEL,
        "files/datasheet.py": SHEET,
        "analysis/linear.py": "holds the input while the output vibrates",
        "friction/asymmetric.hpp": "what it modulates by default",
        "friction/thermal.hpp": "what it modulates by default",
        "identification/kinds/at_rest.py": AT_REST,
    },
    "MaxwellSlipFriction": {"identification/kinds/at_rest.py": AT_REST},
    "Stribeck": {
        "identification/results/identifiability.py": DIVIDED,
        "identification/kinds/at_rest.py": AT_REST,
        "friction/cyclic.hpp": "what it modulates by default",
    },
    "Asymmetric": {
        "parameter_drive.hpp": BOUND_TO_ANY,
    },
    "DC": {"identification/kinds/prepared_log.py": "of a log of voltage alone, less what a motor induces"},
    "OpenLoop": {
        "simulation/controller.py": "what a drive has for a controller where a function of Python is it",
        "identification/experiments/drive_log.py": "the motion of a log is the command itself",
    },
    "PID": {"control/sampled.hpp": "what it samples by default"},
    "Sampled": {
        "analysis/linear.py": LINEAR,
        "parameter_drive.hpp": BOUND_TO_ANY,
        "general/control.cpp": BOUND_TO_ANY,
        "native/static_type.py": "whose law and compensation are parameters of its type",
    },
    "BrushlessDC": {"files/gear_set.py": "suits every controller, so a set without a motor is checked with one"},
    "TorqueSource": {
        "analysis/linear.py": "a motor of which nothing counts but its inertia",
        "identification/results/drive.py": "the motor of a log whose torque was measured, and no current",
    },
    "PositionSpeed": {"control/cascade.hpp": "the outer loops of a cascade"},
    "Ideal": {
        "analysis/linear.py": LINEAR,
        "sensor/delayed.hpp": "what it delays by default",
        "sensor/noisy.hpp": "what it adds noise to by default",
        "sensor/quantised.hpp": "what it reads in steps by default",
    },
    "BristleObserver": {"parameter_drive.hpp": BOUND_TO_ANY},
    "Delayed": {"parameter_drive.hpp": BOUND_TO_ANY},
    "Encoder": {
        "analysis/linear.py": LINEAR,
    },
    "SineCosineEncoder": {"analysis/linear.py": LINEAR},
    "Noisy": {"analysis/linear.py": LINEAR, "parameter_drive.hpp": BOUND_TO_ANY},
    "Quantised": {"analysis/linear.py": LINEAR, "parameter_drive.hpp": BOUND_TO_ANY},
    "Isothermal": {"drive.hpp": DEFAULT},
    "NoMeter": {"drive.hpp": DEFAULT},
    "Inertia": {
        "identification/results/drive.py": ALONE,
        "drive_model.hpp": MODEL,
        "diagnose/response.py": "what a joint carries besides its inertia is in the recording",
        "identification/kinds/between_encoders.py": "what the load asks for is in the log, so that the motor has none",
        "identification/kinds/prepared_log.py": RIGID,
    },
    "StrainWave": {
        "drive_model.hpp": MODEL,
        "files/datasheet.py": SHEET,
        "identification/results/gear_so_far.py": SAID,
    },
    "Stochastic": {
        "analysis/steady.py": STEADY_RUNNING,
        "drive_model.hpp": MODEL,
        "kinematic_error/micro_slip.hpp": "whose random function excites the slip",
    },
    "Elastic": {"analysis/output_torque.py": SHAFTS_ALONE, "gear.hpp": DEFAULT},
    "LuGre": {
        "identification/results/identifiability.py": DIVIDED,
        "identification/kinds/at_rest.py": "whose breakaway torque ramps tell",
    },
    "Cyclic": {
        "parameter_drive.hpp": BOUND_TO_ANY,
        "identification/kinds/constant_speed.py": "waves found over the angle, around the friction that is known",
        "analysis/friction_curve.py": "a mean over the angle is that of the law within",
    },
    "TwoSided": {
        "parameter_drive.hpp": BOUND_TO_ANY,
    },
    "Thermal": {
        "parameter_drive.hpp": BOUND_TO_ANY,
        "general/heat.hpp": HEAT,
        "general/heat.cpp": HEAT,
        "general/drive.hpp": HEAT,
        "identification/kinds/warm_up.py": "how the friction that is known falls while a drive warms up",
    },
    "Preisach": {"parameter_drive.hpp": BOUND_TO_ANY},
    "PowerDensity": {"hysteresis/preisach.hpp": "its density by default"},
    "Pendulum": {
        "identification/results/drive.py": ALONE,
        "identification/experiments/drive_log.py": "a run under gravity starts hanging, so must the log that it is fitted to",
        "identification/experiments/motion_log.py": "gravity acts at the measured angle of the output, behind the wind-up",
        "identification/kinds/between_encoders.py": "gravity of the load that was fitted, along the motion of the log",
        "identification/kinds/predicted_log.py": "gravity depends on where the angle of a log counts from",
    },
    "Linear": {
        "drive_model.hpp": MODEL,
        "diagnose/actuator_ramp.py": SERIES,
        "rig/virtual/printed.py": PRINTED,
        "identification/kinds/between_encoders.py": REACHED,
    },
    "PlainRatio": {"identification/results/gear_so_far.py": SAID, "rig/virtual/printed.py": PRINTED},
    "Regimes": {"rig/virtual/printed.py": PRINTED},
    "ThreeSegment": {
        "files/datasheet.py": SHEET,
        "identification/kinds/between_encoders.py": REACHED,
    },
    "Cubic": {
        "stiffness/two_sided.hpp": "the spring at positive twist by default",
        "stiffness/backlash.hpp": "the spring behind its play by default",
    },
    "MultiCompliance": {"hysteresis/frictional_windup.hpp": "the two springs that it has friction between"},
    "Backlash": {"parameter_drive.hpp": BOUND_TO_ANY},
    "MaxwellSlip": {
        "drive_model.hpp": MODEL,
        "files/datasheet.py": SHEET,
        "identification/kinds/between_encoders.py": "elements of a log and of a torsion loop are counted",
    },
}

FAMILIES = _core.families | _core.fault_families
EVERY_MODEL = [
    pytest.param(model, id=f"{family}.{name}") for family, models in FAMILIES.items() for name, model in models.items()
]


@cache
def code(path: Path) -> str:
    """A source without its comments, documentation and texts; what it includes stays."""
    text = path.read_text()
    if path.suffix == ".py":
        text = re.sub(r'""".*?"""', "", text, flags=re.DOTALL)
        return re.sub(r"#.*", "", re.sub(r'"(\\.|[^"\\\n])*"', '""', text))
    text = re.sub(r'R"\(.*?\)"', '""', text, flags=re.DOTALL)
    return re.sub(r"//.*", "", re.sub(r'"(\\.|[^"\\\n])*"', '""', text))


@cache
def words(path: Path) -> frozenset[str]:
    """The words of a source, found once for all models."""
    return frozenset(re.findall(r"\w+", code(path)))


def naming(model: Any) -> set[Path]:
    """Where a model is named, but for the headers and lists of those of its name in other families.

    In Python the name of a fault or an onset is that of another class if there is such a class.
    """
    others = set(with_its_name(model)) - set(defining(model))
    named = {path for path in SOURCES if model.__name__ in words(path)}
    around = any(model in models.values() for models in _core.fault_families.values())
    if around and any(re.search(rf"\bclass {model.__name__}\b", code(path)) for path in named if path.suffix == ".py"):
        named = {path for path in named if path.suffix != ".py"}
    return named - others - {list_of(header) for header in others}


def defining(model: Any) -> list[Path]:
    headers = with_its_name(model)
    family = model.__module__.rpartition(".")[2]
    return headers if len(headers) == 1 else [header for header in headers if header.parent.name == family]


def with_its_name(model: Any) -> list[Path]:
    """The headers of models of its name; such a model may have a base, as in src a part of the general drive has."""
    name = model.__name__
    plain, derived = re.compile(rf"\bstruct {name} {{"), re.compile(rf"\bstruct {name} : [^{{;]* {{")
    return [
        path
        for path in SOURCES
        if name in words(path) and (plain.search(code(path)) or (path.is_relative_to(HEADERS) and derived.search(code(path))))
    ]


def list_of(header: Path) -> Path:
    """The list of a model's family: beside it, or above where the family is one header."""
    return next(path for folder in (header.parent, HEADERS) if (path := folder / "models.hpp").exists())


def name_of(path: Path) -> str:
    bases = (HEADERS, SOURCE, ROOT / "python" / "strainwave")
    return next(path.relative_to(base).as_posix() for base in bases if path.is_relative_to(base))


@pytest.mark.parametrize("model", EVERY_MODEL)
def test_a_model_is_named_in_its_header_and_in_the_list_alone(model: Any) -> None:
    (header,) = defining(model)
    elsewhere = {name_of(path) for path in naming(model) - {header, list_of(header)}}
    elsewhere = {name for name in elsewhere if not name.startswith((TRIED, *COMPOSED, WRITTEN))}
    assert elsewhere == set(ELSEWHERE.get(model.__name__, {}))


@pytest.mark.parametrize("model", EVERY_MODEL)
def test_the_list_names_a_model_once_and_includes_its_header_once(model: Any) -> None:
    (header,) = defining(model)
    listed = code(list_of(header))
    assert len(re.findall(rf"\b{model.__name__}\b", listed)) == 1
    includes = re.findall(r"#include <strainwave/(\S+)>", listed)
    brings = [name for name in includes if name == name_of(header) or f"<strainwave/{name_of(header)}>" in code(HEADERS / name)]
    assert brings  # itself, or by the law that holds it


def test_every_place_that_names_a_model_without_need_is_listed_here_with_its_reason() -> None:
    names = {model.__name__ for models in FAMILIES.values() for model in models.values()}
    assert set(ELSEWHERE) <= names
    assert all(len(reason) > 15 for places in ELSEWHERE.values() for reason in places.values())


PAGE = ROOT / "docs" / "contributing" / "add-a-law.md"  # whose example is the one more model
(QUADRATIC,) = re.findall(r"^```cpp\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
MAIN = """
#include <cstdio>
#include <memory>
#include <strainwave/integrate.hpp>
#include <vector>

#include "parameter_drive.hpp"
#include "general/friction.hpp"

using namespace strainwave;

/// The laws chosen, and the numbers, of parameters as Python holds them.
struct Apart {
    std::vector<int> laws;
    std::vector<double> numbers;

    template <class T>
    void operator()(const T& member, const Field&) {
        if constexpr (requires { member.model; }) {
            laws.push_back(int(member.model.index()));
            member.visit([&](const auto& law) { law.fields(law, *this); });
        } else if constexpr (std::is_same_v<T, double>) {
            numbers.push_back(member);
        }
    }
};

using Friction = general::Friction<double>;
using Chosen = AnyOf<double, friction::Models>;
template <class S>
using Varied = AtRunTime<friction::Thermal, S>;
using Viscous = friction::Viscous<double>;
using OneGear = Gear<double, kinematics::StrainWave<double>, kinematic_error::Fourier<double>,
                     kinematic_error::Stochastic<double>, stiffness::Linear<double>, hysteresis::MaxwellSlip<double>, Friction,
                     Viscous, Viscous, softening::ThermalSoftening<double>, structure::Lumped<double>>;
using OneDrive = Drive<double, control::OpenLoop<double>, motor::DC<double>, OneGear, load::Inertia<double>,
                       Sensors<double, sensor::Ideal<double>>>;

int main() {
    Apart apart;
    apart(Chosen{Varied<double>{{friction::Quadratic<double>{.drag = 2e-5}}}}, {});
    std::vector<std::shared_ptr<const void>> kept;
    kernel::Reader<double> from{apart.laws.data(), nullptr, apart.numbers.data(), &kept};

    OneDrive drive{};
    drive.motor = {.resistance = 2.0, .torque_constant = 0.05, .back_emf = 0.05, .inertia = 1e-4};
    drive.gear.damping = 1.0;
    drive.gear.friction_input.read(from);
    auto state = drive.rest();
    const Interval<Input<double>> input{{12.0}, {12.0}, {12.0}};
    for (int i = 0; i < 20000; ++i) state = step(drive, state, input, 1e-4);
    std::printf("%.15g", state.continuous.input_speed);
}
"""


def with_one_more(folder: Path) -> Path:
    """The headers, and among them a model that nobody has thought of: its file, its include, its name in the list."""
    include = folder / "include"
    shutil.copytree(INCLUDE_FOLDER, include)
    (include / "strainwave/friction/quadratic.hpp").write_text(QUADRATIC)
    models = include / "strainwave/friction/models.hpp"
    before = models.read_text()
    after = before.replace(
        "#include <strainwave/friction/stribeck.hpp>\n",
        "#include <strainwave/friction/quadratic.hpp>\n#include <strainwave/friction/stribeck.hpp>\n",
    )
    after, lists = re.subn(r"(using Levelled = List<Viscous[^>]*)>", r"\1, Quadratic>", after)
    assert lists == 1
    assert len(after.splitlines()) == len(before.splitlines()) + 1
    models.write_text(after)
    return include


def options(include: Path) -> list[str]:
    """Those of a source that includes headers of this folder and of the host."""
    own = [f"-I{include}" if option == f"-I{INCLUDE_FOLDER}" else option for option in STRICT]
    return [*own, f"-I{SOURCE}", "-Wno-missing-field-initializers"]


@pytest.mark.slow("build")
def test_one_more_model_runs_in_a_drive_that_chooses_it_at_run_time(tmp_path: Path) -> None:
    """It settles where the motor's torque is the drag: K (u - k v) / R = q v^2."""
    (tmp_path / "main.cpp").write_text(MAIN)
    sources = ["main.cpp", SOURCE / "general" / "friction.cpp"]
    command = [*compiler("g++"), *options(with_one_more(tmp_path)), "-O1", *sources, "-o", "main"]
    built = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (built.returncode, built.stderr) == (0, "")
    speed = float(subprocess.run([tmp_path / "main"], capture_output=True, text=True, check=True).stdout)
    drag, constant, resistance, voltage = 2e-5, 0.05, 2.0, 12.0
    slope, level = constant**2 / resistance, constant * voltage / resistance
    assert speed == pytest.approx((-slope + (slope**2 + 4.0 * drag * level) ** 0.5) / (2.0 * drag), rel=1e-6)


@pytest.mark.slow("build")
def test_a_model_that_is_not_in_the_list_is_not_there(tmp_path: Path) -> None:
    """So that the run above does show the list at work: all that is missing is the name in the list."""
    include = with_one_more(tmp_path)
    models = include / "strainwave/friction/models.hpp"
    models.write_text(models.read_text().replace(", Quadratic>", ">"))
    status, said = compilation(compiler("g++"), tmp_path, {"main.cpp": MAIN}, *options(include), "-fsyntax-only")
    assert status != 0
    errors = [line for line in said.splitlines() if " error: " in line]
    assert errors
    assert all("Quadratic" in error for error in errors)
