"""The report: self-contained, complete, readable; the figures survive their files."""

import csv
import json
import re
import shutil
import subprocess

import numpy as np
import pytest
import toy
from shadelab import study
from shadelab.study import report

FAST = {"rounds": 6, "patience": 1.0, "cache": False}
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


def gray(inputs, value):
    return (np.clip(value, 0, 1)[..., None] * [255, 255, 255]).astype(np.uint8)


def closeness(value, reference, inputs):
    """The magnitude of the difference, as a map."""
    return np.abs(value - reference)


@pytest.fixture(scope="module")
def measured():
    q = toy.question(
        0.02, scenes=("easy <scene>", "other"), display=gray, also={"MAP": closeness}, about="What & why.",
        plan=lambda case: f"passes of {case.name}",
    )  # fmt: skip
    return study.run(q, **FAST)


@pytest.fixture(scope="module")
def directory(measured, tmp_path_factory):
    directory = tmp_path_factory.mktemp("report") / "deep"
    measured.report(directory, max_error=0.05)
    return directory


def test_the_page_stands_alone(directory):
    text = (directory / "index.html").read_text()
    sources = re.findall(r'(?:src|href)="([^"]*)"', text)
    for source in sources:
        assert source.startswith(("data:image/", "#")) or (directory / source).is_file(), source
    assert len([s for s in sources if s.startswith("data:")]) == 2 * (2 + 2 * 3)
    for outside in ("http:", "https:", "url(", "@import", "<script", "<link"):
        assert outside not in text


def test_the_page_says_what_was_measured_and_how(directory, measured):
    text = (directory / "index.html").read_text()
    for needed in (
        "What &amp; why.", "easy &lt;scene&gt;", "passes of other", "difference", "left half", "GPU",
        measured.machine["cpu"], measured.machine["simd"],
        "biased(bias=0.01)", "error at most 0.05", "The magnitude of the difference",
    ):  # fmt: skip
        assert needed in text, needed
    assert "<scene>" not in text.replace("<svg", "")


def test_pictures_and_figures_lie_beside(directory, measured):
    pictures = {p.name for p in (directory / "pictures" / "easy-scene").iterdir()}
    assert {"reference.png", "reference.exr", "mask.png", "noisy-samples-16.png", "noisy-samples-16.exr"} <= pictures
    assert {"noisy-samples-16-difference.png", "noisy-samples-16-map.png"} <= pictures
    rows = list(csv.DictReader((directory / "figures.csv").open()))
    for scene in {r["scene"] for r in rows}:
        fronted = {s.setting for s in measured.front(scene)}
        assert fronted and {r["on_front"] for r in rows} <= {"0", "1"}
        marked = [r for r in rows if r["scene"] == scene and r["on_front"] == "1"]
        cases = sum(c.scene == scene for c in measured.cases)
        assert len(marked) == cases * len(fronted)
    assert len(rows) == len(measured.records) == 8
    assert float(rows[0]["error"]) == measured.records[0].error.value
    assert json.loads((directory / "figures.json").read_text())["schema"] == 1


def test_pictures_hold_the_linear_values(directory, measured):
    import shadelab as sl

    values = sl.scene.load_image(directory / "pictures" / "other" / "biased-bias-0.01.exr")
    case = study.Case("other", "", 0, None, toy.SIZE, np.dtype(np.float32), 0)
    assert np.allclose(values.reshape(*values.shape[:2], -1)[..., 0], toy.truth(case) + 0.01, atol=1e-6)


def test_figures_survive_json(directory, measured, tmp_path):
    again = study.Study.load(measured.save(tmp_path / "study.json"))
    assert again.records == measured.records and again.cases == measured.cases
    assert str(again) == str(measured) and again.pick(max_error=0.05) == measured.pick(max_error=0.05)
    assert [s.setting for s in again.front()] == [s.setting for s in measured.front()]
    page = again.report(tmp_path / "again")  # figures and front, without pictures
    assert "data:image" not in page.read_text() and "biased(bias=0.01)" in page.read_text()


