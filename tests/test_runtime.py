"""Threads, forks, signals, SIMD levels, import time: how kernels run."""

import os
import signal
import subprocess
import sys
import textwrap
import time

import numpy as np
import pytest
import shadelab as sl


def python(code, **environment):
    """Run `code` in a fresh interpreter."""
    return subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)],
        capture_output=True,
        text=True,
        timeout=120,
        env={**os.environ, **environment},
    )


@pytest.fixture
def work():
    rng = np.random.default_rng(0)
    return rng.normal(size=(4, 100_000, 3)).astype(np.float32)


@pytest.mark.parametrize("n", [1, 2, 3, 7])
def test_results_do_not_depend_on_the_number_of_threads(work, n):
    expected = sl.geometry.barycentric(*work)
    try:
        sl.set_threads(n)
        assert sl.threads() == n
        assert np.array_equal(sl.geometry.barycentric(*work), expected)
    finally:
        sl.set_threads(None)


@pytest.mark.parametrize("level", sl.simd_levels())
def test_results_do_not_depend_on_the_simd_level(work, level):
    expected = sl.geometry.barycentric(*work)
    with sl.simd(level):
        assert sl.simd_level() == level
        assert np.array_equal(sl.geometry.barycentric(*work), expected)


@pytest.mark.parametrize("bad", [0, -1, 5000])
def test_a_bad_number_of_threads_is_refused(bad):
    with pytest.raises(ValueError, match="n: expected an integer"):
        sl.set_threads(bad)


def test_an_unknown_level_is_refused():
    with pytest.raises(ValueError, match="level: expected one of"), sl.simd("avx9000"):
        pass


def test_environment_forces_level_and_threads():
    code = "import shadelab as sl; print(sl.simd_level(), sl.threads())"
    assert python(code, SHADELAB_SIMD="baseline", SHADELAB_THREADS="3").stdout.split() == ["baseline", "3"]
    for name, value in (("SHADELAB_SIMD", "mmx"), ("SHADELAB_THREADS", "0")):
        result = python(code, **{name: value})
        assert result.returncode != 0 and f"{name}: expected" in result.stderr


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
def test_a_forked_child_gets_its_own_threads():
    result = python("""
        import os, warnings
        import numpy as np, shadelab as sl
        warnings.simplefilter("ignore")
        sl.set_threads(2)
        p = np.random.default_rng(0).normal(size=(4, 200_000, 3))
        expected = sl.geometry.barycentric(*p)
        child = os.fork()
        if child == 0:
            same = np.array_equal(sl.geometry.barycentric(*p), expected)
            os._exit(0 if same else 1)
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
        assert np.array_equal(sl.geometry.barycentric(*p), expected)
    """)
    assert result.returncode == 0, result.stderr


RAYS = """
mesh = sl.mesh.icosphere(5)
bvh = sl.accel.BVH(mesh.positions, mesh.faces)
d = np.random.default_rng(0).normal(size=(2_000_000, 3))
def work():
    for _ in range(1000):
        bvh.closest_hit(np.zeros(3), d)
"""
WIDE_FILTER = """
picture = np.zeros((6000, 6000), np.float32)
def work():
    for _ in range(1000):
        sl.image.gaussian_filter(picture, 300.0)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")
@pytest.mark.parametrize("work", [RAYS, WIDE_FILTER], ids=["rays", "wide filter"])
def test_control_c_stops_long_work_at_once(work):
    """The interrupt surfaces within 0.2 s; a loaded machine gets ten times that."""
    code = f"""
import time
import numpy as np, shadelab as sl
{work}
print("ready", flush=True)
try:
    work()
except KeyboardInterrupt:
    print(time.time(), flush=True)
"""
    child = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "ready\n"
    time.sleep(1.0)
    sent = time.time()
    child.send_signal(signal.SIGINT)
    out, _ = child.communicate(timeout=60)
    assert float(out) - sent < 2.0


def test_import_takes_no_heavy_library_along():
    """Numpy alone at run time: whatever an extra brings is imported where it is used."""
    result = python("""
        import sys
        import numpy
        before = set(sys.modules)
        import shadelab
        new = {m.split(".")[0] for m in set(sys.modules) - before}
        heavy = {"trimesh", "PIL", "OpenEXR", "matplotlib", "tqdm", "scipy", "IPython", "flip_evaluator", "skimage"}
        print(sorted(new & heavy))
    """)
    assert result.stdout.strip() == "[]", result.stdout + result.stderr
