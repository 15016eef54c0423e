"""The command line: one clear line and status 2 for what the user can mend, never a traceback."""

import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from shadelab import __main__ as command_line
from shadelab import _techniques
from shadelab.scene import load_image


def shadelab(*arguments, **options):
    command = [sys.executable, "-m", "shadelab", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, **options)


def one_line(capsys, *arguments):
    """Status and the single line on stderr of a command that fails."""
    try:
        status = command_line.main([str(a) for a in arguments])
    except SystemExit as exit_:
        status = exit_.code
    caught = capsys.readouterr()
    assert caught.out == ""
    assert caught.err.count("\n") == 1 and caught.err.startswith("shadelab: ")
    return status, caught.err


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ([], "COMMAND"),
        (["paint"], "invalid choice: 'paint'"),
        (["study", "--colour"], "unrecognized arguments: --colour"),
        (["study", "--size", "1280"], "expected WIDTHxHEIGHT"),
        (["study", "--size", "0x9"], "sides from 1"),
        (["study", "--max-error", "nan"], "expected a positive number"),
        (["study", "--max-error", "0.1", "--budget-ms", "3"], "not allowed with"),
        (["study", "--threads", "0"], "--threads: expected an integer, from 1 to 4096"),
        (["study", "--threads", "5000"], "--threads: expected an integer, from 1 to 4096"),
        (["render", "default", "-o", "x.png", "--threads", "5000"], "--threads: expected an integer, from 1 to 4096"),
        (["study", "--seed", str(2**64)], "--seed: expected an integer, from 0 to 18446744073709551615"),
        (["render", "default", "-o", "x.png", "--seed", "-1"], "--seed: expected an integer, from 0"),
        (["study", "--question", "hard questions"], "'soft shadows'"),
        (["study", "acceleration", "a.obj", "b.obj"], "expected a question ('acceleration'"),
        (["study", "absent.obj"], "absent.obj"),
        (["render", "absent.glb", "-o", "x.png"], "absent.glb"),
        (["render", "default", "-o", "x.tiff"], "ends in .png, .exr or .hdr"),
        (["render", "default", "-o", "absent/x.png"], "no such directory"),
        (["render", "default"], "required: -o"),
        (["techniques", "alchemy"], "chapter: expected one of"),
        (["stability", "alchemy"], "chapter: expected one of"),
    ],
    ids=lambda v: " ".join(v) if isinstance(v, list) else "",
)
def test_what_is_wrong_is_said_in_one_line(capsys, tmp_path, monkeypatch, arguments, expected):
    monkeypatch.chdir(tmp_path)
    status, line = one_line(capsys, *arguments)
    assert status == 2 and expected in line


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("empty.obj", ""),
        ("broken.obj", "v 1 2\nf 1 2 9\n"),
        ("broken.ply", "ply\nformat ascii 1.0\nelement vertex 3\n"),
        ("broken.stl", "\x00\x01\x02"),
        ("broken.glb", "glTF????"),
        ("broken.gltf", "{"),
        ("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"),
        ("same.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n"),
        ("far.obj", "v 1e300 0 0\nv 0 1e300 0\nv 0 0 1e300\nf 1 2 3\n"),
        ("model.txt", "v 0 0 0\n"),
    ],
)
def test_broken_and_empty_models_are_refused_in_one_line(capsys, tmp_path, monkeypatch, name, content):
    monkeypatch.chdir(tmp_path)
    (tmp_path / name).write_bytes(content.encode("latin-1"))
    for arguments in (["study", name], ["render", name, "-o", "x.png"]):
        status, line = one_line(capsys, *arguments)
        assert status == 2 and name in line


def test_a_fresh_process_prints_no_traceback(tmp_path):
    done = shadelab("study", "absent.obj", cwd=tmp_path)
    assert done.returncode == 2 and done.stdout == "" and done.stderr.count("\n") == 1
    assert shadelab("--help").returncode == 0


