"""The page of a report as a file: self-contained, repeatable, readable on a narrow screen."""

from __future__ import annotations

import html as markup
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from strainwave.drawing import marks
from strainwave.drawing.style import FIGURE_WIDTH, LIGHT
from strainwave.identification.identify import Identified
from strainwave.identification.joints import Joints
from strainwave.report import figures
from strainwave.report.identify import identify_report
from strainwave.report.joints import joints_report
from strainwave.report.provenance import Provenance

from tests.python.report.measured import HOSTILE, swing
from tests.python.report.reading import Node, Page, points


@pytest.mark.whole_path("report")
def test_the_page_is_well_formed_and_no_name_stands_twice(html: str) -> None:
    names = [node.attributes["id"] for node in Page(html).root.walk() if "id" in node.attributes]
    assert len(names) == len(set(names))
    references = re.findall(r"(?:href=\"|url\()#([^\")]+)", html)
    assert references
    assert set(references) <= set(names)


@pytest.mark.whole_path("report")
def test_the_page_refers_to_nothing_outside_itself(html: str) -> None:
    assert not re.search(r"https?:|//\w|@import|<link|<img|<iframe|<script", html)
    for reference in re.findall(r"(?:href|src)=\"([^\"]*)|url\(([^)]*)", html):
        assert "".join(reference).startswith(("#", "data:"))


@pytest.mark.slow("report")
def test_markup_in_names_is_shown_and_not_obeyed(from_friction: Identified) -> None:
    html = identify_report(from_friction, Provenance(command=HOSTILE, files={HOSTILE: "0" * 64}))
    name = from_friction.files[0].name
    assert name == HOSTILE.replace("/", "_")
    assert "<script" not in html
    assert "<b>table" not in html
    page = Page(html).root
    assert name in page.find("main")[0].text
    assert page.find("footer")[0].find("code")[0].text == HOSTILE
    assert any(name in svg.attributes["aria-label"] for svg in page.find("svg"))


@pytest.mark.slow("report")
def test_the_same_result_gives_the_same_bytes_and_the_date_is_the_one_given(from_friction: Identified) -> None:
    provenance = Provenance("2026-01-01", "strainwave identify", {})
    assert identify_report(from_friction, provenance) == identify_report(from_friction, provenance)
    assert "2026-01-01" in identify_report(from_friction, provenance)
    assert not re.search(r"20\d\d-\d\d-\d\d", identify_report(from_friction))


@pytest.mark.slow("report")
def test_the_preferences_of_a_machine_do_not_change_the_report(from_friction: Identified) -> None:
    import matplotlib as mpl

    expected = identify_report(from_friction)
    with mpl.rc_context({"font.size": 20.0, "axes.grid": False, "text.usetex": False, "lines.linewidth": 9.0}):
        assert identify_report(from_friction) == expected
        assert mpl.rcParams["font.size"] == 20.0


@pytest.mark.slow("report")
def test_drawing_leaves_no_figure_open(from_friction: Identified) -> None:
    identify_report(from_friction)
    assert "matplotlib.pyplot" not in sys.modules or not sys.modules["matplotlib.pyplot"].get_fignums()


def test_a_long_record_stays_small_and_keeps_its_peak() -> None:
    run = swing(400_000)
    noisy = run["output_angle"] + 1e-3 * np.random.default_rng(1).normal(size=len(run))
    noisy[123_456] = 0.4

    def draw(figure: Figure) -> None:
        marks.curve(figure.subplots(), run.time, noisy, color=LIGHT["model"])

    svg = figures.inline(draw, (FIGURE_WIDTH, 3.9), "long", "a long record")
    assert len(svg) < 80_000
    lines = [points(path) for path in Page(svg).root.find("path") if "--model" in path.attributes.get("style", "")]
    response = next(line for line in lines if len(line) > 100)
    assert response[:, 1].min() < np.quantile(response[:, 1], 0.01) - 20.0, "the peak towers, upright is negative"
    assert np.argmin(response[:, 1]) / len(response) == pytest.approx(123_456 / 400_000, abs=0.02)


