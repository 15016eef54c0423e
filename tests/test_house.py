"""The house itself: imports run downwards, kernels know no Python, a technique has its four places."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
CHAPTERS = (
    "transform sampling image color curve geometry mesh accel sdf texture brdf light sh environment scene cull "
    "raster pathtrace shadow gi denoise antialias renderer study"
).split()
FOUNDATION = {"math", "memory", "parallel", "real", "simd", "vec"}

RUST = sorted(p for p in (ROOT / "src").rglob("*.rs") if p.name != "tests.rs")
KERNELS = [p for p in RUST if p.relative_to(ROOT / "src").parts[0] in CHAPTERS]
PACKAGE = ROOT / "python/shadelab"
# A face is a file, or a package of files where a chapter has many techniques; so are the bindings.
FACES = sorted(p for c in CHAPTERS if c != "study" for p in [*PACKAGE.glob(f"{c}.py"), *PACKAGE.glob(f"{c}/*.py")])
STUDY = sorted((ROOT / "python/shadelab/study").rglob("*.py"))


def name(path):
    return str(path.relative_to(ROOT))


def code(path):
    """Rust without comments and without the tests at its end."""
    text = path.read_text().split("#[cfg(test)]\nmod")[0]
    return re.sub(r"//[^\n]*", "", text)


def chapter(path):
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def text_of(place):
    """A file, or all files of the folder of that name."""
    files = [place] if place.exists() else sorted(place.with_suffix("").glob("*"))
    return "\n".join(f.read_text() for f in files if f.suffix == place.suffix)


def python_imports(path):
    """Chapters that a Python file of the package imports, at any depth of the file."""
    found = set()
    level = len(path.relative_to(PACKAGE).parts)
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.level == level:
            found |= {node.module.split(".")[0]} if node.module else {a.name for a in node.names}
    return found & set(CHAPTERS)


@pytest.mark.parametrize("path", KERNELS, ids=name)
def test_kernels_use_only_chapters_above_them(path):
    own = CHAPTERS.index(path.relative_to(ROOT / "src").parts[0])
    used = set(re.findall(r"\bcrate::(\w+)", code(path))) & set(CHAPTERS)
    assert all(CHAPTERS.index(c) <= own for c in used), used


@pytest.mark.parametrize("path", FACES, ids=name)
def test_faces_import_only_chapters_above_them(path):
    own = CHAPTERS.index(chapter(path))
    used = python_imports(path)
    assert all(CHAPTERS.index(c) < own for c in used), used


@pytest.mark.parametrize("path", [p for p in RUST if "python" not in p.parts], ids=name)
def test_kernels_know_no_python(path):
    text = code(path)
    if path.name == "lib.rs":
        text = text.replace('#[cfg(feature = "python")]\nmod python;', "")
    assert not re.search(r"\bpyo3\b|\bnumpy::|\bndarray::", text)


@pytest.mark.parametrize("path", [p for p in RUST if p.name not in ("real.rs", "tests.rs")], ids=name)
def test_kernels_round_alike_everywhere(path):
    """No fused arithmetic, and no transcendental of the system's own library."""
    calls = re.findall(
        r"\.(mul_add|mul_sub|powf|powi|sin|cos|tan|sin_cos|acos|asin|atan2?|exp|exp2|ln|log2|log10|cbrt)\(", code(path)
    )
    assert not calls, calls


def test_chapters_stand_in_reading_order():
    modules = re.findall(r"^pub mod (\w+);", (ROOT / "src/lib.rs").read_text(), re.M)
    chapters = [m for m in modules if m not in FOUNDATION]
    assert chapters == [c for c in CHAPTERS if c in chapters]


def techniques():
    """A chapter's public modules are its techniques; its parts are private or `pub(crate)`."""
    for path in KERNELS:
        if path.name == "mod.rs" and path.parent.parent.name == "src":
            for technique in re.findall(r"^pub mod (\w+);", path.read_text(), re.M):
                yield pytest.param(path.parent.name, technique, id=f"{path.parent.name}.{technique}")


@pytest.mark.parametrize(("chapter", "technique"), list(techniques()))
def test_a_technique_has_its_four_places(chapter, technique):
    assert (ROOT / f"src/{chapter}/{technique}.rs").exists() or (ROOT / f"src/{chapter}/{technique}/mod.rs").exists()
    assert re.search(rf"\b{technique}\b", text_of(ROOT / f"src/python/{chapter}.rs"))
    assert text_of(PACKAGE / f"{chapter}.py")
    assert (ROOT / f"tests/{chapter}/test_{technique}.py").exists()


@pytest.mark.parametrize("path", [p for p in RUST if p.name == "mod.rs" or p in KERNELS], ids=name)
def test_a_file_says_what_it_is_in_its_first_lines(path):
    assert path.read_text().startswith("//! ")


@pytest.mark.parametrize("path", [p for p in RUST + FACES + STUDY if "data" not in p.stem], ids=name)
def test_files_hold_one_idea(path):
    """Near 300 lines; docstrings carry the faces further."""
    limit = 450 if path.suffix == ".rs" else 900
    assert len(path.read_text().splitlines()) <= limit


@pytest.mark.parametrize("path", RUST, ids=name)
def test_unsafe_says_why_it_is_sound(path):
    lines = path.read_text().splitlines()
    for i, line in enumerate(lines):
        if re.search(r"\bunsafe\b", line.split("//")[0]) and not line.lstrip().startswith("//"):
            near = "\n".join(lines[max(0, i - 6) : i + 1])
            assert re.search(r"[Ss]ound|SAFETY|Safety", near), f"line {i + 1}: {line.strip()}"


def test_the_top_of_the_repository_is_as_drawn():
    drawn = {"Cargo.toml", "Cargo.lock", "pyproject.toml", "README.md", "LICENSE-MIT", "LICENSE-APACHE"}
    drawn |= {"src", "python", "tests", "notebooks", ".ci", ".gitignore", ".rustfmt.toml"}
    allowed_litter = {".git", "target", "build", "dist", "shadelab-report"}
    here = {p.name for p in ROOT.iterdir() if not p.name.endswith((".egg-info", "_cache", "venv"))}
    assert here - allowed_litter - {".hypothesis", "__pycache__", ".venv"} <= drawn
