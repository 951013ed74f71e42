"""Modelica packages of drives: their functions in C, called as a Modelica tool calls them, and their text."""

import ctypes
import subprocess
from functools import cache

import numpy as np
import pytest
import strainwave as sw
from strainwave.export import modelica_package
from strainwave.native.compilers import NoCompilerError
from typer.testing import CliRunner

DRIVE = "position-drive"
PARTS = """
package Modelica
  package Mechanics package Rotational
    package Interfaces
      connector Flange_a Real phi(unit="rad"); flow Real tau(unit="N.m"); end Flange_a;
      connector Flange_b Real phi(unit="rad"); flow Real tau(unit="N.m"); end Flange_b;
    end Interfaces;
    package Components
      model Inertia Interfaces.Flange_a flange_a; Interfaces.Flange_b flange_b; parameter Real J; Real phi; Real w;
      equation phi = flange_a.phi; phi = flange_b.phi; w = der(phi); J * der(w) = flange_a.tau + flange_b.tau; end Inertia;
      model BearingFriction Interfaces.Flange_a flange_a; Interfaces.Flange_b flange_b; parameter Real tau_pos[:, 2];
      equation flange_a.phi = flange_b.phi; flange_a.tau + flange_b.tau = tau_pos[1, 2] * sign(der(flange_a.phi));
      end BearingFriction;
    end Components;
    package Sources
      model Torque Interfaces.Flange_b flange; input Real tau; equation flange.tau = -tau; end Torque;
    end Sources;
  end Rotational; end Mechanics;
  package Blocks
    package Interfaces connector RealInput = input Real; connector RealOutput = output Real; end Interfaces;
    package Sources
      block Constant parameter Real k = 1; Interfaces.RealOutput y; equation y = k; end Constant;
    end Sources;
  end Blocks;
end Modelica;
"""  # of the Modelica Standard Library, which rumoca does not contain


@cache
def exported():
    return sw.export.modelica(sw.GearSet.read(DRIVE))


def library_of(found):
    return next(content for name, content in found.files.items() if "/Library/" in name)


@pytest.mark.slow("export")
def test_error_falls_with_the_period():
    coarse, fine = exported().losses
    assert coarse.size > 0.05
    assert coarse.rms_share < 2e-4
    assert fine.largest < 0.6 * coarse.largest  # of first order


@pytest.mark.slow("export")
def test_a_command_without_rate_goes_on_at_that_of_the_last_period(tmp_path):
    path = tmp_path / "drive.so"
    path.write_bytes(library_of(exported()))
    open_, step = (getattr(ctypes.CDLL(str(path)), f"strainwavedrive_{each}") for each in ("open", "torque"))
    open_.restype, step.restype = ctypes.c_void_p, None
    step.argtypes = ctypes.c_void_p, *[ctypes.c_double] * 6, *[ctypes.POINTER(ctypes.c_double)] * 2
    torques, period = [], 1e-3
    for rate in (0.0, 0.5):
        drive, torque, torque_rate = open_(), ctypes.c_double(), ctypes.c_double()
        for k in range(50):  # the first period has no last one
            step(drive, k * period, 0.0, 0.0, 0.5 * max(k - 1, 0) * period, rate * (k > 1), period, torque, torque_rate)
        torques.append(torque.value)
    assert abs(torques[0]) > 0.1
    assert torques[0] == pytest.approx(torques[1], rel=1e-2)


@pytest.mark.slow("export")
def test_header_is_c_and_sources_compile_by_the_command_of_the_remark(tmp_path):
    prefix = "StrainWaveDrive/Resources/"
    for name, content in exported().files.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    command = next(each for each in exported().remarks if "c++ " in each).partition(": ")[2].split()
    subprocess.run(command, check=True, cwd=tmp_path / prefix / "Source")
    caller = tmp_path / "caller.c"
    caller.write_text(
        '#include "strainwavedrive.h"\n#include <stdio.h>\n'
        "int main(void) { void *one = strainwavedrive_open(); double torque, rate;\n"
        "for (int i = 0; i < 100; ++i) strainwavedrive_torque(one, 1e-3 * i, 0.0, 0.0, 0.01, 0.0, 1e-3, &torque, &rate);\n"
        'strainwavedrive_close(one); printf("%.3f", torque); return 0; }\n'
    )
    library = tmp_path / prefix / "Source/libstrainwavedrive.so"
    flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", f"-I{tmp_path / prefix / 'Include'}"]
    subprocess.run(["cc", *flags, str(caller), str(library), "-o", str(tmp_path / "caller")], check=True)
    done = subprocess.run([tmp_path / "caller"], check=True, capture_output=True, text=True)
    drive = sw.GearSet.read(DRIVE).drive.replace(load=sw.loads.Prescribed())
    held = sw.simulate(drive, sw.scenario.constant(0.01, 0.099), 2e-4, initial={"current": 0.0})
    assert float(done.stdout) == pytest.approx(held["load_torque"][-1], abs=2e-3)
    assert abs(held["load_torque"][-1]) > 0.1


def test_text_is_flattened_by_rumoca_up_to_what_it_does_not_support():
    """rumoca reports what is wrong with names, types and calls before; external objects are the first that it refuses."""
    rumoca = pytest.importorskip("rumoca")
    text = exported().files["StrainWaveDrive/package.mo"].removeprefix("within;") + PARTS
    assert all("external-purity-undeclared" in str(each) for each in rumoca.validate_source(text))
    refused = "has unsupported type `Instance`"
    for broken, message in (
        (text, refused),
        (text.replace("connect(source.flange, flange)", "connect(source.axis, flange)"), "unresolved component reference"),
        (text.replace("command, 0.0, period)", "command)"), "has no argument and no default"),
    ):
        with pytest.raises(rumoca.CompileError) as caught:
            rumoca.Session().loads(broken, model="StrainWaveDrive.Example")
        assert message in str(caught.value)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [({"name": "a-b"}, "must be a name in Modelica"), ({"period": 0.0}, "period"), ({"drive": "csg-20-100"}, r"no \[motor\]")],
)
def test_wrong_arguments_are_refused(arguments, message):
    given = {"drive": DRIVE} | arguments
    with pytest.raises(ValueError, match=message):
        sw.export.modelica(sw.GearSet.read(given.pop("drive")), **given)


def test_command_writes_a_package_or_names_the_missing_compiler(tmp_path, monkeypatch):
    from strainwave.commands.export import export as verb

    def none():
        raise NoCompilerError("there is no C++20 compiler")

    library = library_of(exported())
    monkeypatch.setattr(modelica_package, "shared_library", lambda *_: library)
    words = ["modelica", DRIVE, "--out", str(tmp_path)]
    result = CliRunner().invoke(verb, words)
    assert result.exit_code == 0, result.output
    assert (tmp_path / "StrainWaveDrive/package.mo").is_file()
    assert np.isfinite(exported().numbers["period"][0])
    monkeypatch.undo()
    monkeypatch.setattr("strainwave.export.coupled.drive.find_compiler", none)
    assert isinstance(CliRunner().invoke(verb, words).exception, NoCompilerError)
