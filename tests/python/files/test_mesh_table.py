"""Tables of finite-element models: long and wide, in every kind of file, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from strainwave.files import MeshTable, ModeTable

ANGLE = np.arange(0.0, 360.0, 10.0)  # deg
LOADS = np.array([-10.0, 0.0, 2.5])  # N.m
ERROR = np.random.default_rng(0).normal(0.0, 1e-4, (len(ANGLE), len(LOADS)))
EXPECTED = MeshTable(
    np.radians(np.tile(ANGLE, 3)), np.repeat(LOADS, len(ANGLE)), transmission_error=ERROR.T.ravel(), source="by hand"
)


def rows(table: MeshTable) -> np.ndarray:
    assert table.transmission_error is not None
    columns = np.stack([table.angle, table.torque, table.transmission_error])
    return np.asarray(columns[:, np.lexsort((table.angle, table.torque))])


def agrees(table: MeshTable) -> bool:
    return np.allclose(rows(table), rows(EXPECTED), rtol=1e-12, atol=0.0)


def long_csv(folder: Path, header: str = "angle [deg],torque [N.m],transmission_error [rad]") -> Path:
    (folder / "mesh.csv").write_text(
        "\n".join(
            [
                header,
                *(
                    f"{a!r},{t!r},{float(ERROR[i, j])!r}"
                    for i, a in enumerate(ANGLE.tolist())
                    for j, t in enumerate(LOADS.tolist())
                ),
            ]
        )
    )
    return folder / "mesh.csv"


def test_a_row_for_each_angle_and_load(tmp_path: Path) -> None:
    assert agrees(MeshTable.read(long_csv(tmp_path)))


def test_rows_may_have_any_order(tmp_path: Path) -> None:
    header, *lines = long_csv(tmp_path).read_text().splitlines()
    np.random.default_rng(1).shuffle(lines)
    (tmp_path / "shuffled.csv").write_text("\n".join([header, *lines]))
    assert agrees(MeshTable.read(tmp_path / "shuffled.csv"))


def test_other_names_and_units_are_given(tmp_path: Path) -> None:
    path = long_csv(tmp_path, "phi,load (N.m),TE")
    names = {"angle": "phi", "torque": "load", "transmission_error": "TE"}
    assert agrees(MeshTable.read(path, columns=names, units={"angle": "deg", "transmission_error": "rad"}))
    with pytest.raises(ValueError, match=r'has no column angle; it has phi, load, TE; name it as columns=\{"angle": "phi"\}'):
        MeshTable.read(path)


@pytest.mark.parametrize("of_load", ["{} N.m", "({} Nm)", "@ {} N.m", "= {}e3 mN.m"])
def test_a_column_for_each_load(tmp_path: Path, of_load: str) -> None:
    names = [f"transmission_error {of_load.format(load)} [rad]" for load in LOADS.tolist()]
    lines = [";".join([repr(a), *map(repr, row)]) for a, row in zip(ANGLE.tolist(), ERROR.tolist(), strict=True)]
    (tmp_path / "wide.csv").write_text("\n".join([";".join(["angle [deg]", *names]), *lines]))
    assert agrees(MeshTable.read(tmp_path / "wide.csv"))


UNITS = {"angle": "deg", "torque": "N.m", "transmission_error": "rad"}
ARRAYS = {"angle": ANGLE, "torque": LOADS, "transmission_error": ERROR}


def test_matrices_of_numpy_matlab_hdf5_and_json(tmp_path: Path) -> None:
    scipy_io, h5py = pytest.importorskip("scipy.io"), pytest.importorskip("h5py")
    np.savez(tmp_path / "a.npz", **ARRAYS)
    scipy_io.savemat(tmp_path / "a.mat", {"mesh": ARRAYS})  # a structure
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for name, values in ARRAYS.items():
            file[f"case1/{name}"] = values
    (tmp_path / "a.json").write_text(json.dumps({name: values.tolist() for name, values in ARRAYS.items()}))
    for name in ("a.npz", "a.mat", "a.h5", "a.json"):
        assert agrees(MeshTable.read(tmp_path / name, units=UNITS)), name


def test_long_arrays_and_units_in_their_names(tmp_path: Path) -> None:
    names = ("angle [rad]", "torque [N.m]", "transmission_error [rad]")
    np.savez(tmp_path / "a.npz", **dict(zip(names, rows(EXPECTED), strict=True)))
    assert agrees(MeshTable.read(tmp_path / "a.npz"))


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("angle [deg],torque [N.m],transmission_error [rad]\n0,1,nan\n", r"line 2.*transmission_error.*nan"),
        ("angle [deg],torque [N.m],transmission_error [rad]\n0,1,2\n0,1,3\n", r"rows 0 and 1 are both at 0 deg and 1 N\.m"),
        ("angle [deg],torque [N],transmission_error [rad]\n0,1,2\n", r'cannot convert "N" to "N\.m"'),
        ("angle [mm],torque [N.m],transmission_error [rad]\n0,1,2\n", r'cannot convert "mm" to "rad"'),
        ("angle [deg],torque [N.m],stiffness [N/m]\n0,1,2\n", r"column \"stiffness\": cannot convert"),
        ("angle [deg],torque [N.m],stiffness [N.m/rad]\n0,1,0\n", r"stiffness is 0 N\.m/rad in row 0; it must be positive"),
        ("angle [deg],transmission_error [rad]\n0,1\n", r"has no column torque.*or add it: 0 N\.m of a table without load"),
        (
            "angle [deg],torque [N.m],te [rad]\n0,1,2\n",
            r"has none of transmission_error, stiffness, mesh_stiffness; it has angle",
        ),
        ("angle [deg],torque [N.m],transmission_error 1 N.m [rad]\n0,1,2\n", r"columns of single loads and a column torque"),
        ("angle [deg],transmission_error 1 N.m [rad],transmission_error 1.0 N.m [rad]\n0,1,2\n", r"are both at 1 N\.m"),
        ("angle [deg],transmission_error 1 N.m [rad],stiffness 2 N.m [N.m/rad]\n0,1,2\n", r"stiffness is missing at 1 N\.m"),
    ],
)
def test_what_is_wrong_is_refused_with_its_place(tmp_path: Path, text: str, reason: str) -> None:
    (tmp_path / "mesh.csv").write_text(text)
    with pytest.raises(ValueError, match=reason):
        MeshTable.read(tmp_path / "mesh.csv")


def test_arrays_are_checked() -> None:
    with pytest.raises(ValueError, match="transmission_error is nan in row 1; it must be finite"):
        MeshTable([0.0, 1.0], [0.0, 0.0], transmission_error=[0.0, np.nan])
    with pytest.raises(ValueError, match="torque has 1 rows, angle has 2"):
        MeshTable([0.0, 1.0], [0.0], transmission_error=[0.0, 1.0])
    with pytest.raises(ValueError, match="needs one of transmission_error, stiffness, mesh_stiffness"):
        MeshTable([0.0, 1.0], [0.0, 0.0])


def test_modes_with_their_mass_or_their_shape(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("frequency [kHz],waves [1],damping [1],mass [g]\n1.8,2,0.01,50\n5.1,3,0.02,40\n")
    (tmp_path / "b.csv").write_text("frequency [Hz],ND [1],damping [1],shape_squared [1/kg]\n1800,2,0.01,20\n5100,3,0.02,25\n")
    angular = [2 * np.pi * 1800.0, 2 * np.pi * 5100.0]  # and shares without a unit
    rows = f"frequency [rad/s],ND,damping,mass [kg]\n{angular[0]},2,0.01,0.05\n{angular[1]},3,0.02,0.04\n"
    (tmp_path / "c.csv").write_text(rows)
    first = ModeTable.read(tmp_path / "a.csv")
    second, third = (ModeTable.read(tmp_path / name, columns={"waves": "ND"}) for name in ("b.csv", "c.csv"))
    for table in (first, second, third):
        assert table.frequency.tolist() == pytest.approx([1800.0, 5100.0], rel=1e-15)
        assert table.waves.tolist() == [2.0, 3.0]
        np.testing.assert_allclose(table.mass, [0.05, 0.04], rtol=1e-15)
        np.testing.assert_allclose(table.compliance[0], 1.0 / (0.05 * (2 * np.pi * 1800.0) ** 2), rtol=1e-14)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("frequency [Hz],waves [1],damping [1]\n1,2,0.1\n", "needs one of the columns mass and shape_squared"),
        ("frequency [Hz],waves [1],mass [kg]\n1,2,0.1\n", "has no column damping.*measure it, or assume 0.01"),
        ("frequency [Hz],waves [1],damping [1],mass [kg]\n1,2.5,0.1,1\n", "waves must be whole numbers of 0 or more, not 2.5"),
        ("frequency [Hz],waves [1],damping [1],mass [kg]\n0,2,0.1,1\n", "frequency is 0 in row 0.*leave rigid motions out"),
        ("frequency [Hz],waves [1],damping [1],mass [kg]\n1,2,1.5,1\n", "damping is 1.5 in row 0; it must be below 1"),
        ("frequency [Hz],waves [1],damping [1],shape_squared [1/kg]\n1,2,0.5,0\n", "a mode that does not move the mesh"),
    ],
)
def test_modes_that_cannot_be_are_refused(tmp_path: Path, text: str, reason: str) -> None:
    (tmp_path / "modes.csv").write_text(text)
    with pytest.raises(ValueError, match=reason):
        ModeTable.read(tmp_path / "modes.csv")


def test_a_mesh_stiffness_at_the_output_needs_its_lever(tmp_path: Path) -> None:
    (tmp_path / "mesh.csv").write_text("angle [deg],torque [N.m],mesh_stiffness [N.m/rad]\n0,1,2\n")
    with pytest.raises(ValueError, match=r"give lever=pitch radius x cos\(pressure angle\) \[m\]"):
        MeshTable.read(tmp_path / "mesh.csv")
    found = MeshTable.read(tmp_path / "mesh.csv", lever=0.1)
    assert found.mesh_stiffness is not None
    assert found.mesh_stiffness.tolist() == pytest.approx([200.0])


def test_the_two_shapes_of_a_mode_that_travels_are_one_mode() -> None:
    squares = np.array([0.117, 0.221, 0.4, 0.4, 0.3, 0.3])  # n = 2, 20 deg: sin^2 and cos^2 / 4 by the phase of the shapes
    frequency = np.array([1000.0, 1000.2, 2000.0, 2000.0, 1000.0, 3000.0])
    waves = np.array([2.0, 2.0, 0.0, 0.0, 3.0, 3.0])  # two modes that do not travel are no pair, nor are others of 3 waves
    modes = ModeTable(frequency, waves, np.full(6, 0.01), 1.0 / squares)
    assert 1.0 / modes.joined.mass == pytest.approx([0.338, 0.4, 0.4, 0.3, 0.3])
    assert modes.joined.joined == modes.joined
    assert len(modes.ring.mass) == 4
    assert modes.remarks[0] == "1 pair of rows with equal waves and frequency joined to one mode each"
    assert modes.remarks[1].startswith("a ring has 4 modes; left out: 3000 Hz")
    whole = ModeTable(frequency[:1], waves[:1], np.array([0.01]), 1.0 / squares[:1] / 2.0)
    assert whole.joined == whole
    assert whole.remarks == []
