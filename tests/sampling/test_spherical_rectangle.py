"""Spherical rectangles: uniform, inverted, exact areas, stable where they are tiny, vast, distant or grazing."""

import mpmath
import numpy as np
import pytest
import shadelab as sl

from . import _warps as warps

DTYPES = [np.float32, np.float64]
SHAPES = {
    "ahead": ([0, 0, 1], [2, 0, 0], [0, 2, 0]),
    "aside": ([3, 2, 1], [1, 0, 0], [0, 1, 0]),
    "around a corner": ([2, -1.5, 0.3], [4.5, 0, 0], [0, 3.2, 0]),
    "grazing": ([2, 0.5, 0.01], [1, 0, 0], [0, 2, 0]),
    "turned": ([0.5, 1, -1], [1, 1, 0], [-0.5, 0.5, 1]),
    "vast": ([0.2, 0.1, 0.01], [20, 0, 0], [0, 30, 0]),
}


def exact_solid_angle(center, edge_u, edge_v):
    """From the antiderivative asin(x y / √((x² + d²)(y² + d²))) in 60 digits."""
    with mpmath.workdps(60):
        c, eu, ev = ([mpmath.mpf(float(x)) for x in v] for v in (center, edge_u, edge_v))
        dot = lambda p, q: mpmath.fsum(x * y for x, y in zip(p, q, strict=True))  # noqa: E731
        w, h = mpmath.sqrt(dot(eu, eu)), mpmath.sqrt(dot(ev, ev))
        x, y = dot(c, eu) / w, dot(c, ev) / h
        n = [eu[1] * ev[2] - eu[2] * ev[1], eu[2] * ev[0] - eu[0] * ev[2], eu[0] * ev[1] - eu[1] * ev[0]]
        d = abs(dot(c, n)) / mpmath.sqrt(dot(n, n))
        f = lambda x, y: mpmath.asin(x * y / mpmath.sqrt((x * x + d * d) * (y * y + d * d)))  # noqa: E731
        ends = [(i, j) for i in (-1, 1) for j in (-1, 1)]
        return mpmath.fsum(i * j * f(x + i * w / 2, y + j * h / 2) for i, j in ends)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("name", SHAPES)
def test_directions_have_their_density(name, dtype):
    """In cells of the rectangle itself: each cell's share is its own solid angle."""
    center, eu, ev = (np.array(v, np.float64) for v in SHAPES[name])
    given = [v.astype(dtype) for v in (center, eu, ev)]
    d = sl.sampling.square_to_spherical_rectangle(warps.numbers(1 << 15, dtype), *given).astype(np.float64)
    normal = np.cross(eu, ev)
    p = d * (center @ normal / (d @ normal))[:, None] - center
    x, y = p @ eu / (eu @ eu) + 0.5, p @ ev / (ev @ ev) + 0.5
    assert min(x.min(), y.min()) > -1e-5 and max(x.max(), y.max()) < 1 + 1e-5
    n = 12
    counts = np.histogram2d(x.clip(0, 1), y.clip(0, 1), n, [(0, 1), (0, 1)])[0]
    i, j = (np.indices((n, n)) + 0.5) / n - 0.5
    centers = center + i[..., None] * eu + j[..., None] * ev
    cells = sl.sampling.square_to_spherical_rectangle([0.5, 0.5], centers, eu / n, ev / n, full_output=True).solid_angle
    whole = sl.sampling.square_to_spherical_rectangle([0.5, 0.5], center, eu, ev, full_output=True).solid_angle
    assert cells.sum() == pytest.approx(float(whole), rel=1e-12)
    assert warps.fits(counts, len(d) * cells / cells.sum())


