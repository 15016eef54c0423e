"""Rays and implicit surfaces: roots of polynomials by mpmath, spheres and tori; functions by sampling and by bounds."""

from itertools import zip_longest

import mpmath
import numpy as np
import pytest
import shadelab as sl
from hypothesis import given, settings
from hypothesis import strategies as st

from .rational import vector

PRECISIONS = pytest.mark.parametrize("dtype", [np.float32, np.float64])


def rays(dtype, n=200, distance=5.0, reach=1.5, length=1.0, seed=1):
    rng = np.random.default_rng(seed)
    o = rng.normal(size=(n, 3))
    o *= distance / np.linalg.norm(o, axis=-1, keepdims=True)
    goal = rng.uniform(-reach, reach, (n, 3))
    d = goal - o
    return o.astype(dtype), (length * d / np.linalg.norm(d, axis=-1, keepdims=True)).astype(dtype)


def exact_roots(o, d, c):
    """The real roots along a ray, by rational coefficients and 60 digits."""
    o, d = vector(o), vector(d)
    line = [0]
    for at in np.argwhere(c):
        term = vector([c[tuple(at)]])
        for x, v, e in zip(o, d, at, strict=True):
            for _ in range(e):
                term = [a * x + b * v for a, b in zip([*term, 0], [0, *term], strict=True)]
        line = [a + b for a, b in zip_longest(line, term, fillvalue=0)]
    while line and line[-1] == 0:
        line.pop()
    with mpmath.workdps(60):
        wide = [mpmath.mpf(x.numerator) / x.denominator for x in reversed(line)]
        found = mpmath.polyroots(wide, maxsteps=500, extraprec=400) if len(wide) > 1 else []
        return sorted(float(mpmath.re(r)) for r in found if abs(mpmath.im(r)) < mpmath.mpf(10) ** -25)


@PRECISIONS
@pytest.mark.parametrize("distance", [5, 1e3])
def test_torus_is_met_at_the_exact_roots(dtype, distance):
    torus = sl.geometry.torus_polynomial(1.0, 0.4)
    o, d = rays(dtype, 25, distance)
    hit = sl.geometry.ray_implicit(o, d, torus, full_output=True)
    for i in range(25):
        roots = [r for r in exact_roots(o[i], d[i], torus) if r > 0]
        slack = min(np.diff(roots), default=1)
        if slack < 1e-3:
            continue
        assert hit.crossings[i] == len(roots)
        if roots:
            # Conditioned by how flat the torus is met; double precision inside, then one rounding.
            assert abs(hit.t[i] - roots[0]) <= 1e-11 * distance + np.finfo(dtype).eps * roots[0]
        else:
            assert hit.t[i] == np.inf and np.isnan(hit.normal[i]).all()
    assert 0.1 < np.isfinite(hit.t).mean() < 0.95


@PRECISIONS
@pytest.mark.parametrize("length", [1, 1e-20, 1e20])
def test_quadrics_agree_with_the_sphere(dtype, length):
    o, d = rays(dtype, 2000, length=length)
    ball = sl.geometry.quadric_polynomial(np.diag([1, 1, 1, -2.25]))
    got = sl.geometry.ray_implicit(o, d, ball, full_output=True)
    want = sl.geometry.ray_sphere(o, d, [0, 0, 0], 1.5, full_output=True)
    clear = np.abs(want.discriminant) > 1e-4
    assert np.array_equal(np.isfinite(got.t[clear]), np.isfinite(want.t[clear]))
    met = clear & np.isfinite(want.t)
    assert np.allclose(got.t[met], want.t[met], rtol=40 * np.finfo(dtype).eps)
    p = o[met].astype(float) + got.t[met, None].astype(float) * d[met]
    assert np.allclose(got.normal[met], p / 1.5, atol=1e-5) and (got.crossings[met] == 2).all()


@settings(max_examples=60, deadline=None)
@given(roots=st.lists(st.integers(-12, 12), min_size=1, max_size=6, unique=True), shift=st.integers(-3, 3))
def test_planes_in_a_row_are_all_met(roots, shift):
    # (x - r1)(x - r2) …, along x.
    c = np.polynomial.polynomial.polyfromroots(roots).reshape(-1, 1, 1)
    hit = sl.geometry.ray_implicit([shift - 20.0, 0.3, 0.2], [2.0, 0, 0], c, full_output=True)
    assert hit.crossings == len(roots) and hit.t == pytest.approx((min(roots) - shift + 20) / 2, abs=1e-9)
    last = sl.geometry.ray_implicit([20.0, 0, 0], [-1.0, 0, 0], c)
    assert last == pytest.approx(20 - max(roots), abs=1e-9)


def test_touching_multiple_and_far_roots():
    ball = sl.geometry.quadric_polynomial(np.diag([1, 1, 1, -1]))
    assert sl.geometry.ray_implicit([0, 1, -5], [0, 0, 1.0], ball) == 5
    triple = np.zeros((4, 1, 1))
    triple[3] = 1
    assert sl.geometry.ray_implicit([-2, 0, 0], [1.0, 0, 0], triple) == pytest.approx(2, abs=1e-4)
    plane = np.zeros((2, 1, 1))
    plane[:, 0, 0] = -1e12, 1
    assert sl.geometry.ray_implicit([0, 0, 0], [1.0, 1, 0], plane) == pytest.approx(1e12, rel=1e-14)
    # Within the surface, and nowhere near it.
    assert sl.geometry.ray_implicit([0, 0, 0], [0, 1.0, 0], np.array([0, 1.0]).reshape(2, 1, 1)) == np.inf
    assert sl.geometry.ray_implicit([0, 0, 0], [0, 1.0, 0], plane) == np.inf