def test_files_that_are_no_study_are_refused(tmp_path):
    path = tmp_path / "x.json"
    for text in ("", "[]", "{}", '{"schema": 99}'):
        path.write_text(text)
        with pytest.raises(ValueError, match=r"x\.json: (not a study|expected schema 1, got 99)"):
            study.Study.load(path)


def test_when_nothing_qualifies_the_page_says_so(measured, tmp_path):
    text = measured.report(tmp_path, max_error=1e-6).read_text()
    assert "Nothing keeps error at most 1e-06" in text


def test_the_plot_leaves_no_state_and_shows_itself(measured):
    import sys

    figure = measured.plot()
    assert figure._repr_png_().startswith(b"\x89PNG")
    assert "matplotlib.pyplot" not in sys.modules or not sys.modules["matplotlib.pyplot"].get_fignums()
    labels = [t.get_text() for t in figure.axes[0].get_legend().get_texts()]
    assert labels == ["biased", "noisy"]


def test_difference_maps_are_white_without_error_and_signed():
    mask = np.array([[True, True, True, True, False]])
    colors = report._diverging(np.array([[-1.0, 0.0, 1.0, np.nan, 1.0]]), mask).astype(int)
    dark, none, bright, stray, outside = colors[0]
    assert dark[2] > dark[0] and bright[0] > bright[2] and (none == 247).all() and (stray == 0).all()
    assert (outside > bright).all()  # paler off the mask


def test_techniques_of_one_colour_have_other_markers():
    from shadelab.study import chart

    seen = {(chart.COLORS[i % len(chart.COLORS)], chart.marker_path(i, 0, 0)) for i in range(30)}
    assert len(seen) == 30


def test_settings_stand_in_rows_case_by_case(directory, measured):
    table = re.search(r'<table class="shadelab-table cases">(.*?)</table>', (directory / "index.html").read_text())[1]
    rows = [re.findall(r"<t[hd]>(.*?)</t[hd]>", row) for row in table.split("<tr>")[1:]]
    assert rows[0] == ["", "easy &lt;scene&gt;", "other"] and all(len(row) == 3 for row in rows)
    assert {row[0].split("(")[0] for row in rows[1:]} == {"biased", "noisy"}


def test_tables_star_the_front(measured):
    front = {s.setting for s in measured.front()}
    lines = [line for line in str(measured).splitlines() if line.startswith(("* ", "  "))]
    assert {line.split("  ")[0][2:].strip() for line in lines if line.startswith("* ")} == front
    assert measured._repr_html_().count("★") == len(front)


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")
@pytest.mark.parametrize("width", [390, 1280])
def test_the_page_opens_in_a_browser_without_sideways_scroll(directory, tmp_path, width):
    # A script is put in for the test alone: it writes what the browser laid out into the title.
    probe = (
        "<script>addEventListener('load',()=>{const d=document.documentElement;document.title=JSON.stringify("
        "{wide:d.scrollWidth,screen:d.clientWidth,broken:[...document.images].filter(i=>!i.naturalWidth).length,"
        "pictures:document.images.length})})</script></main>"
    )
    page = tmp_path / "probe.html"
    # A frame of the width of a phone: headless windows do not go below 500 pixels.
    page.write_text((directory / "index.html").read_text().replace("</main>", probe))
    host = tmp_path / "host.html"
    host.write_text(
        f'<iframe id="f" src="probe.html" style="width:{width}px;height:900px;border:0"></iframe><script>'
        "f.onload=()=>{const d=f.contentDocument.documentElement;document.title=f.contentDocument.title}</script>"
    )
    command = [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--allow-file-access-from-files", "--dump-dom"]
    command += ["--window-size=1400,1000", "--virtual-time-budget=5000", host.as_uri()]
    dom = subprocess.run(command, capture_output=True, text=True, timeout=120).stdout
    title = re.search(r"<title>(\{.*?\})</title>", dom)
    assert title, dom[:500]
    seen = json.loads(title.group(1))
    assert width - 20 <= seen["screen"] <= width  # the bar to scroll down by takes its part
    assert seen["wide"] <= seen["screen"] and seen["broken"] == 0 and seen["pictures"] == 16