@pytest.mark.parametrize("dtype", DTYPES)
def test_solid_angles_are_exact(dtype):
    rng = np.random.default_rng(4)
    for k in range(80):
        w, h = 10.0 ** rng.uniform(-8, 3, 2)
        center = np.array([*rng.normal(size=2) * 10.0 ** rng.uniform(-2, 2), 10.0 ** rng.uniform(-3, 2)])
        given = [np.array(v, dtype) for v in (center, [w, 0, 0], [0, h, 0])]
        got = sl.sampling.square_to_spherical_rectangle([0.5, 0.5], *given, full_output=True).solid_angle
        exact = exact_solid_angle(*given)
        # Relative; where the plane is grazed, the rectangle's own ends are rounded by an ulp of their distance.
        assert abs(float(got / exact) - 1) < 16 * np.finfo(dtype).eps, (k, given)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("name", SHAPES)
def test_ends_of_the_square_stay_on_the_rectangle(name, dtype):
    given = [np.array(v, dtype) for v in SHAPES[name]]
    d = sl.sampling.square_to_spherical_rectangle(warps.ends(dtype), *given)
    assert np.abs(np.linalg.norm(d.astype(np.float64), axis=-1) - 1).max() < 3 * np.finfo(dtype).eps
    assert (sl.sampling.square_to_spherical_rectangle_pdf(d, *given) > 0).all()


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("size", [1e-6, 1e-3, 1.0, 1e3])
@pytest.mark.parametrize("name", SHAPES)
def test_the_inverse_returns_to_the_square(name, size, dtype):
    center, eu, ev = (np.array(v, dtype) for v in SHAPES[name])
    given = [center, eu * dtype(size), ev * dtype(size)]
    u = warps.numbers(4000, dtype)
    d, solid_angle = sl.sampling.square_to_spherical_rectangle(u, *given, full_output=True)
    assert (sl.sampling.square_to_spherical_rectangle_pdf(d, *given) > 0).all()
    back = sl.sampling.spherical_rectangle_to_square(d, *given)
    assert ((back >= 0) & (back < 1)).all()
    # A direction's rounding over what the rectangle covers of the sphere, in the narrower way.
    width = float(solid_angle[0]) / np.pi
    assert np.abs(back - u).max() < 60 * np.finfo(dtype).eps / min(1, width)


def test_mirrored_rectangles_map_to_mirrored_directions():
    u = warps.numbers(500, np.float64)
    flip = np.array([1, 1, -1.0])
    center, eu, ev = (np.array(v, np.float64) for v in SHAPES["around a corner"])
    one = sl.sampling.square_to_spherical_rectangle(u, center, eu, ev)
    other = sl.sampling.square_to_spherical_rectangle(u, center * flip, eu, ev)
    assert np.allclose(one * flip, other, atol=1e-15)
    turned = sl.sampling.square_to_spherical_rectangle(1 - u, center, -eu, -ev)
    assert np.allclose(one, turned, atol=1e-14)


def test_scale_does_not_matter():
    u = warps.numbers(100, np.float32)
    given = [np.array(v, np.float32) for v in SHAPES["turned"]]
    one = sl.sampling.square_to_spherical_rectangle(u, *given)
    for scale in (2.0**-100, 2.0**100):
        scaled = [v * np.float32(scale) for v in given]
        assert np.allclose(sl.sampling.square_to_spherical_rectangle(u, *scaled), one, atol=1e-6)


def test_what_is_no_rectangle_is_nan_alone():
    centers = [[0, 0, 1.0], [0, 0, 0], [0, 0, np.nan]]
    d = sl.sampling.square_to_spherical_rectangle([0.3, 0.4], centers, [1.0, 0, 0], [0, 1.0, 0])
    assert np.isfinite(d[0]).all() and np.isnan(d[1:]).all()
    assert np.isnan(sl.sampling.square_to_spherical_rectangle([0.3, 0.4], [0, 0, 1], [1.0, 0, 0], [0.1, 1.0, 0])).all()


def test_the_other_side_has_no_density():
    given = SHAPES["ahead"]
    d = [[0, 0, -1], [0.9, 0, 0.1], [0, 0, 1]]
    assert ((sl.sampling.square_to_spherical_rectangle_pdf(d, *given) > 0) == [False, False, True]).all()
