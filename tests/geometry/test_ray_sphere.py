"""Rays and spheres: both roots of the exact equation, far away, from inside and from the surface."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest
import shadelab as sl
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

METHODS = ["robust", "quadratic", "geometric"]
PRECISIONS = pytest.mark.parametrize("dtype", [np.float32, np.float64])


def exact(o, d, c, r):
    """The discriminant as a rational, and the roots to 60 digits (None if the line misses)."""
    o, d, c = ([Fraction(float(x)) for x in v] for v in (o, d, c))
    r = Fraction(float(r))
    f = [x - y for x, y in zip(o, c, strict=True)]
    a, b = sum(x * x for x in d), -sum(x * y for x, y in zip(f, d, strict=True))
    discriminant = r * r - sum(x * x for x in f) + b * b / a
    if discriminant < 0:
        return discriminant, None
    with mpmath.workdps(60):
        root = mpmath.sqrt(mpmath.mpf((a * discriminant).numerator) / (a * discriminant).denominator)
        wide = mpmath.mpf(b.numerator) / b.denominator
        scale = mpmath.mpf(a.numerator) / a.denominator
        return discriminant, ((wide - root) / scale, (wide + root) / scale)


def aimed(dtype, n=150, distance=3.0, reach=1.1, size=1.0, shift=0.0, length=1.0, seed=1):
    """Rays from `distance` radii at points up to `reach` radii beside the centre."""
    rng = np.random.default_rng(seed)
    u, side = rng.normal(size=(2, n, 3))
    side = np.cross(u, side)
    u, side = (x / np.linalg.norm(x, axis=-1, keepdims=True) for x in (u, side))
    c = rng.normal(size=(n, 3)) * size + shift
    r = size * rng.uniform(0.5, 2, n)
    o = c + u * (distance * r)[:, None]
    d = c + side * (r * rng.uniform(0, reach, n))[:, None] - o
    return [x.astype(dtype) for x in (o, length * d / np.linalg.norm(d, axis=-1, keepdims=True), c, r)]


CASES = {
    "near": {},
    "1e4 radii away": {"distance": 1e4},
    "1e6 radii away": {"distance": 1e6},
    "inside": {"distance": 0.5, "reach": 0.8},
    "1e6 from the origin": {"shift": 1e6, "size": 1e4},
    "short directions": {"length": 1e-20},
    "long directions": {"length": 1e20},
    "small": {"size": 1e-25},
    "huge": {"size": 1e25},
}


@PRECISIONS
@pytest.mark.parametrize("case", CASES)
def test_robust_roots_are_the_exact_ones(dtype, case):
    rays = aimed(dtype, **CASES[case])
    hit = sl.geometry.ray_sphere(*rays)
    eps = float(np.finfo(dtype).eps)
    for i, (o, d, c, r) in enumerate(zip(*rays, strict=True)):
        discriminant, roots = exact(o, d, c, r)
        square = Fraction(float(r)) ** 2
        # The docstring's claim: decided right, unless within a few eps of touching.
        if abs(discriminant) > 4 * eps * square:
            assert np.isfinite(hit.t_near[i]) == (roots is not None)
        if discriminant > square / 4:
            for got, want in zip((hit.t_near[i], hit.t_far[i]), roots, strict=True):
                assert abs(mpmath.mpf(float(got)) - want) <= 4 * eps * abs(want)
        assert hit.t[i] == next((t for t in (hit.t_near[i], hit.t_far[i]) if 0 < t < np.inf), np.inf)


@PRECISIONS
def test_origins_one_rounding_off_the_surface_keep_their_digits(dtype):
    rng = np.random.default_rng(2)
    u = rng.normal(size=(100, 3))
    u /= np.linalg.norm(u, axis=-1, keepdims=True)
    o = u.astype(dtype)
    d = (-u + 0.3 * rng.normal(size=(100, 3))).astype(dtype)
    hit = sl.geometry.ray_sphere(o, d, [0, 0, 0], 1.0)
    for i in range(100):
        _, roots = exact(o[i], d[i], [0, 0, 0], 1.0)
        eps = float(np.finfo(dtype).eps)
        # Far below one rounding of the radius, where the textbook's roots are noise.
        bound = 4 * eps * abs(roots[0]) + 4 * eps**2
        assert abs(mpmath.mpf(float(hit.t_near[i])) - roots[0]) <= bound
        # So whether the origin is outside or inside is told from the sign.
        assert abs(roots[0]) < bound or np.sign(hit.t_near[i]) == mpmath.sign(roots[0])


@settings(max_examples=150, deadline=None)
@given(
    o=st.tuples(*[st.integers(-9, 9)] * 3),
    d=st.tuples(*[st.integers(-3, 3)] * 3).filter(any),
    r=st.integers(0, 5),
)
def test_small_integers_are_decided_as_the_exact_discriminant(o, d, r):
    discriminant, roots = exact(o, d, (1, 2, 3), r)
    for dtype in (np.float32, np.float64):
        full = sl.geometry.ray_sphere(np.array(o, dtype), np.array(d, dtype), [1, 2, 3], r, full_output=True)
        eps = float(np.finfo(dtype).eps)
        size = max(r * r, 1)
        if abs(discriminant) > 4 * eps * size:
            assert np.isfinite(full.t_near) == (roots is not None)
        assert abs(float(full.discriminant) - float(discriminant)) <= 8 * eps * max(size, abs(float(discriminant)))


@PRECISIONS
@pytest.mark.parametrize("method", METHODS)
def test_all_methods_find_near_spheres(dtype, method):
    rays = aimed(dtype, n=2000, reach=0.8, seed=3)
    want = sl.geometry.ray_sphere(*rays)
    got = sl.geometry.ray_sphere(*rays, method=method)
    # At three radii squared distances are nine times the radius's: some tens of roundings.
    assert np.allclose(got.t_near, want.t_near, rtol=60 * np.finfo(dtype).eps)
    assert np.allclose(got.t_far, want.t_far, rtol=60 * np.finfo(dtype).eps)


def test_only_the_robust_method_keeps_spheres_at_1e4_radii():
    rays = aimed(np.float32, distance=1e4, reach=0.9)
    assert np.isfinite(sl.geometry.ray_sphere(*rays).t).all()
    for method in ("quadratic", "geometric"):
        assert np.isinf(sl.geometry.ray_sphere(*rays, method=method).t).any()


def test_agrees_with_a_fine_mesh_of_a_sphere():
    o, d, c, r = aimed(np.float64, n=40, reach=0.9, seed=4)
    ball = trimesh.creation.icosphere(subdivisions=4)
    for i in range(40):
        where, _, _ = ball.ray.intersects_location([(o[i] - c[i]) / r[i]], [d[i]])
        near = np.linalg.norm(where * r[i] + c[i] - o[i], axis=-1).min()
        # The mesh lies inside the sphere by 1e-3 at most, more along slanting rays.
        assert abs(sl.geometry.ray_sphere(o[i], d[i], c[i], r[i]).t - near) < 1e-2 * r[i]


@pytest.mark.parametrize("method", METHODS)
def test_interior_tangent_behind_and_interval(method):
    def cast(o, d, **interval):
        return [float(x) for x in sl.geometry.ray_sphere(o, d, [0, 0, 0], 1.0, method=method, **interval)]

    assert cast([0, 0, 0], [0, 0, 2.0]) == [0.5, -0.5, 0.5]
    assert cast([0, 1, -2], [0, 0, 1.0]) == [2, 2, 2]
    assert cast([0, 0, 3], [0, 0, 1.0]) == [np.inf, -4, -2]
    assert cast([0, 2, 3], [0, 0, -1.0]) == [np.inf, np.inf, -np.inf]
    assert cast([0, 0, 3], [0, 0, -1.0], t_min=2) == [4, 2, 4]
    assert cast([0, 0, 3], [0, 0, -1.0], t_min=2, t_max=4) == [np.inf, 2, 4]


@PRECISIONS
def test_details_are_the_nearest_point(dtype):
    rays = aimed(dtype, n=500, seed=5)
    full = sl.geometry.ray_sphere(*rays, full_output=True)
    o, d, c, r = (x.astype(np.float64) for x in rays)
    foot = o - c + full.t_closest[:, None].astype(np.float64) * d
    eps = np.finfo(dtype).eps
    # The foot inherits the rounding of t_closest: the distance is off by its square alone.
    assert np.allclose(np.linalg.norm(foot, axis=-1), full.distance, rtol=0, atol=30 * eps)
    assert np.allclose((foot * d).sum(-1), 0, atol=30 * eps)
    assert np.allclose(full.discriminant, r**2 - full.distance.astype(np.float64) ** 2, atol=30 * eps)


def test_points_are_hit_by_lines_through_them():
    hit = sl.geometry.ray_sphere([0, 0, 0], [[1.0, 2, 3], [1, 2, 3.0001]], [2, 4, 6], 0.0)
    assert hit.t.tolist() == [2.0, np.inf]


def test_broadcasts_rays_over_spheres():
    o, d, c, r = aimed(np.float32, n=7)
    all_pairs = sl.geometry.ray_sphere(o[:, None], d[:, None], c, r)
    assert all_pairs.t.shape == (7, 7) and all_pairs.t.dtype == np.float32
    assert np.array_equal(np.diag(all_pairs.t), sl.geometry.ray_sphere(o, d, c, r).t)


@pytest.mark.parametrize("method", METHODS)
def test_nan_infinity_and_negative_radii_stay_in_their_element(method):
    o, d, c, r = aimed(np.float64, n=6)
    clean = sl.geometry.ray_sphere(o, d, c, r, method=method)
    o[0, 1], d[1], c[2, 0], r[3], t_min = np.nan, 0, np.inf, -1, np.zeros(6)
    t_min[4] = np.nan
    hit = sl.geometry.ray_sphere(o, d, c, r, method=method, t_min=t_min)
    assert all(np.isnan(x[:5]).all() and x[5] == y[5] for x, y in zip(hit, clean, strict=True))


def test_bad_arguments_are_named():
    with pytest.raises(ValueError, match="method: expected one of"):
        sl.geometry.ray_sphere([0, 0, 0], [1, 0, 0], [0, 0, 0], 1, method="fast")
    with pytest.raises(ValueError, match=r"centers: expected shape \(\.\.\., 3\)"):
        sl.geometry.ray_sphere([0, 0, 0], [1, 0, 0], [0, 0], 1)
    with pytest.raises(ValueError, match="t_max: expected a number, got nan"):
        sl.geometry.ray_sphere([0, 0, 0], [1, 0, 0], [0, 0, 0], 1, t_max=np.nan)
