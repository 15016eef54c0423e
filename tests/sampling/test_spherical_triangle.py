"""Spherical triangles: uniform, inverted, exact areas, stable where they are tiny or vast."""

import mpmath
import numpy as np
import pytest
import shadelab as sl

from . import _warps as warps

DTYPES = [np.float32, np.float64]
TRIANGLES = {
    "octant": ([1, 0, 0], [0, 1, 0], [0, 0, 1]),
    "sliver": ([1, 0.01, 0], [-0.5, 2, 0.02], [0.9, -0.1, 0.05]),
    "vast": ([1, 0, -0.1], [-0.6, 0.8, -0.1], [-0.6, -0.8, -0.1]),
    "uneven lengths": ([3, 0.1, 0.2], [0, 0.1, 0.02], [0.5, 0.5, 9]),
    "clockwise": ([0, 0, 1], [0, 1, 0], [1, 0, 0.5]),
}


def exact_solid_angle(a, b, c):
    """By l'Huilier's theorem, in 60 digits: another formula than the kernel's."""
    with mpmath.workdps(60):
        unit = [[mpmath.mpf(float(x)) for x in v] for v in (a, b, c)]
        unit = [[x / mpmath.sqrt(mpmath.fsum(y * y for y in v)) for x in v] for v in unit]

        def side(p, q):
            chord = mpmath.sqrt(mpmath.fsum((x - y) ** 2 for x, y in zip(p, q, strict=True)))
            return 2 * mpmath.asin(chord / 2)

        sides = [side(unit[i], unit[(i + 1) % 3]) for i in range(3)]
        s = sum(sides) / 2
        product = mpmath.tan(s / 2)
        for x in sides:
            product *= mpmath.tan((s - x) / 2)
        return 4 * mpmath.atan(mpmath.sqrt(product))


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("name", TRIANGLES)
def test_directions_have_their_density(name, dtype):
    corners = np.array(TRIANGLES[name], dtype)
    d = sl.sampling.square_to_spherical_triangle(warps.numbers(1 << 15, dtype), *corners)
    assert d.dtype == dtype
    assert (sl.sampling.square_to_spherical_triangle_pdf(d, *corners) > 0).all()
    wide = corners.astype(np.float64)
    # Cut cells are integrated to 1/576 of their area each.
    expected = warps.density_cells(lambda p: sl.sampling.square_to_spherical_triangle_pdf(p, *wide), len(d), 16, 32, 48)
    counts = warps.sphere_cells(d.astype(np.float64), 16, 32)
    if name != "sliver":
        assert expected.sum() == pytest.approx(len(d), rel=0.002)
        # The quadrature's own error in the cut cells: give them a share of their expectation.
        whole = expected >= 0.999 * expected.max()
        outside = expected == 0
        assert counts[outside].sum() <= len(d) * 0.001
        pooled = np.append(counts[whole], counts[~whole].sum()), np.append(expected[whole], expected[~whole].sum())
        assert warps.fits(*pooled)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("size", [1e-12, 1e-6, 1e-3, 1.0])
def test_small_triangles_are_as_even_as_large_ones(size, dtype):
    """Through the inverse in double: strata of the square get their share."""
    a = np.array([0.3, -0.2, 0.9])
    corners = np.array([a, a + size * np.array([1, 0.2, 0.1]), a + size * np.array([-0.3, 1, 0.4])])
    u = warps.numbers(1 << 15, dtype)
    if size < np.finfo(dtype).eps:
        size *= 1e6  # the corners would be one
        corners = np.array([a, a + size * np.array([1, 0.2, 0.1]), a + size * np.array([-0.3, 1, 0.4])])
    d, solid_angle = sl.sampling.square_to_spherical_triangle(u, *corners.astype(dtype), full_output=True)
    exact = exact_solid_angle(*corners.astype(dtype))
    assert abs(float(solid_angle[0] / exact) - 1) < 16 * np.finfo(dtype).eps
    assert np.isfinite(d).all()
    assert (sl.sampling.square_to_spherical_triangle_pdf(d, *corners.astype(dtype)) > 0).mean() > 0.99
    back = sl.sampling.spherical_triangle_to_square(d, *corners.astype(dtype))
    assert ((back >= 0) & (back < 1)).all()
    # A direction's rounding counts over the size, and over the distance from b, where all u meet.
    error = np.abs(back - u) * np.stack([np.sqrt(u[:, 1]), np.ones(len(u))], -1)
    assert error.max() < 40 * np.finfo(dtype).eps * max(1, 1 / size)


@pytest.mark.parametrize("dtype", DTYPES)
def test_solid_angles_are_exact(dtype):
    rng = np.random.default_rng(3)
    for _ in range(60):
        corners = (rng.normal(size=(3, 3)) * rng.choice([1e-6, 1e-3, 1, 1e3]) + rng.normal(size=3)).astype(dtype)
        got = sl.sampling.square_to_spherical_triangle([0.5, 0.5], *corners, full_output=True).solid_angle
        exact = exact_solid_angle(*corners)
        # Of a sliver, the corners' volume is small beside the squares of its sides.
        unit = corners.astype(float) / np.linalg.norm(corners.astype(float), axis=1, keepdims=True)
        longest = np.linalg.norm(unit - np.roll(unit, 1, 0), axis=1).max()
        assert got.dtype == dtype
        assert abs(float(got - exact)) < 16 * np.finfo(dtype).eps * max(float(exact), longest**2)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("name", TRIANGLES)
def test_ends_of_the_square_stay_in_the_triangle(name, dtype):
    corners = np.array(TRIANGLES[name], dtype)
    d = sl.sampling.square_to_spherical_triangle(warps.ends(dtype), *corners)
    assert np.abs(np.linalg.norm(d.astype(np.float64), axis=-1) - 1).max() < 3 * np.finfo(dtype).eps
    assert (sl.sampling.square_to_spherical_triangle_pdf(d, *corners) > 0).all()


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("name", TRIANGLES)
def test_the_inverse_returns_to_the_square(name, dtype):
    corners = np.array(TRIANGLES[name], dtype)
    u = warps.numbers(4000, dtype)
    back = sl.sampling.spherical_triangle_to_square(sl.sampling.square_to_spherical_triangle(u, *corners), *corners)
    error = np.abs(back - u) * np.stack([np.sqrt(u[:, 1]), np.ones(len(u))], -1)
    # Rounding of a direction over the narrowest width of the triangles, 0.03.
    assert error.max() < (400 if name == "sliver" else 40) * np.finfo(dtype).eps


def test_scale_does_not_matter():
    u = warps.numbers(100, np.float32)
    corners = np.array(TRIANGLES["uneven lengths"], np.float32)
    one = sl.sampling.square_to_spherical_triangle(u, *corners)
    for scale in (2.0**-100, 2.0**100):
        assert np.array_equal(sl.sampling.square_to_spherical_triangle(u, *(corners * np.float32(scale))), one)


def test_triangles_of_no_area_are_nan_alone():
    a, b = [1.0, 0, 0], [0, 1.0, 0]
    d = sl.sampling.square_to_spherical_triangle([0.3, 0.4], a, b, [[1.0, 0, 0], [0, 0, 1.0], [np.nan, 0, 0]])
    assert np.isnan(d[[0, 2]]).all() and np.isfinite(d[1]).all()
