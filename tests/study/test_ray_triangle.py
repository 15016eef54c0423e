"""The question of rays and triangles: its reference is exact, its cases hold what they say, and it finds the leaks."""

from fractions import Fraction

import numpy as np
import pytest
from shadelab import study
from shadelab.study import Case
from shadelab.study.questions import _rays, ray_triangle

SIZE = (64, 64)
FAST = {"size": SIZE, "rounds": 1, "patience": 0.0, "causes": False}


def setup(name, magnified, dtype=np.float32, size=SIZE):
    return ray_triangle._setup(Case(name, "", ray_triangle._SCENES[name], magnified, size, np.dtype(dtype), 0))


def crossing(o, d, a, b, c):
    """In rationals: the distance at which a ray crosses a triangle, borders included, else None."""
    o, d, a, b, c = ([Fraction(float(x)) for x in v] for v in (o, d, a, b, c))

    def minus(u, v):
        return [x - y for x, y in zip(u, v, strict=True)]

    def cross(u, v):
        return [u[i - 2] * v[i - 1] - u[i - 1] * v[i - 2] for i in range(3)]

    def dot(u, v):
        return sum(x * y for x, y in zip(u, v, strict=True))

    a, b, c = (minus(v, o) for v in (a, b, c))
    sides = [dot(d, cross(u, v)) for u, v in ((a, b), (b, c), (c, a))]
    if not (min(sides) >= 0 or max(sides) <= 0) or not any(sides):
        return None
    n = cross(minus(b, a), minus(c, a))
    t = dot(n, a) / dot(n, d)
    return t if t > 0 else None


@pytest.mark.parametrize("magnified", [False, True])
@pytest.mark.parametrize("name", ray_triangle._SCENES)
def test_the_reference_is_exact(name, magnified):
    inputs = setup(name, magnified, size=(12, 12))
    hits = 0
    for i in np.ndindex(12, 12):
        found = [
            crossing(inputs.origins[i][k], inputs.directions[i][k], *(v[i][k] for v in inputs.primitives))
            for k in range(2)
        ]
        t = min((t for t in found if t is not None), default=None)
        hits += t is not None
        if t is None:
            assert inputs.exact[i] == -1
        else:
            # Rounded to double, and computed in little more where long double is not wider.
            assert abs(Fraction(inputs.exact[i]) / t - 1) < 1e-11
    assert hits == 144 if magnified and "slivers" not in name else 20 < hits <= 144


def test_rays_and_triangles_are_of_single_precision_in_either_run():
    single, double = setup("100 sizes away", True), setup("100 sizes away", True, np.float64)
    assert single.origins.dtype == np.float32 and double.origins.dtype == np.float64
    assert single.origins.shape == (64, 64, 2, 3) and all(v.shape == (64, 64, 2, 3) for v in single.primitives)
    for a, b in zip((single.origins, *single.primitives), (double.origins, *double.primitives), strict=True):
        assert np.array_equal(a, b)
    assert np.array_equal(single.exact, double.exact)


def test_misses_are_told_from_errors():
    reference = np.array([[2.0, 2.0, -1.0, -1.0, 4.0]])
    value = np.array([[2.0, -1.0, 3.0, -1.0, 4.4]])
    assert np.allclose(_rays.residual(value, reference, None), [[0, -1, 1, 0, 0.1]])
    figures = [f(value, reference, None) for f in _rays.also.values()]
    assert figures == pytest.approx([2e5, 2e5, 0.1 / _rays.EPS])
    assert np.array_equal(_rays.answer(np.array([[[3.0, np.inf], [np.inf, np.inf]]])), [[3, -1]])
    assert np.isnan(_rays.residual(np.array([[np.nan]]), np.array([[1.0]]), None)).all()


@pytest.mark.parametrize("size", [(64, 64), (130, 70), (5, 3), (1, 1)])
def test_tiles_cover_the_picture(size):
    x, y, number, n = _rays.tiles(size)
    assert x.shape == y.shape == number.shape == size[::-1]
    assert (np.abs(x) < 1).all() and (np.abs(y) < 1).all() and set(number.ravel()) == set(range(n))
    for k in range(n):
        assert abs(x[number == k].mean()) < 1e-12 and abs(y[number == k].mean()) < 1e-12


def test_watertight_loses_no_ray_at_the_shared_edge_and_the_others_do():
    result = study.run("ray triangle", "size 1e6", **FAST | {"size": (256, 128)})
    lost = {r.setting: r.also["lost per million"] for r in result.records if "edge" in r.view}
    assert lost["watertight(precision=single)"] == 0
    assert lost["moller_trumbore(precision=single)"] > 0 and lost["plane(precision=single)"] > 0
    assert all(v == 0 for k, v in lost.items() if "double" in k)
    # Where nothing is lost, the error is that of the distance: some roundings.
    error = {r.setting: r.error.value for r in result.records if "edge" in r.view}
    assert error["watertight(precision=single)"] < 5 * _rays.EPS
    choice = result.pick(max_error=1e-6)
    assert "single" not in choice.knobs["precision"] or choice.technique == "watertight"


def test_it_runs_whole_and_shows_nanoseconds_a_ray_case_by_case(tmp_path):
    result = study.run("ray triangle", **FAST)
    assert len(result.cases) == 16 and len(result.records) == 16 * 6
    assert all(c.elements == 64 * 64 for c in result.cases)
    unit = result.cost_unit()
    assert unit.short == "ns/ray" and unit.per_ms == pytest.approx(1e6 / 4096)
    assert "ns/ray" in result.table() and "lost per million" in result.by_case()
    page = result.of("size 1e6").report(tmp_path, max_error=1e-5).read_text()
    assert "nanoseconds a ray" in page and "Case by case" in page and "frame" not in result.plot().axes[0].get_xlabel()
    assert len(list((tmp_path / "pictures").iterdir())) == 2


def test_other_scenes_are_refused_and_ones_own_taken():
    with pytest.raises(ValueError, match="or takes Pairs"):
        study.run("ray triangle", 3, **FAST)
    result = study.run("ray triangle", ray_triangle.Pairs(distance=5.0), techniques=["plane"], **FAST)
    assert {r.scene for r in result.records} == {"your scene"}