@PRECISIONS
def test_functions_are_met_where_polynomials_are(dtype):
    torus = sl.geometry.torus_polynomial(1.0, 0.4)

    def distance(p):
        return np.hypot(np.hypot(p[:, 0], p[:, 2]) - 1, p[:, 1]) - p.dtype.type(0.4)

    o, d = rays(dtype, 400, seed=2)
    want = sl.geometry.ray_implicit(o, d, torus, t_max=10, full_output=True)
    for options in ({"samples": 2000}, {"lipschitz": 1.0, "samples": 2000}):
        got = sl.geometry.ray_implicit(o, d, distance, t_max=10, full_output=True, **options)
        assert got.t.dtype == dtype
        # Grazing rays meet the torus for less than a step, or differ by the rounding of the function.
        both = np.isfinite(want.t) & np.isfinite(got.t)
        cosine = np.abs((want.normal * d).sum(-1))
        clear = both & (cosine > 0.1)
        assert (np.isfinite(want.t) == np.isfinite(got.t)).mean() > 0.99
        assert np.allclose(got.t[clear], want.t[clear], atol=60 * np.finfo(dtype).eps / 0.1)
        assert np.allclose(got.normal[clear], want.normal[clear], atol=1e-2 if dtype == np.float32 else 1e-5)
        assert np.abs(got.value[both]).max() < 60 * np.finfo(dtype).eps
    sampled = sl.geometry.ray_implicit(o, d, distance, t_max=10, samples=2000, full_output=True)
    assert (sampled.crossings == want.crossings).mean() > 0.98


def test_roots_of_functions_are_closed_in_to_the_last_bits():
    o = np.zeros((50, 3))
    d = np.tile([1.0, 0, 0], (50, 1))
    for f, root in ((np.cos, np.pi / 2), (lambda x: x**9 - 2, 2 ** (1 / 9)), (lambda x: np.arctan(40 * (x - 1)), 1.0)):
        t = sl.geometry.ray_implicit(o, d, lambda p, f=f: f(p[:, 0]), t_max=3, samples=1)
        assert np.allclose(t, root, rtol=4e-16, atol=0)


def test_what_sampling_misses_a_bound_finds():
    def thin(p):
        return np.abs(p[:, 0] - 1.0) - 1e-4

    assert np.isinf(sl.geometry.ray_implicit([0, 0, 0], [1.0, 0, 0], thin, t_max=3.1, samples=50))
    assert sl.geometry.ray_implicit([0, 0, 0], [1.0, 0, 0], thin, t_max=3.1, lipschitz=1.0) == pytest.approx(0.9999)


def test_starting_on_the_surface_gives_the_next_root():
    ball = sl.geometry.quadric_polynomial(np.diag([1, 1, 1, -1]))
    assert sl.geometry.ray_implicit([1, 0, 0], [-1.0, 0, 0], ball) == 2

    def distance(p):
        return np.linalg.norm(p, axis=-1) - 1

    for lipschitz in (None, 1.0):
        t = sl.geometry.ray_implicit([1, 0, 0], [-1.0, 0, 0], distance, t_max=5, lipschitz=lipschitz)
        assert t == pytest.approx(2, rel=1e-14)


def test_intervals_are_open():
    ball = sl.geometry.quadric_polynomial(np.diag([1, 1, 1, -1]))
    ray = ([0, 0, 3], [0, 0, -1.0])
    assert sl.geometry.ray_implicit(*ray, ball, t_min=2) == 4
    assert np.isinf(sl.geometry.ray_implicit(*ray, ball, t_max=2))
    assert sl.geometry.ray_implicit(*ray, ball, t_min=-np.inf) == 2


def test_nan_stays_in_its_element_and_arguments_are_named():
    o, d = rays(np.float64, 4)
    ball = sl.geometry.quadric_polynomial(np.diag([1, 1, 1, -4]))

    def distance(p):
        return np.linalg.norm(p, axis=-1) - 2

    clean = sl.geometry.ray_implicit(o, d, ball)
    o[0, 0], d[1], d[2, 1] = np.nan, 0, np.inf
    for surface in (ball, distance):
        t = sl.geometry.ray_implicit(o, d, surface, t_max=20)
        assert np.isnan(t[:3]).all() and t[3] == pytest.approx(clean[3])
    with pytest.raises(ValueError, match="t_max: expected finite"):
        sl.geometry.ray_implicit(o, d, distance)
    with pytest.raises(ValueError, match="surface: expected a polynomial of degree 1 to 24, got 0"):
        sl.geometry.ray_implicit(o, d, np.ones((1, 1, 1)))
    with pytest.raises(ValueError, match="surface: expected 1 values"):
        sl.geometry.ray_implicit(o[3], d[3], lambda p: p, t_max=1)
    with pytest.raises(ValueError, match="surface: expected a callable"):
        sl.geometry.ray_implicit(o, d, np.ones((3, 3)))