def test_provenance_holds_the_digest_of_each_file(tmp_path: Path) -> None:
    file = tmp_path / "loop.csv"
    file.write_bytes(b"abc")
    provenance = Provenance.of([file], command="strainwave identify", date="2026-01-01")
    # FIPS 180-2, appendix B.1
    assert provenance.files == {"loop.csv": "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"}


# Narrow pages


@pytest.mark.whole_path("report")
def test_a_cell_of_a_table_says_its_column_where_the_table_is_taken_apart(html: str) -> None:
    tables = [table for table in Page(html).root.find("table") if "rows" in table.attributes.get("class", "").split()]
    assert tables
    for table in tables:
        columns = [column.text for column in table.find("thead")[0].find("th")]
        for row in table.find("tbody")[0].find("tr"):
            cells = [cell for cell in row.children if isinstance(cell, Node)]
            for column, cell in zip(columns, cells, strict=False):
                assert cell.attributes.get("data-label", column) == column


@pytest.mark.whole_path("report")
def test_a_figure_is_as_wide_as_its_box(html: str) -> None:
    style = Page(html).root.find("style")[0]
    rules = re.findall(r"([^{}]*)\{([^{}]*)\}", "".join(child for child in style.children if isinstance(child, str)))
    of_figures = [rule for selector, rule in rules if selector.strip().endswith("svg")]
    assert of_figures
    assert all("width: 100%" in rule and "min-width" not in rule for rule in of_figures)
    assert not any({"width", "height"} & svg.attributes.keys() for svg in Page(html).root.find("svg"))


WIDEST = """<script>
onload = () => {
  const frame = document.querySelector("iframe"), page = frame.contentDocument, width = frame.clientWidth, beyond = [];
  page.querySelectorAll("details").forEach(each => each.open = true);
  for (const each of page.body.querySelectorAll("*")) {
    const place = each.parentElement.closest(".scroll, svg");
    if (!place && each.getBoundingClientRect().right > width + 1) beyond.push(each.outerHTML.slice(0, 99));
  }
  document.body.innerHTML = "<pre></pre>"; document.querySelector("pre").textContent = `${width}: ${beyond}`;
};
</script>"""


def beyond_the_edge(page: str, width: int, folder: Path) -> str:
    """The elements of a page that a browser draws beyond the right edge of a window of so many pixels."""
    (folder / "report.html").write_text(page, encoding="utf-8")
    frame = f'<iframe src="report.html" style="border:0;width:{width}px;height:900px"></iframe>'
    (folder / "frame.html").write_text(f"<!doctype html><body>{frame}{WIDEST}</body>", encoding="utf-8")
    browser = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if browser is None:
        pytest.skip("no Chromium is installed")
    options = ["--headless", "--no-sandbox", "--disable-gpu", "--allow-file-access-from-files", "--virtual-time-budget=5000"]
    command = [browser, *options, f"--window-size={width + 200},900", "--dump-dom", (folder / "frame.html").as_uri()]
    shown = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True).stdout
    found = re.search(r"<pre>(\d+): (.*?)</pre>", shown, re.DOTALL)
    assert found is not None
    assert int(found[1]) == width
    return markup.unescape(found[2])


@pytest.mark.slow("report")
@pytest.mark.parametrize("width", [390, 1280])
def test_a_browser_draws_nothing_beyond_the_edge_of_a_phone_or_a_screen(
    width: int, from_friction: Identified, tmp_path: Path
) -> None:
    """Twelve joints have a table that is wider than a screen: it scrolls in itself."""
    many = Joints({str(joint): from_friction for joint in range(12)}, {}, {})
    for page in (identify_report(from_friction), joints_report(many)):
        assert beyond_the_edge(page, width, tmp_path) == ""
    wide = "<!doctype html><body><p style='width:2000px'>too wide</p></body>"
    assert beyond_the_edge(wide, width, tmp_path).startswith("<p style=")
