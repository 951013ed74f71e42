"""Every tutorial runs from its first cell to its last, shows a picture, and finds the files that it needs."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import tutorials

from tests.evidence import tutorial_joint

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "examples" / "tutorials"
SCRIPTS = sorted(FOLDER.glob("*.py"))
MAX_BYTES = 150_000  # of a file that belongs to a tutorial


def robot_log(page: str) -> None:
    """All numbers are right within their standard deviations, which contain the choice of the law of friction."""
    distances = dict(re.findall(r"^((?:gear|load)\.\S+) +\S+ +\S+ +(-?\d+\.\d)$", page, re.MULTILINE))
    assert len(distances) == 5
    assert max(abs(float(distance)) for distance in distances.values()) < 2.0


def wrong_assumptions(page: str) -> None:
    """Each wrong assumption but the last fails the checks that the text names."""
    sections = page.split("\n## ")[1:]
    assert re.findall(r"^exit code (\d)$", sections[0], re.MULTILINE) == ["2", "3"]
    assert "FAILED: friction_colleague.csv: its input would turn at 3000 rad/s" in sections[0]
    for section, names in ((1, ["input speed", "friction of the start set"]), (3, ["agreement of files"])):
        assert re.findall(r"^([a-z][a-z ]+): ", sections[section], re.MULTILINE) == names
    assert {"unexplained on held-out data", "input speed"} <= set(re.findall(r"^([a-z -]+): ", sections[2], re.MULTILINE))
    assert re.findall(r"(\d+) failed checks", sections[4]) == ["0", "0"]
    single, double = (float(text) for text in re.findall(r"load\.gravity_torque +(\S+)", sections[4]))
    assert double == pytest.approx(2.0 * single, rel=1e-3)


def second_log(page: str) -> None:
    """The changes are those of the truth, within three standard deviations, and no others."""
    found = re.findall(r"^(\S+\.csv): (\w+): error .*\n((?:  .*\n)*)", page, re.MULTILINE)
    assert [(name, verdict) for name, verdict, _ in found] == [
        ("robot_log_later.csv", "agrees"), ("robot_log_worn.csv", "differs"), ("robot_log_tool.csv", "contradicts"),
    ]  # fmt: skip
    truth = {"dry friction": 1.3, "inertia of the load": 1.188, "gravity of the load": 16.0 / 11.0}
    changes = re.findall(r"  (.+) is (\S+) ± (\S+) times that saved\n", "".join(text for _, _, text in found))
    assert [name for name, _, _ in changes] == list(truth)
    assert [name for name, value, sigma in changes if abs(float(value) - truth[name]) > 3.0 * float(sigma)] == []


def which_friction(page: str) -> None:
    """The law with a fall at low speed is the first; without slow speeds it is not; the numbers are those of the truth."""
    assert re.search(r"cost \[µs\]\n  with a fall at low speed +4 ", page)
    assert "law taken: Coulomb and viscous\n" in page
    assert re.search(r"determined only together: .*friction_input\.breakaway by .*friction_input\.stribeck_speed by", page)
    known = re.findall(r" (\S+) ± (\S+) +truth (\S+) ", page)
    assert len(known) == 4
    assert [row for row in known if abs(float(row[0]) - float(row[2])) > 2.0 * float(row[1])] == []


def simulated_joint(page: str) -> None:
    """The resonance lies between the two computed speeds. Wind-up has the largest share of the error."""
    sticks, slides = (int(text) for text in re.findall(r"meets it at (\d+) rad/s", page))
    peak = int(re.findall(r"^largest ripple .* at (\d+) rad/s", page, re.MULTILINE)[0])
    assert slides < peak < sticks
    shares = {
        name.strip(): (int(off), int(on))
        for name, off, on in re.findall(r"^(.+) without it +(\d+) .* (\d+) µrad$", page, re.MULTILINE)
    }
    assert set(shares) == {"kinematic error", "wind-up", "hysteresis", "friction"}
    assert min(shares, key=lambda name: shares[name][0]) == max(shares, key=lambda name: shares[name][1]) == "wind-up"


def torsion_rig(page: str) -> None:
    """The gear found is that on the rig within 1 %."""
    pairs = re.findall(r" ([\d.]+) (?:N\.m/rad|N\.m) found, +([\d.]+) true", page)
    assert len(pairs) == 5
    assert [pair for pair in pairs if float(pair[0]) != pytest.approx(float(pair[1]), rel=0.01)] == []


def misalignment(page: str) -> None:
    """Order 2 is found under load only, and the misaligned joint alone differs from the baseline."""
    assert re.findall(r"insensitive: (True|False)$", page, re.MULTILINE) == ["True", "False"]
    assert re.findall(r"order 2: .* detected: (True|False)$", page, re.MULTILINE) == ["False", "True"]
    assert re.findall(r"^(\w+)\.csv: (.+)$", page, re.MULTILINE) == [("later", "no change found"), ("misaligned", "changed")]
    assert "\nexit code 3\n" in page


def exports(page: str) -> None:
    """Each program gives the numbers of the simulation; MuJoCo, whose joint has no torsion, within 0.2 %."""
    ours, theirs = (float(text) for text in re.findall(r"(\S+) rad after 2 s$", page, re.MULTILINE))
    assert theirs == pytest.approx(ours, rel=2e-3)
    differences = re.findall(r"largest difference (\S+e-\d+) of (\S+)$", page, re.MULTILINE)
    assert len(differences) == 2
    assert all(float(difference) < 1e-12 * float(size) for difference, size in differences)
    assert "the same to the last bit: True" in page


def fault_data(page: str) -> None:
    """The past of a unit is the best detector. A split by rows learns a label without meaning."""
    areas = {
        name.strip(): float(area)
        for name, area in re.findall(r"^(.+) area under the ROC curve (0\.\d+|1\.00)", page, re.MULTILINE)
    }
    assert areas["order 2 over its own past"] > areas["detector"] > areas["rms of the current"] + 0.2
    assert areas["rows split at random"] > areas["units split"] + 0.1
    misaligned, healthy = (int(count) for count in re.findall(r"(\d+) alarms in 20", page))
    assert healthy == 0
    assert misaligned > 15


CLAIMS: dict[str, Callable[[str], None]] = {
    "01_robot_log": robot_log,
    "02_wrong_assumptions": wrong_assumptions,
    "03_second_log": second_log,
    "04_simulate_a_joint": simulated_joint,
    "05_which_friction": which_friction,
    "06_torsion_rig": torsion_rig,
    "07_misalignment": misalignment,
    "08_use_it": exports,
    "09_fault_data": fault_data,
}  # of the text of a tutorial, about what its cells print


@pytest.mark.slow("docs")
@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_a_tutorial_runs_and_shows_what_it_draws(script: Path, tmp_path: Path) -> None:
    tutorials.write_page(script, tmp_path)
    page = (tmp_path / f"{script.stem}.md").read_text(encoding="utf-8")
    pictures = re.findall(r"^!\[.+\]\((.+)\)$", page, re.MULTILINE)
    assert pictures
    assert sorted(path.name for path in tmp_path.glob("*.png")) == sorted(pictures)
    assert page.startswith("# ")
    downloads = re.findall(r"\{download\}`([^`]+)`", page)
    assert downloads[0] == script.name
    assert [name for name in downloads if not (tmp_path / name).is_file()] == []
    CLAIMS[script.stem](page)


def test_the_files_of_tutorials_are_small_text_and_each_is_used() -> None:
    texts = [script.read_text(encoding="utf-8") for script in SCRIPTS]
    for path in FOLDER.glob("*.*"):
        if path.suffix != ".py":
            assert len(path.read_text(encoding="utf-8").encode()) <= MAX_BYTES, path.name
            assert any(tutorials.is_named(path.name, text) for text in texts), path.name


@pytest.mark.slow("docs")
@pytest.mark.skipif(not (tutorial_joint.RIG / "joint.c").is_file(), reason="the joint of another program was not found")
def test_the_supplied_files_are_those_of_the_joint(tmp_path: Path) -> None:
    """A change of a file, or of the joint, would make the truths of the tutorials wrong."""
    tutorial_joint.main(tmp_path)
    made = sorted(tmp_path.glob("*.csv"))
    assert len(made) == 6
    for path in made:
        supplied, anew = (np.loadtxt(file, delimiter=",", skiprows=1) for file in (FOLDER / path.name, path))
        # the last digits depend on the rounding of the compiler's arithmetic
        np.testing.assert_allclose(supplied, anew, rtol=1e-3, atol=2e-3, err_msg=path.name)


def test_the_page_of_tutorials_lists_each() -> None:
    text = (ROOT / "docs" / "tutorials" / "index.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| \[(\d) · ([^\]]+)\]\(../../examples/tutorials/(\S+)\) \|", text, re.MULTILINE)
    titles = {script.name: script.read_text(encoding="utf-8").splitlines()[1] for script in SCRIPTS}
    assert {script: f"# # {title}" for _, title, script in rows} == titles
    assert [f"0{number}" for number, _, _ in rows] == [name[:2] for name in titles]


@pytest.mark.slow("docs")
@pytest.mark.parametrize(
    ("cell", "message"),
    [
        ("# %%\nvalue = 1.0\nvalue / 0", r"^wrong\.py, line 6: ZeroDivisionError: "),
        ("# %%\nvalue =", r"^wrong\.py, line 5: SyntaxError: "),
        (
            "# %% [console]\n# $ echo one\n# $ strainwave nonsense | cat",
            r"^wrong\.py, line 6: exit code 2 of strainwave nonsense",
        ),
        ("# %% [markdown]\n# An interval of 95\n# %.", r"^wrong\.py, line 6: begins with %"),
    ],
)
def test_a_cell_that_fails_is_named_with_its_line(cell: str, message: str, tmp_path: Path) -> None:
    script = tmp_path / "wrong.py"
    script.write_text(f"# %% [markdown]\n# # Wrong\n\n{cell}\n")
    with pytest.raises(tutorials.TutorialError, match=message):
        tutorials.run_alone(script, tmp_path / "out")


@pytest.mark.slow("docs")
def test_code_must_not_need_what_a_command_wrote(tmp_path: Path) -> None:
    """A script that is run as a whole has no commands."""
    script = tmp_path / "wrong.py"
    script.write_text(
        '# %% [markdown]\n# # Wrong\n\n# %% [console]\n# $ echo one > made.csv\n# $ cat made.csv\n\n# %%\nopen("made.csv")\n'
    )
    with pytest.raises(tutorials.TutorialError, match=r"^wrong\.py, line 9: FileNotFoundError: "):
        tutorials.run_alone(script, tmp_path / "out")


@pytest.mark.slow("docs")
def test_a_page_shows_what_cells_print_and_draw(tmp_path: Path) -> None:
    """The folder of a tutorial has its data; a command that may fail shows its exit code."""
    (tmp_path / "data.csv").write_text("1\n2\n")
    script = tmp_path / "01_name.py"
    script.write_text(
        "# %% [markdown]\n# # Title\n#\n# Words.\n\n"
        '# %%\nimport subprocess\n\nprint(open("data.csv").read().split())\nsubprocess.run(["echo", "two"])\n\n'
        '# %% [console]\n# $ cat data.csv \\\n#   | tail -n 1\n# $ false || echo "exit code $?"\n\n'
        '# %%\nimport matplotlib.pyplot as plt\n\n_ = plt.figure().suptitle("a square")\n'
    )
    out = tmp_path / "out"
    tutorials.run_alone(script, out)
    page = (out / "01_name.md").read_text()
    assert page.startswith("# Title\n\n*To try it yourself")
    assert "{download}`01_name.py`, {download}`data.csv`\n\nWords.\n\n```python\n" in page
    assert ":class: output\n\n['1', '2']\ntwo\n```" in page
    assert '```console\n$ cat data.csv \\\n  | tail -n 1\n2\n$ false || echo "exit code $?"\nexit code 1\n```' in page
    (picture,) = re.findall(r"^!\[a square\]\((.+)\)$", page, re.MULTILINE)
    assert (out / picture).stat().st_size > 1000