def test_techniques_are_gathered_from_the_faces():
    names = _techniques.chapters()
    assert "geometry" in names and "study" in names and names.index("geometry") < names.index("study")
    listing = _techniques.listing(["geometry"])
    assert "barycentric" in listing and "Real-Time Collision Detection" in listing


def test_references_of_a_docstring_are_found_one_by_one():
    text = "Sum.\n\nReferences\n----------\nA. One, *First*,\n    1999.\nB. Two, 2001.\n\nExamples\n--------\n>>> 1\n1"
    assert _techniques.references(text) == ["A. One, *First*, 1999.", "B. Two, 2001."]
    assert _techniques.references("Sum.") == []


def test_stability_fails_where_a_claim_fails(capsys, monkeypatch):
    from shadelab.study import stability

    case = stability.Extreme("geometry.x", "n", "d", "ulp", {"float32": 1.0}, lambda d: stability.Measurement(2.0, 3))
    monkeypatch.setattr(stability, "extremes", lambda chapter: [case])
    assert command_line.main(["stability"]) == 1
    out = capsys.readouterr().out
    assert "FAILS" in out and "1 claims, 1 fail" in out
    good = stability.Extreme("geometry.x", "n", "d", "ulp", {"float32": 3.0}, lambda d: stability.Measurement(2.0, 3))
    monkeypatch.setattr(stability, "extremes", lambda chapter: [good])
    assert command_line.main(["stability"]) == 0


def test_output_that_nobody_reads_is_no_error(tmp_path):
    command = f"{sys.executable} -m shadelab techniques | head -1"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, timeout=60)
    assert done.stderr == "" and done.stdout.count("\n") == 1


@pytest.mark.skipif(sys.platform == "win32", reason="signals differ")
def test_an_interrupt_ends_in_status_130(tmp_path):
    command = [sys.executable, "-m", "shadelab", "study", "--out", str(tmp_path / "r"), "--no-cache"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=tmp_path)
    assert "soft shadows" in process.stderr.readline()
    time.sleep(1.0)
    process.send_signal(signal.SIGINT)
    _, error = process.communicate(timeout=30)
    assert process.returncode == 130
    assert "Traceback" not in error and "interrupted" in error


def test_render_writes_a_picture_and_its_reference(tmp_path, monkeypatch, capsys):
    import shadelab as sl

    for name, more in (("a.png", []), ("b.exr", ["--reference", "--samples", "2"])):
        assert command_line.main(["render", "default", "-o", str(tmp_path / name), "--size", "64x36", *more]) == 0
        picture = sl.scene.load_image(tmp_path / name)
        assert picture.shape == (36, 64, 3) and picture.max() > 0.05


def test_study_of_a_model_writes_its_report(tmp_path, capsys):
    cube = tmp_path / "cube.obj"
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    faces = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]
    cube.write_text(
        "".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "".join(f"f {a} {b} {c} {d}\n" for a, b, c, d in faces)
    )
    out = tmp_path / "report"
    status = command_line.main(["study", str(cube), "--size", "96x54", "--out", str(out), "--max-error", "0.9"])
    text = capsys.readouterr().out
    assert status == 0 and "choice: " in text and "pcss" in text
    assert {p.name for p in out.iterdir()} == {"index.html", "figures.csv", "figures.json", "front.png", "pictures"}
    assert list(out.rglob("*.exr")) and list(out.rglob("*-flip.png"))


def test_reference_and_frame_are_shown_by_one_curve(tmp_path):
    """A pixel of sky is of the same radiance in both, and as much of either is exposed."""
    pictures = []
    for extra in ([], ["--reference", "--samples", "4"]):
        out = tmp_path / f"{len(extra)}.png"
        assert command_line.main(["render", "default", "-o", str(out), "--size", "48x27", *extra]) == 0
        pictures.append(load_image(out)[0, 0])
    assert np.abs(pictures[0] - pictures[1]).max() < 0.02  # exposures follow each picture's own brightness
